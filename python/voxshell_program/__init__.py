"""The program ``voxshell``, which ends on Ctrl-C from its first import on.

It is outside of the package because importing anything from ``voxshell`` imports numpy first, and
an interrupt could come during that import.
"""

from __future__ import annotations

import os
import signal
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType

_INTERRUPTED = 130


def main() -> None:
    """Run the command line and exit; the exit code is 0 only on success."""
    # Programs that a shell starts in the background ignore interrupts, and must continue to.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    from voxshell.cli import main as run

    run()


def _end(_number: int, _frame: FrameType | None) -> None:
    """End the process at once: no file is being written at this point."""
    os._exit(_INTERRUPTED)
