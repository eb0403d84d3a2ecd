"""The server of the page: HTTP and a websocket on one port, for pages of its own address alone."""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import mimetypes
import socket
import threading
from collections.abc import Callable, Collection
from http import HTTPStatus
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

#: The address to listen on, unless told.
LOOPBACK = "127.0.0.1"

#: The port to listen on, unless told; the next free one if it is in use.
PORT = 8080
_PORTS = 100

#: Where the page connects to.
SOCKET = "/socket"

# Bytes of the longest message of a page: a trajectory.
_LONGEST_MESSAGE = 1 << 27

# A page loads nothing from elsewhere, and runs no script that is in a file of a robot.
_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; connect-src 'self' blob: data:; "
        "img-src 'self' blob: data:; media-src blob:; base-uri 'none'; form-action 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class Server:
    """Serves files, and carries messages between pages and a viewer, in a thread of its own."""

    def __init__(
        self,
        host: str,
        port: int | None,
        *,
        file: Callable[[str], bytes | None],
        greeting: Callable[[], list[str]],
        receive: Callable[[str | bytes, Any], None],
    ) -> None:
        """Start it.

        Args:
            host: Address or name of the interface to listen on.
            port: Port, 0 for any; None for `PORT` or the next free one.
            file: The content of the file at a path of an address, or None if there is none.
            greeting: The messages that a new page gets; called in the thread of the server.
            receive: Called with a message of a page and the page, in the thread of the server.
                `ValueError` closes the connection.

        Raises:
            MissingExtra: websockets is not installed.
            OSError: The address cannot be listened on.
        """
        try:
            import websockets.asyncio.server as library
        except ImportError:
            raise MissingExtra(
                f"the viewer needs websockets; install it with: {install_command('view')}", "view"
            ) from None
        self._library = library
        self._host, self._file, self._greeting, self._receive = host, file, greeting, receive
        self._names = set() if _is_loopback(host) else _names_of_this_machine()
        self._pages: set[ServerConnection] = set()
        self._socket = _free_socket(host, port)
        self._loop = asyncio.new_event_loop()
        self._ended = asyncio.Event()
        self._thread = threading.Thread(target=self._loop.run_until_complete, args=(self._run(),), daemon=True)
        self._thread.name = "eurdf viewer server"
        self._thread.start()

    @property
    def url(self) -> str:
        """The address to open in a browser on the same machine."""
        host = "localhost" if self._host in ("0.0.0.0", "::") else self._host
        return f"http://{f'[{host}]' if ':' in host else host}:{self._socket.getsockname()[1]}"

    def send(self, message: str, *, but: Any = None, to: Any = None) -> None:
        """Send a message to every page but one, or to one."""

        def now() -> None:
            pages = self._pages - {but} if to is None else self._pages & {to}
            self._library.broadcast(pages, message)

        with contextlib.suppress(RuntimeError):  # the server has ended
            self._loop.call_soon_threadsafe(now)

    def stop(self) -> None:
        """Close all connections, and stop listening."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._ended.set)
            self._thread.join()
            self._loop.close()

    async def _run(self) -> None:
        silent = logging.Logger("eurdf.viewing", logging.CRITICAL + 1)  # else a page that leaves early is an error
        async with self._library.serve(
            self._serve,
            sock=self._socket,
            process_request=self._answer,
            compression=None,
            max_size=_LONGEST_MESSAGE,
            server_header=None,
            logger=silent,
            close_timeout=1.0,
        ):
            await self._ended.wait()

    async def _serve(self, page: ServerConnection) -> None:
        for greeting in self._greeting():  # without awaiting, so that no later message is missed
            self._library.broadcast({page}, greeting)
        self._pages.add(page)
        try:
            async for message in page:
                self._receive(message, page)
        except ValueError as error:
            await page.close(1003, str(error)[:100])
        finally:
            self._pages.discard(page)

    def _answer(self, page: ServerConnection, request: Request) -> Response | None:
        """The answer to a request; None if it may connect to the socket."""
        origin, host = request.headers.get("Origin"), request.headers.get("Host")
        if not is_allowed(origin or f"http://{host}", host, self._host, self._names):
            return page.respond(HTTPStatus.FORBIDDEN, "this page may not connect\n")
        path = urlsplit(request.path).path
        if path == SOCKET:
            return None
        content = self._file(path)
        if content is None:
            return page.respond(HTTPStatus.NOT_FOUND, "there is no such file\n")
        answer = page.respond(HTTPStatus.OK, "")
        kind = mimetypes.guess_type(f"a{path}")[0] or "application/octet-stream"
        kind = "text/html" if path == "/" else "text/javascript" if path.endswith(".js") else kind
        del answer.headers["Content-Type"], answer.headers["Content-Length"]
        answer.headers.update(
            {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content)), **_HEADERS}
        )
        answer.body = content
        return answer


def is_allowed(origin: str | None, host: str | None, listens: str, names: Collection[str] = ()) -> bool:
    """Whether a page may connect.

    A page of any web site can connect to a server on the machine of who looks at it; the browser states its origin.
    The owner of a web site can also have its name lead to this machine (DNS rebinding); then the origin is the host.
    Therefore the host must be an address, which leads nowhere else, or a name that is known to be of this machine.

    Args:
        origin: Header ``Origin`` of the request; without one, the host.
        host: Header ``Host``.
        listens: What the server listens on.
        names: Names of this machine, in lower case.
    """
    name = _host_name(origin or "")
    if _is_loopback(name):
        return True
    if _is_loopback(listens):
        return False
    if name is None or name != _host_name(f"//{host}"):
        return False
    return _address(name) is not None or name == listens.lower() or name in names


def _names_of_this_machine() -> set[str]:
    own = socket.gethostname().lower()
    return {own, f"{own}.local", socket.getfqdn().lower()}


def _host_name(url: str) -> str | None:
    try:
        return urlsplit(url).hostname
    except ValueError:  # such as an address of IPv6 without its end
        return None


def _address(name: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(name)
    except ValueError:
        return None


def _is_loopback(name: str | None) -> bool:
    address = _address(name or "")
    return name == "localhost" or (address is not None and address.is_loopback)


def _free_socket(host: str, port: int | None) -> socket.socket:
    """A socket that listens, or `OSError`."""
    if port is not None:
        return _bound(host, port)
    for candidate in range(PORT, PORT + _PORTS):
        with contextlib.suppress(OSError):
            return _bound(host, candidate)
    return _bound(host, 0)


def _bound(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listening = socket.socket(family, kind, protocol)
        try:
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind(address)
            listening.listen()
        except BaseException:
            listening.close()
            raise
    except (OSError, OverflowError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise OSError(f"cannot listen on '{host}', port {port}: {(reason or str(error)).lower()}") from None
    return listening
