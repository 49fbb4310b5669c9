"""The server of the live page, which answers its own page alone.

A page of any site may send requests to servers on the machine of its reader, and a site may let its own name
point to that machine. The browser says from which page a request comes (Origin) and under which name it found
the server (Host); a request that gives a foreign page or name is refused before anything is read from it.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from http import HTTPStatus
from ipaddress import ip_address
from socket import gethostname
from typing import Any
from urllib.parse import urlsplit

import viser
import websockets.asyncio.server
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from modelgen.errors import ModelgenError

Handler = Callable[[Any], Awaitable[None]]
MALFORMED = 1007  # the code by which a connection ends whose message cannot be read
SILENT = logging.Logger("modelgen.view", level=logging.CRITICAL + 1)


def serve_page(host: str, port: int, label: str) -> viser.ViserServer:
    """The started server of a page at `host`, at `port` or the next free one.

    Raises:
        ModelgenError: the installed viser starts its server in a way that cannot be guarded.
    """
    with _guarded(host) as guarded:
        server = viser.ViserServer(host=host, port=port, label=label, verbose=False)
    if not guarded:
        server.stop()
        found = f"viser {viser.__version__}, whose server cannot be kept to its own page"
        raise ModelgenError("view", found, "viser 1.1 is known to work", 'run: pip install "viser==1.1.*"')
    return server


def is_own_request(request: Request, host: str) -> bool:
    """Whether a request names this server, by `host`, an address or the name of this machine, and comes from
    no page or from that of the same address."""
    names = request.headers.get_all("Host")
    if len(names) != 1 or not _is_own_name(names[0], host):
        return False
    return all(origin == f"http://{names[0]}" for origin in request.headers.get_all("Origin"))


def _is_own_name(address: str, host: str) -> bool:
    try:
        name = urlsplit(f"//{address}").hostname or ""
        if name in (host.lower(), "localhost", gethostname().lower()):
            return True
        ip_address(name)  # no name that a site could let point to here
    except ValueError:
        return False
    return True


@contextmanager
def _guarded(host: str) -> Iterator[list[bool]]:
    """Servers that viser starts meanwhile are guarded; yields a list that is not empty once one was."""
    guarded: list[bool] = []
    serve = websockets.asyncio.server.serve

    def serve_own_page(handler: Handler, *place: Any, process_request: Any = None, **options: Any) -> Any:
        def admit(connection: Any, request: Request) -> Response | None:
            if is_own_request(request, host):
                return process_request(connection, request) if process_request else None
            body = b"this page answers requests of its own address only\n"
            length = Headers({"Content-Type": "text/plain", "Content-Length": str(len(body))})
            return Response(HTTPStatus.FORBIDDEN, "Forbidden", length, body)

        asyncio.get_running_loop().set_exception_handler(_leave_out)
        guarded.append(True)
        return serve(_ending_at_malformed(handler), *place, process_request=admit, logger=SILENT, **options)

    websockets.asyncio.server.serve = serve_own_page  # type: ignore[misc, assignment]
    try:
        yield guarded
    finally:
        websockets.asyncio.server.serve = serve  # type: ignore[misc]


def _ending_at_malformed(handler: Handler) -> Handler:
    """The handler of a connection, which a message that cannot be read ends."""

    async def handle(connection: Any) -> None:
        try:
            await handler(connection)
        except ConnectionClosed:
            pass
        except Exception as error:
            await connection.close(MALFORMED, f"malformed message: {type(error).__name__}")

    return handle


def _leave_out(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """A message that could be read and not be obeyed, as it names no control: nothing follows from it."""
