"""Recordings of simulations, as plain data."""

from voxshell.recording.body_track import BodyTrack
from voxshell.recording.contact_track import ContactTrack
from voxshell.recording.recording import Recording

__all__ = ["BodyTrack", "ContactTrack", "Recording"]
