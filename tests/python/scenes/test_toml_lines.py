from __future__ import annotations

import pytest
from voxshell.scenes import toml_lines
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


def test_brackets_and_quotes_in_texts_begin_nothing():
    text = '[a]\nx = \'\'\'\n[b]\n\'\'\'\ny = """\\"""\n[b]""""\nz = "\\"[" # ]\n[b]\nk = \'[\'\n'
    assert find_line(text, ["b", "k"]) == 9
    assert find_line(text, ["b"]) == 8
    assert find_line(text, ["a", "z"]) == 7


def test_a_line_separator_in_a_text_is_no_line():
    assert find_line('a = "\u2028\x85"\nb = 1\n', ["b"]) == 2


def test_a_key_of_a_table_is_not_taken_for_one_of_another():
    assert find_line("[a]\nx = 1\n[b]\nx = 2\n", ["b", "x"]) == 4
    assert find_line("[a.b]\nx = 1\n[c.b]\nx = 2\n", ["c", "b", "x"]) == 4


def test_statements_behind_the_key_are_not_parsed(monkeypatch):
    """The first of 100,000 tables was unknown; to find its line, all of them were parsed."""
    parsed = []
    parse = toml_lines.parse_checked_toml
    monkeypatch.setattr(
        toml_lines, "parse_checked_toml", lambda text: parsed.append(text) or parse(text)
    )
    text = "".join(f"[a{i}]\nx = 1\n" for i in range(1000))
    assert find_line(text, ["a0", "x"]) == 2
    assert len(parsed) == 2
    assert find_line(text, ["a999", "y"]) == 1999


def test_a_value_is_not_parsed_again(monkeypatch):
    """A list of 247,000 numbers took as long to find as to read."""
    parsed = []
    parse = toml_lines.parse_checked_toml
    monkeypatch.setattr(
        toml_lines, "parse_checked_toml", lambda text: parsed.append(text) or parse(text)
    )
    text = "x = [" + "1, " * 1000 + "]\n"
    assert find_line(text, ["x", "y"]) == 1
    assert max(map(len, parsed)) < 10


@pytest.mark.parametrize(
    "statement",
    [
        "  a . b = 'c = d'",
        "\"a\".'b'= [\n{c=1}]",
        "a = {b = {c = 1}}",
        "a.b = {}",
        '"a".b = """\n= """',
    ],
)
def test_keys_are_told_from_values(statement):
    assert find_line(f"x = 1\n{statement}\n", ["a", "b"]) == 2
    assert find_line(f'"a = b" = 1\n"\\"=" = 1\n{statement}\n', ["a", "b"]) == 3
