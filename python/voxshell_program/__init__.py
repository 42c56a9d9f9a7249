"""The program ``voxshell``: ends on Ctrl-C from its first import on.

It lies beside the package because importing anything of ``voxshell`` imports numpy first, and an
interrupt would find Python in the midst of that.
"""

from __future__ import annotations

import os
import signal
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType

_INTERRUPTED = 130


def main() -> None:
    """Runs the command line; exits with 0 only on success."""
    # Programs that a shell starts in the background ignore interrupts, and go on doing so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)
    from voxshell.cli import main as run

    run()


def _end(_number: int, _frame: FrameType | None) -> None:
    """Ends the process as it stands: where this is called, nothing is half written."""
    os._exit(_INTERRUPTED)
