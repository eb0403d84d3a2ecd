"""The server of the viewer: who may connect, what it serves, and what it does with wrong messages."""

from __future__ import annotations

import http.client
import socket
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.viewing.server import is_allowed

pytest.importorskip("websockets", reason="websockets is not installed: pip install -e '.[view]'")

from websockets.exceptions import InvalidStatus

from support.viewer_client import ViewerClient


@pytest.fixture(scope="module")
def viewer() -> Iterator[eurdf.viewing.Viewer]:
    with eurdf.view("four_bar", port=0) as viewer:
        yield viewer


def got(viewer: eurdf.viewing.Viewer, path: str, **headers: str) -> tuple[int, http.client.HTTPMessage, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", int(viewer.url.rpartition(":")[2]), timeout=20)
    connection.putrequest("GET", path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    found = answer.status, answer.headers, answer.read()
    connection.close()
    return found


def test_page_is_served_to_this_machine_alone(viewer: eurdf.viewing.Viewer) -> None:
    assert viewer.url.startswith("http://127.0.0.1:")
    status, headers, page = got(viewer, "/")
    assert (status, headers["Content-Type"]) == (200, "text/html; charset=utf-8")
    assert b"<html" in page
    for file in ("/live.js", "/live.css", "/page.css"):
        assert file.encode() in page
        status, headers, _ = got(viewer, file)
        assert status == 200
        assert "script-src 'self';" in headers["Content-Security-Policy"]
    with socket.socket() as other:  # another address of this machine
        other.settimeout(1.0)
        assert other.connect_ex(("127.0.0.2", int(viewer.url.rpartition(":")[2]))) != 0


@pytest.mark.parametrize(
    "path",
    [
        "/robot.urdf",
        "/../viewer.py",
        "/live.js/../../viewer.py",
        "/%2e%2e/viewer.py",
        "/mesh/0/0/0",
        "/mesh/0/0/../../..",
        "/etc/passwd",
    ],
)
def test_no_other_file_is_served(viewer: eurdf.viewing.Viewer, path: str) -> None:
    assert got(viewer, path)[0] == 404


def test_meshes_of_the_robot_are_served(tmp_path: Path) -> None:
    stl = bytes(80) + struct.pack("<I12fH", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    (tmp_path / "part.stl").write_bytes(stl)
    (tmp_path / "other.stl").write_bytes(stl)
    shape = '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'
    (tmp_path / "robot.urdf").write_text(f'<robot name="r"><link name="a">{shape}</link></robot>')
    with eurdf.view(tmp_path / "robot.urdf", port=0) as viewer, ViewerClient(viewer.url) as page:
        model = page.wait_for(lambda: page.last("model", 0))
        assert list(model["meshes"]) == ["part.stl"]
        assert got(viewer, model["meshes"]["part.stl"])[2] == stl


def test_name_that_leads_here_from_elsewhere_is_refused() -> None:
    """A site can let its name lead to any address: then the origin of its page is the host that the page asks for."""
    with eurdf.view("four_bar", host="0.0.0.0", port=0) as viewer:
        port = int(viewer.url.rpartition(":")[2])

        def answer(name: str) -> str:
            with (
                socket.create_connection(("127.0.0.1", port)) as route,
                ViewerClient(f"http://{name}:{port}", sock=route) as page,
            ):
                return page.wait_for(lambda: page.last("model", 0))["urdf"]

        for own in ("localhost", "127.0.0.1", "192.0.2.7", "[::1]", socket.gethostname()):
            assert "<robot" in answer(own)
        for other in ("evil.example", "localhost.evil.example", f"{socket.gethostname()}.evil.example"):
            with pytest.raises(InvalidStatus, match="403"):
                answer(other)
            assert got(viewer, "/", Host=f"{other}:{port}")[0] == 403


@pytest.mark.parametrize(
    ("origin", "host", "listens", "allowed"),
    [
        ("http://127.0.0.1:8080", "127.0.0.1:8080", "127.0.0.1", True),
        ("http://localhost:9000", "127.0.0.1:8080", "127.0.0.1", True),  # a forwarded port
        ("http://[::1]:8080", "[::1]:8080", "::1", True),
        (None, "127.0.0.1:8080", "127.0.0.1", False),
        ("https://example.com", "127.0.0.1:8080", "127.0.0.1", False),
        ("http://example.com:8080", "example.com:8080", "127.0.0.1", False),  # a name that leads to this machine
        ("null", "127.0.0.1:8080", "127.0.0.1", False),
        ("http://robot.lab:8080", "robot.lab:8080", "0.0.0.0", True),
        ("http://alias.lab:8080", "alias.lab:8080", "0.0.0.0", False),
        ("http://alias.lab:8080", "alias.lab:8080", "Alias.lab", True),  # the host of the command line
        ("http://10.0.0.5:8080", "10.0.0.5:8080", "0.0.0.0", True),
        ("http://10.0.0.6", "10.0.0.5:8080", "0.0.0.0", False),
        ("http://[::1", "[::1", "0.0.0.0", False),
        ("https://example.com", "robot.lab:8080", "0.0.0.0", False),
    ],
)
def test_origin_and_host_of_a_page_decide(origin: str | None, host: str, listens: str, allowed: bool) -> None:
    assert is_allowed(origin, host, listens, {"robot.lab"}) is allowed


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        ("{", "Expecting"),
        ("[1]", "has no type that is known"),
        ('{"type": "model"}', "has no type that is known"),
        ('{"type": ["moved"]}', "has no type that is known"),
        ("[" * 100_000, "nested too deeply"),
        ('{"type": "save", "name": 1, "replace": false}', "'name' of a message 'save' is not of type str"),
        ('{"type": "seek", "time": NaN, "speed": 1}', "'time' of a message 'seek' is not of type float"),
        ('{"type": "end", "more": 1}', "unexpected keyword argument 'more'"),
    ],
)
def test_wrong_message_closes_the_connection_with_a_reason(
    viewer: eurdf.viewing.Viewer, message: str, reason: str
) -> None:
    with ViewerClient(viewer.url) as page:
        page._socket.send(message)
        page._thread.join(20)
        assert page._socket.protocol.close_code == 1003
        assert reason in page._socket.protocol.close_reason
    with ViewerClient(viewer.url) as page:  # others can
        page.wait_for(lambda: page.last("model", 0))


def test_configuration_that_does_not_fit_is_reported(viewer: eurdf.viewing.Viewer) -> None:
    before = viewer.q
    with ViewerClient(viewer.url) as page:
        page.send("moved", version=0, q={"crank": [1.0]})
        page.wait_for(lambda: page.says("'crank'"))
        page.send("moved", version=7, q={"motor_crank": [1.0]})  # of a robot that is not shown any more
        page.send("moved", version=0, q={"motor_crank": [1.0, 2.0]})
        page.wait_for(lambda: page.says("'motor_crank'"))
    assert (viewer.q == before).all()


def test_port_in_use_is_an_error_and_default_is_the_next(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(OSError, match=f"cannot listen on '127.0.0.1', port {port}: address already in use"):
            eurdf.view("four_bar", port=port)
        assert main(["view", "four_bar", "--no-browser", "--port", str(port)]) == 2
        assert f"port {port}" in capsys.readouterr().err
    with eurdf.view("four_bar") as one, eurdf.view("bennett") as two:
        assert one.url != two.url


def test_address_that_does_not_exist_is_an_error() -> None:
    with pytest.raises(OSError, match=r"cannot listen on '192\.0\.2\.1'"):
        eurdf.view("four_bar", host="192.0.2.1", port=0)


def test_missing_websockets_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "websockets.asyncio.server", None)
    with pytest.raises(eurdf.errors.MissingExtra, match=r"the viewer needs websockets; install it with: .*view"):
        eurdf.view("four_bar")
    assert main(["view", "four_bar", "--no-browser"]) == 2
    assert "the viewer needs websockets" in capsys.readouterr().err
