"""A case of the corpus: what it is called, what opens it, and how its files are made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from .watched import Ending

Content = bytes | str | Callable[[], bytes]
Wants = Literal["refused", "loaded", "either"]

MOST_CHARACTERS = 900
"""Of a message."""


@dataclass(frozen=True)
class Case:
    """One hostile input.

    Attributes:
        name: Unique among those of its entrance.
        entrance: What opens it, of `entrances.ENTRANCES`.
        file: The name of the file that is opened.
        write: Makes that file, and those that it names, in a folder.
        wants: How it must end: "refused" where anything else would be wrong data.
    """

    name: str
    entrance: str
    file: str
    write: Callable[[Path], object]
    wants: Wants = "either"

    @property
    def id(self) -> str:
        return f"{self.entrance}: {self.name}"


def of_files(
    entrance: str,
    name: str,
    file: str,
    content: Content,
    wants: Wants = "either",
    others: Mapping[str, Content] | None = None,
) -> Case:
    """A case of one file, and of others that it may name."""
    contents = {file: content, **(others or {})}

    def write(folder: Path) -> None:
        for path, what in contents.items():
            made = what() if callable(what) else what
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_bytes(made.encode() if isinstance(made, str) else made)

    return Case(name, entrance, file, write, wants)


def judge(case: Case, ending: Ending) -> str:
    """What is wrong with how a case ended; nothing where it is right."""
    if ending.kind == "fault":
        return ending.text
    if case.wants not in ("either", ending.kind):
        return f"wants to be {case.wants}, and is {ending.kind}: {ending.text or ending.warned}"
    if ending.kind == "loaded":
        return ""
    named = case.file[:40] in ending.text or repr(case.file)[1:40] in ending.text
    if not named:
        return f"does not name {case.file!r}: {ending.text}"
    if "\n" in ending.text.replace(case.file, "").strip():
        return f"says more than a line: {ending.text}"
    if len(ending.text) > MOST_CHARACTERS + 2 * len(case.file):
        return f"says {len(ending.text)} characters: {ending.text[:300]} ..."
    return ""
