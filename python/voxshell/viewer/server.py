"""The viser server on which scenes are made."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from voxshell.base.arguments import as_integer
from voxshell.base.extras import explain_import
from voxshell.errors import MissingExtraError
from voxshell.viewer.guard import guarding, make_token

if TYPE_CHECKING:
    from types import ModuleType

    import viser


def import_viser() -> ModuleType:
    """Return viser, which makes scenes and pages.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import viser
    except ImportError as error:
        raise explain_import(
            error,
            f"the viewer needs viser, which cannot be imported ({error}); "
            "run: pip install 'voxshell[viewer]'",
        ) from error
    return viser


@contextmanager
def silent_server(
    port: int = 0, *, token: str | None = None, head: str = ""
) -> Iterator[viser.ViserServer]:
    """Yield a viser server that prints nothing; viser can make scenes only on a server.

    It listens on the loopback interface until the scene is done, and answers only requests to
    :func:`make_address`.

    Args:
        port: Its port, or the next free one. 0: the system chooses one.
        token: The secret in its address; a random one by default.
        head: HTML to add to the head of its page; the default adds nothing.

    Raises:
        MissingExtraError: viser is not installed, or this version cannot be protected.
        SettingsError: The port is not an integer from 0 to 65535.
    """
    port = as_integer(port, "port", 0, 65535)  # viser would wait forever for another one
    viser = import_viser()
    secret = make_token() if token is None else token
    with _silence(), guarding(secret, head) as is_guarded:
        server = viser.ViserServer(host="127.0.0.1", port=port, verbose=False)
    try:
        if not is_guarded():
            raise MissingExtraError(
                f"viser {viser.__version__} starts its server in a way that cannot be protected from "
                "other pages; run: pip install 'viser<2'"
            )
        yield server
    finally:
        with _silence():
            server.stop()


def make_address(server: viser.ViserServer, token: str) -> str:
    """Return the address of a server's scene for a browser on this machine."""
    return f"http://127.0.0.1:{server.get_port()}/{token}/"


@contextmanager
def _silence() -> Iterator[None]:
    """Mute rich's shared console, on which viser always announces its start and stop."""
    import rich

    console = rich.get_console()
    quiet, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = quiet
