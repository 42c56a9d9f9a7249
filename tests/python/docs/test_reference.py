"""The references name everything that is public, once."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import voxshell as vx

ROOT = Path(__file__).resolve().parents[3]
API = ROOT / "docs/api"


def test_every_public_name_is_in_the_python_reference():
    text = (API / "python.md").read_text()
    named = Counter(re.findall(r"^\.\. auto\w+:: voxshell\.(\w+)$", text, re.M))
    assert set(vx.__all__) == set(dir(vx))
    assert named == Counter(vx.__all__)


def test_every_public_header_is_in_the_cpp_reference():
    text = (API / "cpp.md").read_text()
    blocks = re.findall(r"^```\{cpp-headers\}\n(.*?)^```", text, re.M | re.S)
    named = Counter(line for block in blocks for line in block.split())
    folders = (ROOT / "core/include", ROOT / "bullet/include")
    headers = [
        path.relative_to(folder).as_posix()
        for folder in folders
        for path in folder.glob("voxshell/**/*.h")
    ]
    assert len(headers) > 20
    assert named == Counter(headers)
