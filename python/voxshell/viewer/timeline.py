"""The choice of steps that a replay shows, and their times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voxshell.errors import RecordingError, SettingsError
from voxshell.recording import Recording

# Tolerance for rounding, so that a time of exactly k steps falls on step k.
_STEP_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Timeline:
    """Instants to show, equally spaced in simulated time.

    Args:
        times: (k,) float, seconds of simulated time, from 0; the last is the end of the longest
            recording.
        stride: Steps of the fastest recording between instants.
        speed: Simulated seconds per second of playback.
    """

    times: NDArray[np.float64]
    stride: int
    speed: float

    @property
    def pauses(self) -> NDArray[np.float64]:
        """Seconds of playback between instants, (k - 1,)."""
        return np.diff(self.times) / self.speed

    def frames(self, recording: Recording) -> NDArray[np.int64]:
        """Return the latest frame of a recording at each instant, (k,); at most the last one."""
        frames = np.floor(self.times / recording.time_step + _STEP_TOLERANCE).astype(np.int64)
        return np.minimum(frames, recording.frame_count - 1)

    def contact_frames(self, recording: Recording) -> NDArray[np.int64]:
        """Return the frame whose contacts to show at each instant, (k,).

        This is the shown frame. If it has no contact, but steps skipped since the previous instant
        have some, it is the latest of those. So even very short contacts are visible.
        """
        shown = self.frames(recording)
        touching = np.where(recording.contacts.counts > 0, np.arange(recording.frame_count), -1)
        latest = np.maximum.accumulate(touching)[shown]
        before = np.concatenate([[-1], shown[:-1]])
        return np.where(latest > before, latest, shown)


def plan_timeline(
    recordings: Sequence[Recording], *, frames_per_second: float = 60.0, speed: float = 1.0
) -> Timeline:
    """Plan to show every n-th step, with the smallest n that respects a frame rate.

    Constant strides make motion look even; the steps nearest to each frame's time would not.

    Args:
        recordings: The recordings to show together; the shortest time step counts.
        frames_per_second: Largest number of frames per second of playback.
        speed: Simulated seconds per second of playback; 1 is real time, less is slow motion.

    Raises:
        RecordingError: There is no recording.
        SettingsError: A rate is not positive.

    Example:
        >>> import numpy as np
        >>> from voxshell.recording import BodyTrack, ContactTrack
        >>> poses = np.tile(np.eye(4), (401, 1, 1))
        >>> body = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, poses)
        >>> timeline = plan_timeline([Recording(1 / 200, (body,), ContactTrack.empty(401))])
        >>> timeline.stride, len(timeline.times), float(timeline.times[-1])
        (4, 101, 2.0)
    """
    if not recordings:
        raise RecordingError("nothing to show: no recordings")
    for name, rate in (("frames_per_second", frames_per_second), ("speed", speed)):
        if not (math.isfinite(rate) and rate > 0.0):
            raise SettingsError(f"{name} must be positive, got {rate!r}")
    step = min(recording.time_step for recording in recordings)
    end = max(recording.duration for recording in recordings)
    stride = max(1, math.ceil(speed / (frames_per_second * step) - _STEP_TOLERANCE))
    whole = math.ceil(end / (stride * step) - _STEP_TOLERANCE)
    times = np.minimum(np.arange(whole + 1) * (stride * step), end)
    return Timeline(times, stride, speed)
