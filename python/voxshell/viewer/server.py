"""The viser server that a scene is made on."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from voxshell.errors import MissingExtraError
from voxshell.viewer.guard import guarding, make_token

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
def silent_server(port: int = 0, *, token: str | None = None) -> Iterator[viser.ViserServer]:
    """A viser server that says nothing itself: viser makes scenes only through one.

    It listens on the loopback interface until the scene is done, and answers those alone who ask at
    :func:`make_address`.

    Args:
        port: Where, or the next one that is free; 0: the system picks one.
        token: The secret in its address; by default, one that nobody knows.

    Raises:
        MissingExtraError: If viser is not installed, or one that cannot be guarded.
    """
    viser = import_viser()
    with _silence(), guarding(make_token() if token is None else token) as is_guarded:
        server = viser.ViserServer(host="127.0.0.1", port=port, verbose=False)
    try:
        if not is_guarded():
            raise MissingExtraError(
                f"viser {viser.__version__} starts its server in a way that cannot be kept from pages of "
                "others; run: pip install 'viser<2'"
            )
        yield server
    finally:
        with _silence():
            server.stop()


def make_address(server: viser.ViserServer, token: str) -> str:
    """Where a server shows its scene, for a browser on this machine."""
    return f"http://127.0.0.1:{server.get_port()}/{token}/"


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
