from __future__ import annotations

import pytest
from voxshell.scenes.toml_lines import find_line

TEXT = """\
# A comment
title = "one"

[a]
list = [
  1,
  2,
]
text = '''
x = 1
'''

# Before b
[a.b]
x.y = 3
inline = { z = 1 }
[[rows]]
n = 1
"""


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        (["title"], 2),
        (["a"], 4),
        (["a", "list"], 5),
        (["a", "text"], 9),
        (["a", "b"], 14),
        (["a", "b", "x", "y"], 15),
        (["a", "b", "inline", "z"], 16),
        (["a", "missing"], 4),
        (["rows"], 17),
        (["missing"], 1),
    ],
)
def test_lines_are_where_keys_begin(keys, line):
    assert find_line(TEXT, keys) == line
