"""The viser server that a scene is made on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from voxshell.errors import MissingExtraError

if TYPE_CHECKING:
    from types import ModuleType

    import viser


def import_viser() -> ModuleType:
    """The package that makes scenes and pages.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import viser
    except ImportError as error:
        raise MissingExtraError(
            f"the viewer needs viser, which cannot be imported ({error}); "
            "run: pip install 'voxshell[viewer]'"
        ) from error
    return viser


@contextmanager
def silent_server(port: int = 0) -> Iterator[viser.ViserServer]:
    """A viser server that says nothing itself: viser makes scenes only through one.

    It listens on the loopback interface until the scene is done.

    Args:
        port: Where, or the next one that is free; 0: the system picks one.

    Raises:
        MissingExtraError: If viser is not installed.
    """
    viser = import_viser()
    with _silence():
        server = viser.ViserServer(host="127.0.0.1", port=port, verbose=False)
    try:
        yield server
    finally:
        with _silence():
            server.stop()


@contextmanager
def _silence() -> Iterator[None]:
    """Mutes rich's shared console, on which viser announces its start and stop, asked or not."""
    import rich

    console = rich.get_console()
    quiet, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = quiet
