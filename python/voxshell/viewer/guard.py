"""Protection of a server on this machine: it answers only its own pages, at a secret address.

Any page that is open in the user's browser can send requests to this machine: to a socket of
127.0.0.1, or through a host name that it redirects there (DNS rebinding).
"""

from __future__ import annotations

import http
import logging
import secrets
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from unittest.mock import patch

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

    Process = Callable[[ServerConnection, Request], Response | None]

_patching = threading.Lock()

_SILENT = logging.getLogger("voxshell.viewer.guard")
_SILENT.addHandler(logging.NullHandler())
_SILENT.propagate = False


def make_token() -> str:
    """Return a new secret: 128 bits, suitable for an address."""
    return secrets.token_urlsafe(16)


def is_welcome(request: Request, port: int, token: str) -> bool:
    """Return whether a request uses the secret address and does not come from another page.

    Args:
        request: Request for a page or a socket.
        port: Port of this server.
        token: The secret with which the path must begin.
    """
    names = {f"127.0.0.1:{port}", f"localhost:{port}"}
    hosts, origins = (request.headers.get_all(name) for name in ("Host", "Origin"))
    if len(hosts) != 1 or hosts[0].lower() not in names:
        return False
    # Browsers state the origin of every socket, and of requests from other pages.
    is_socket = "Upgrade" in request.headers
    if len(origins) > 1 or (is_socket and not origins):
        return False
    if origins and origins[0].lower() not in {f"http://{name}" for name in names}:
        return False
    first = request.path.partition("?")[0].split("/")[1:2]
    return bool(first) and secrets.compare_digest(first[0].encode(), token.encode())


@contextmanager
def guarding(token: str, head: str = "") -> Iterator[Callable[[], bool]]:
    """Make the server that viser starts in the block refuse all other requests.

    viser has no setting for this, and starts the server in a separate thread.

    Args:
        token: The secret with which paths must begin.
        head: HTML to add to the head of the page.

    Yields:
        A function that returns whether a protected server has started.
    """
    from websockets.asyncio import server as websockets

    serve = websockets.serve
    started = threading.Event()

    def serve_guarded(*args: Any, process_request: Process | None = None, **kwargs: Any) -> Any:
        if getattr(process_request, "__module__", "").split(".")[0] != "viser":
            return serve(*args, process_request=process_request, **kwargs)
        assert process_request is not None
        started.set()
        # Errors from other clients' broken requests would only clutter the terminal.
        kwargs.setdefault("logger", _SILENT)
        return serve(*args, process_request=_guard(process_request, token, head), **kwargs)

    with _patching, patch.object(websockets, "serve", serve_guarded):
        yield started.is_set


def _guard(process: Process, token: str, head: str) -> Process:
    def answer(connection: ServerConnection, request: Request) -> Response | None:
        if not is_welcome(request, connection.local_address[1], token):
            return connection.respond(
                http.HTTPStatus.FORBIDDEN, "Open the whole address, with the secret in it.\n"
            )
        request.path = request.path[1 + len(token) :] or "/"
        if head and "Accept-Encoding" in request.headers:
            del request.headers["Accept-Encoding"]  # so that the page comes as text
        response = process(connection, request)
        if response is not None:
            response.headers["Referrer-Policy"] = "no-referrer"  # the referrer contains the secret
            if head and response.headers.get("Content-Type", "").startswith("text/html"):
                _add_to_head(response, head)
        return response

    return answer


def _add_to_head(response: Response, head: str) -> None:
    assert response.body is not None
    response.body = response.body.replace(b"<head>", b"<head>" + head.encode(), 1)
    del response.headers["Content-Length"]
    response.headers["Content-Length"] = str(len(response.body))
