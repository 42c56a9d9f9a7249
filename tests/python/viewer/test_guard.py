"""Pages of others, which any browser has open, cannot read what the viewer shows."""

from __future__ import annotations

import gzip
import http.client
import socket
import urllib.request
from collections.abc import Iterator
from contextlib import closing

import pytest
import viser
from voxshell.viewer.server import make_address, silent_server
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

TOKEN = "a-secret"


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    with silent_server(token=TOKEN) as server:
        yield server


def ask(server: viser.ViserServer, path: str, **headers: str) -> int:
    port = server.get_port()
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=10)) as connection:
        connection.putrequest("GET", path, skip_host="Host" in headers)
        for name, value in headers.items():
            connection.putheader(name, value.replace("PORT", str(port)))
        connection.endheaders()
        with connection.getresponse() as response:
            return response.status


@pytest.mark.parametrize(
    ("path", "headers", "status"),
    [
        (f"/{TOKEN}/", {}, 200),
        (f"/{TOKEN}", {}, 200),
        (f"/{TOKEN}/?a=b", {"Host": "localhost:PORT"}, 200),
        (f"/{TOKEN}/", {"Origin": "http://127.0.0.1:PORT"}, 200),
        (f"/{TOKEN}/nothing", {}, 404),
        (f"/{TOKEN}/../../etc/passwd", {}, 404),
        ("/", {}, 403),
        ("/another/", {}, 403),
        (f"/{TOKEN}more/", {}, 403),
        (f"/x/{TOKEN}/", {}, 403),
        (f"/{TOKEN}/", {"Host": "rebound.example:PORT"}, 403),
        (f"/{TOKEN}/", {"Host": "127.0.0.1"}, 403),
        (f"/{TOKEN}/", {"Host": "127.0.0.1:1"}, 403),
        (f"/{TOKEN}/", {"Origin": "https://others.example"}, 403),
        (f"/{TOKEN}/", {"Origin": "null"}, 403),
        (f"/{TOKEN}/", {"Origin": "http://127.0.0.1:1"}, 403),
    ],
)
def test_pages_are_for_the_address_with_the_secret(server, path, headers, status):
    assert ask(server, path, **headers) == status


def open_socket(server: viser.ViserServer, path: str, origin: str | None, host: str | None) -> bool:
    port = server.get_port()
    uri = f"ws://{host or '127.0.0.1'}:{port}{path}"
    version = f"viser-v{viser.__version__}"
    try:
        with connect(
            uri,
            sock=socket.create_connection(("127.0.0.1", port)),
            origin=origin and origin.replace("PORT", str(port)),  # pyright: ignore
            subprotocols=[version],  # pyright: ignore
            compression=None,
            proxy=None,
        ) as opened:
            return len(opened.recv(timeout=10)) > 0
    except InvalidStatus as error:
        return error.response.status_code != 403


@pytest.mark.parametrize(
    ("path", "origin", "host", "opens"),
    [
        (f"/{TOKEN}", "http://127.0.0.1:PORT", None, True),
        (f"/{TOKEN}/", "http://localhost:PORT", "localhost", True),
        ("/", "http://127.0.0.1:PORT", None, False),
        (f"/{TOKEN}", "https://others.example", None, False),
        (f"/{TOKEN}", "null", None, False),
        (f"/{TOKEN}", None, None, False),
        (f"/{TOKEN}", "http://rebound.example:PORT", "rebound.example", False),
    ],
)
def test_sockets_are_for_own_pages(server, path, origin, host, opens):
    """Any page could open the socket and read the scene."""
    assert open_socket(server, path, origin, host) == opens


def test_each_address_has_a_secret_of_its_own():
    from voxshell.viewer.guard import make_token

    tokens = {make_token() for _ in range(100)}
    assert len(tokens) == 100
    assert all(len(token) >= 22 for token in tokens)


def test_a_server_that_cannot_be_guarded_is_stopped(monkeypatch):
    from voxshell import MissingExtraError
    from voxshell.viewer import server

    stopped = []

    class Other:
        def __init__(self, **_: object) -> None: ...

        def stop(self) -> None:
            stopped.append(self)

    monkeypatch.setattr(viser, "ViserServer", Other)
    refused = pytest.raises(MissingExtraError, match="cannot be protected from other pages")
    with refused, server.silent_server():
        pass
    assert len(stopped) == 1


def test_the_address_has_the_port_and_the_secret(server):
    assert make_address(server, TOKEN) == f"http://127.0.0.1:{server.get_port()}/{TOKEN}/"


def test_a_head_is_added_to_the_page_alone():
    plain, added = [], []
    for pages, head in ((plain, ""), (added, "<style>p {}</style>")):
        with silent_server(token=TOKEN, head=head) as server:
            address = make_address(server, TOKEN)
            request = urllib.request.Request(address, headers={"Accept-Encoding": "gzip"})
            with urllib.request.urlopen(request, timeout=10) as response:
                pages.append(response.headers["Content-Encoding"])
                pages.append(response.read())
    assert plain[0] == "gzip"
    assert added[0] == "identity"
    page = gzip.decompress(plain[1]).decode()
    assert added[1].decode() == page.replace("<head>", "<head><style>p {}</style>", 1)
