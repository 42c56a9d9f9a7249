"""Tests build their models, whatever was built before, and leave nobody's cache fuller."""

import os

os.environ["VOXSHELL_CACHE_SIZE"] = "0"
