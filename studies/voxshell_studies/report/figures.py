"""Style of the experiments' figures."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from voxshell.base.outputs import make_folder
from voxshell.errors import MissingExtraError
from voxshell.measuring.files import write_figure

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

OURS, OURS_COARSE, OURS_PLANE = "#0b6e4f", "#43aa8b", "#90be6d"
PEERS = ("#d1495b", "#5c6bc0", "#e09f3e", "#f4978e", "#7d5ba6")
FAINT = "#999999"


@contextmanager
def open_figure(path: Path, *, width: float = 10.0, height: float = 5.0) -> Iterator[Any]:
    """Yield a matplotlib figure that is written when the block ends, inches.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("figures need matplotlib: pip install voxshell-studies") from error
    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    yield figure
    for axes in figure.axes:
        axes.grid(visible=True, which="major", color="#dddddd", lw=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    make_folder(path.parent)
    write_figure(path, figure)


def as_rgb(color: str) -> tuple[int, int, int]:
    """Return the components of "#rrggbb", each 0 to 255.

    Example:
        >>> as_rgb("#0b6e4f")
        (11, 110, 79)
    """
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)
