"""The queries of a pair, by what they take."""

from __future__ import annotations

import voxshell as vx


def wrench(a, b, a_pose=None, b_pose=None, **options) -> vx.Wrench:
    return vx.wrench(a, b, a_pose, b_pose, stiffness=1.0, **options)


def deepest_per_segment(a, b, a_pose=None, b_pose=None, **options) -> vx.Contacts:
    return vx.deepest_per_segment(a, b, a_pose, b_pose, level=3, **options)


SEARCHES = (vx.contacts, vx.testing.contacts_flat)
FEW = (vx.manifold, deepest_per_segment)
WITH_MARGIN = (*SEARCHES, *FEW, vx.collide, vx.contacts_batch, vx.collide_batch)
ONE_SHELL = (*FEW, wrench)
QUERIES = (*SEARCHES, *FEW, vx.collide, vx.distance, wrench)
BATCHES = (vx.contacts_batch, vx.collide_batch, vx.distance_batch)
