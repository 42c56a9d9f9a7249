"""Names of a command's options in messages that name the arguments of Python functions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from cyclopts import App


def find_command(app: App, arguments: Sequence[str]) -> list[str]:
    """Return the words of the arguments that name a command."""
    found = []
    for word in arguments:
        if word.startswith("-"):
            continue
        if word not in app:
            break
        found.append(word)
        app = app[word]
    return found


def list_options(app: App, arguments: Sequence[str]) -> list[str]:
    """Return the options of the command that the arguments name: "voxel-size" for --voxel-size."""
    for word in find_command(app, arguments):
        app = app[word]
    if app.default_command is None:
        return []
    names = [name for argument in app.assemble_argument_collection() for name in argument.names]
    return [name[2:] for name in names if name.startswith("--")]


def name_options(text: str, options: Collection[str]) -> str:
    """Return a message with options as people type them.

    Single words such as "resolution" are also English, so that they become options only with a value
    or beside another option. Calls such as Model.from_mesh(..., scale=0.001) stay as they are.

    Example:
        >>> options = ("voxel-size", "resolution", "open", "scale", "a-pose")
        >>> name_options("give either voxel_size or resolution, not both", options)
        'give either --voxel-size or --resolution, not both'
        >>> name_options("a_pose must be rigid; the resolution is 3; pass open='sheet'", options)
        '--a-pose must be rigid; the resolution is 3; pass --open sheet'
        >>> name_options("pass Model.from_mesh(..., scale=0.001) or scale=0.001", options)
        'pass Model.from_mesh(..., scale=0.001) or --scale 0.001'
        >>> name_options("scene.voxel_size must be above 0", options)
        'scene.voxel_size must be above 0'
    """
    if not options:
        return text
    any_name = "|".join(re.escape(name.replace("-", "_")) for name in options)
    begin = r"(?<![\w./'\"-])(?<!\.\.\., )"
    text = re.sub(rf"{begin}({any_name})=('?)([\w+-]*(?:\.\w+)*)\2", _show_value, text)
    text = re.sub(
        rf"{begin}({any_name})(?![\w=.(/-])",
        lambda found: _show(found[1]) if "_" in found[1] else found[0],
        text,
    )
    beside = rf"(--[a-z-]+(?:, | or | and ))({any_name})(?![\w=])"
    return re.sub(beside, lambda found: found[1] + _show(found[2]), text)


def _show_value(found: re.Match[str]) -> str:
    return f"{_show(found[1])} {found[3]}".rstrip()


def _show(name: str) -> str:
    return f"--{name.replace('_', '-')}"
