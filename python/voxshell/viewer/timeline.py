"""Which steps of which recording are shown when."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from voxshell.errors import RecordingError
from voxshell.recording import Recording

# A time of exactly k steps must fall on step k in spite of rounding.
_STEP_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class Timeline:
    """Instants to show, equally spaced in simulated time.

    Args:
        times: (k,) float, seconds of simulated time, from 0; the last is the end of the longest
            recording.
        stride: Steps of the fastest recording from one instant to the next.
        speed: Simulated seconds that pass in a second of playing.
    """

    times: NDArray[np.float64]
    stride: int
    speed: float

    @property
    def pauses(self) -> NDArray[np.float64]:
        """(k - 1,) seconds of playing between one instant and the next."""
        return np.diff(self.times) / self.speed

    def frames(self, recording: Recording) -> NDArray[np.int64]:
        """(k,) the latest frame of a recording at each instant; its last one after its end."""
        frames = np.floor(self.times / recording.time_step + _STEP_TOLERANCE).astype(np.int64)
        return np.minimum(frames, recording.frame_count - 1)

    def contact_frames(self, recording: Recording) -> NDArray[np.int64]:
        """(k,) the frame whose contacts to show at each instant.

        It is the frame shown, unless that has no contact while steps passed over since the
        instant before have some: then it is the latest of those, so that a touch too short for
        the eye is seen all the same.
        """
        shown = self.frames(recording)
        touching = np.where(recording.contacts.counts > 0, np.arange(recording.frame_count), -1)
        latest = np.maximum.accumulate(touching)[shown]
        before = np.concatenate([[-1], shown[:-1]])
        return np.where(latest > before, latest, shown)


def plan_timeline(
    recordings: Sequence[Recording], *, frames_per_second: float = 60.0, speed: float = 1.0
) -> Timeline:
    """Shows every n-th step, with the smallest n that keeps to a rate of pictures.

    Every n-th step, not the step nearest to a picture's time, so that motion looks even.

    Args:
        recordings: What to show together; the shortest time step sets the pace.
        frames_per_second: Pictures in a second of playing, at most.
        speed: Simulated seconds in a second of playing; 1 is real time, less is slow motion.

    Raises:
        RecordingError: If there is no recording, or a rate is not positive.

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
            raise RecordingError(f"{name} must be positive, got {rate!r}")
    step = min(recording.time_step for recording in recordings)
    end = max(recording.duration for recording in recordings)
    stride = max(1, math.ceil(speed / (frames_per_second * step) - _STEP_TOLERANCE))
    whole = math.ceil(end / (stride * step) - _STEP_TOLERANCE)
    times = np.minimum(np.arange(whole + 1) * (stride * step), end)
    return Timeline(times, stride, speed)
