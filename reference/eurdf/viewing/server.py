"""The server of the page: on one address, for pages of that address alone, and without ways out."""

from __future__ import annotations

import contextlib
import io
import ipaddress
import socket
from collections.abc import Collection
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra

if TYPE_CHECKING:
    import viser

#: The address to listen on, unless told.
LOOPBACK = "127.0.0.1"

#: The port to listen on, unless told; the next free one if it is in use.
PORT = 8080
_PORTS = 100

# Run in the page, again whenever it connects. The file asked for does not exist: an answer, whatever it is, will do.
_SAY_ENDED = """
if (!window.eurdfEnded) {
  const box = (window.eurdfEnded = document.createElement("div"));
  box.setAttribute("role", "alert");
  box.textContent = "the viewer has ended; run `eurdf view \u2026` again";
  box.style.cssText =
    "position: fixed; inset: 0 0 auto 0; z-index: 100000; padding: 12px; text-align: center;" +
    "font: 16px sans-serif; color: #fff; background: #b42318";
  setInterval(async () => {
    try {
      await fetch("/is-running", { cache: "no-store" });
      box.remove();
    } catch {
      document.body.append(box);
    }
  }, 2000);
}
"""


def start_server(host: str, port: int | None, title: str) -> viser.ViserServer:
    """Start a server.

    Args:
        host: Address or name of the interface to listen on.
        port: Port, 0 for any; None for `PORT` or the next free one.
        title: Heading of the panel.

    Raises:
        MissingExtra: viser is not installed.
        OSError: The address cannot be listened on.
    """
    try:
        import viser
        import viser._messages as messages
    except ImportError:
        raise MissingExtra(f"the viewer needs viser; install it with: {install_command('view')}", "view") from None
    with contextlib.redirect_stdout(io.StringIO()):  # it prints its address, and so do we
        server = viser.ViserServer(host, _free_port(host, port), label=title, verbose=False)
    # Otherwise any visitor of the page could ask for a public address of it.
    for message in (messages.ShareUrlRequest, messages.ShareUrlDisconnect):
        server._websock_server.unregister_handler(message)
    server.gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
    _greet(server, host)
    return server


def stop_server(server: viser.ViserServer) -> None:
    """Stop a server."""
    with contextlib.redirect_stdout(io.StringIO()):
        server.stop()


def url_of(server: viser.ViserServer) -> str:
    """The address to open in a browser on the same machine."""
    host = server.get_host()
    if host in ("0.0.0.0", "::"):
        host = "localhost"
    return f"http://{f'[{host}]' if ':' in host else host}:{server.get_port()}"


def is_allowed(origin: str | None, host: str | None, listens: str, names: Collection[str] = ()) -> bool:
    """Whether a page may connect.

    A page of any web site can connect to a server on the machine of who looks at it; the browser states its origin.
    The owner of a web site can also have its name lead to this machine (DNS rebinding); then the origin is the host.
    Therefore the host must be an address, which leads nowhere else, or a name that is known to be of this machine.

    Args:
        origin: Header ``Origin`` of the request; None from a program that is not a browser.
        host: Header ``Host``.
        listens: What the server listens on.
        names: Names of this machine, in lower case.
    """
    if origin is None:
        return True
    name = _host_name(origin)
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


def _greet(server: viser.ViserServer, listens: str) -> None:
    """Refuse pages of others, and have the page say when the server has ended."""
    import viser._messages as messages

    names = set() if _is_loopback(listens) else _names_of_this_machine()

    async def check(connection: Any) -> None:
        socket_ = server._websock_server._live_connections[connection.client_id]
        assert socket_.request is not None  # since the handshake
        headers = socket_.request.headers
        if not is_allowed(headers.get("Origin"), headers.get("Host"), listens, names):
            # Nothing of it is read: the messages of a connection are waited for after this.
            await socket_.close(1008, "this page may not connect")
            return
        # To this page alone: a saved page needs no server.
        connection.queue_message(messages.RunJavascriptMessage(_SAY_ENDED))

    server._websock_server.on_client_connect(check)


def _free_port(host: str, port: int | None) -> int:
    """A port that can be listened on, or `OSError`; viser would try others in silence."""
    if port is not None:
        return _bound(host, port)
    for candidate in range(PORT, PORT + _PORTS):
        with contextlib.suppress(OSError):
            return _bound(host, candidate)
    return _bound(host, 0)


def _bound(host: str, port: int) -> int:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind, protocol) as trial:
            trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind(address)
            return int(trial.getsockname()[1])
    except (OSError, OverflowError) as error:
        reason = error.strerror if isinstance(error, OSError) else None
        raise OSError(f"cannot listen on '{host}', port {port}: {(reason or str(error)).lower()}") from None
