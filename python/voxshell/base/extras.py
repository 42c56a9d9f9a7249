"""Errors of imports: a library that is not installed, or no memory left to load it."""

from __future__ import annotations

from voxshell.errors import MemoryLimitError, MissingExtraError

_OF_MEMORY = ("failed to map segment", "annot allocate memory")
"""What the dynamic loader says where it finds no memory for a library."""


def explain_import(error: ImportError, advice: str) -> MissingExtraError | MemoryLimitError:
    """Return the error to raise from one of an import.

    Args:
        error: What the import raised.
        advice: The message if the library is not installed: what needs it, and how to install it.
    """
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, MemoryError) or any(said in str(cause) for said in _OF_MEMORY):
            return MemoryLimitError(f"no memory left to import a library: {error}")
        cause = cause.__cause__ or cause.__context__
    return MissingExtraError(advice)
