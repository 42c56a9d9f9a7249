"""Recordings of simulations, as plain data."""

from voxshell.recording.recording import BodyTrack, ContactTrack, Recording

__all__ = ["BodyTrack", "ContactTrack", "Recording"]
