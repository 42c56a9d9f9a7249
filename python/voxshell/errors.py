"""The errors that voxshell raises."""

from __future__ import annotations


class VoxshellError(Exception):
    """Base class of all errors that voxshell raises for bad input or failed operations."""


class MeshError(VoxshellError, ValueError):
    """A mesh cannot be read or used. The message says what is wrong, how often and where."""


class PoseError(VoxshellError, ValueError):
    """A pose is in no format that :func:`voxshell.pose` lists, is not rigid, or is not finite."""


class SettingsError(VoxshellError, ValueError):
    """A setting or an argument is missing, contradictory or out of range."""


class MemoryLimitError(VoxshellError, ValueError):
    """An operation would exceed the memory limit, or the system has no memory left."""


class ModelFileError(VoxshellError, ValueError):
    """A file is damaged, is not a model file, or has a version that this package does not read."""


class FileAccessError(VoxshellError, OSError):
    """A file cannot be opened, read or written."""


class MissingFileError(FileAccessError, FileNotFoundError):
    """A file that a call or a command names, or the folder to write it to, does not exist."""


class InputTypeError(VoxshellError, TypeError):
    """An argument has a type that the function does not accept, or a call has wrong arguments."""


class RobotError(VoxshellError, ValueError):
    """A robot's file cannot be simulated. The message names the place in the file and a remedy."""


class RecordingError(VoxshellError, ValueError):
    """A recording is invalid, or it does not contain what was requested."""


class StateError(VoxshellError, ValueError):
    """A file is damaged, is not a world's state, or has a version that this package does not read."""


class SimulationError(VoxshellError, RuntimeError):
    """A simulation has diverged: a body's pose or velocity is no longer a finite number."""


class MissingExtraError(VoxshellError, ImportError):
    """An optional part of voxshell is not installed. The message says how to install it."""
