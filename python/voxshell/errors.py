"""The errors that voxshell raises."""

from __future__ import annotations


class VoxshellError(Exception):
    """Base of every error that voxshell raises on bad input or a failed job."""


class MeshError(VoxshellError, ValueError):
    """A mesh cannot be read or used; the message says what is wrong, how much of it and where."""


class PoseError(VoxshellError, ValueError):
    """A pose is in no form that :func:`voxshell.pose` lists, is not rigid, or is not finite."""


class SettingsError(VoxshellError, ValueError):
    """A setting or an argument is missing, contradictory or out of range."""


class MemoryLimitError(VoxshellError, ValueError):
    """A request would exceed the memory limit, or the system gives no more memory."""


class ModelFileError(VoxshellError, ValueError):
    """A model file is damaged, or is none, or is of a version that this package does not read."""


class FileAccessError(VoxshellError, OSError):
    """A file cannot be opened, read or written."""


class InputTypeError(VoxshellError, TypeError):
    """An argument is of a type that the function does not take."""


class RobotError(VoxshellError, ValueError):
    """A robot's file cannot be simulated; the message names it, the link or joint, and what to do."""


class RecordingError(VoxshellError, ValueError):
    """A recording, or a request to replay one, does not make sense."""


class SimulationError(VoxshellError, RuntimeError):
    """A simulation has diverged: a body's pose or velocity is no longer a finite number."""


class MissingExtraError(VoxshellError, ImportError):
    """An optional part of voxshell is not installed; the message says how to install it."""
