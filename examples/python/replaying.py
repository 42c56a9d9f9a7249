"""Replays of a body that moves through given poses, without physics."""

import numpy as np
import voxshell as vx
from voxshell.recording import BodyTrack, ContactTrack, Recording


def replay(path, fixed, moving, poses, *, seconds, title):
    """Writes an offline page of a fixed model, a model at each of (n, 4, 4) poses, and their contacts."""
    found = [vx.contacts(moving, fixed, a_pose=pose) for pose in poses]
    contacts = ContactTrack.from_frames([(it.points_b, it.normals, it.depths) for it in found])
    tracks = tuple(
        BodyTrack(name, model.mesh.vertices, model.mesh.faces, None, way)
        for name, model, way in (
            ("fixed", fixed, np.tile(np.eye(4), (len(poses), 1, 1))),
            ("moving", moving, np.asarray(poses)),
        )
    )
    Recording(seconds / len(poses), tracks, contacts).save_html(path, title=title)
