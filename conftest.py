"""Tests build their models, whatever was built before, and leave nobody's cache fuller."""

import os
import signal

os.environ["VOXSHELL_CACHE_SIZE"] = "0"

# A run in the background ignores interrupts, and so would the programs that tests interrupt.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
