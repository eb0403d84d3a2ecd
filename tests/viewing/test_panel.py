"""The page of the viewer, without a browser."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import urllib.request
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.transmissions.passive_limits import PassiveLimit, passive_limits
from eurdf.viewing import text
from eurdf.viewing.files import RobotOnDisk
from eurdf.viewing.graph import graph_svg
from eurdf.viewing.server import is_allowed
from eurdf.viewing.session import Session
from eurdf.viewing.worker import Worker
from eurdf.writing.saved_configuration import CannotSave, ConfigurationExists
from support.places import ROBOTS

MISSING = "viser is not installed: pip install -e '.[view]'"


@pytest.fixture
def viewer() -> Iterator[eurdf.viewing.Viewer]:
    pytest.importorskip("viser", reason=MISSING)
    with eurdf.view("four_bar", port=0) as viewer:
        yield viewer


def test_page_is_served_to_this_machine_alone(viewer: eurdf.viewing.Viewer) -> None:
    assert viewer.url.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(viewer.url, timeout=10) as answer:
        assert b"<html" in answer.read()
    port = int(viewer.url.rpartition(":")[2])
    with socket.socket() as other:  # another address of this machine
        other.settimeout(1.0)
        assert other.connect_ex(("127.0.0.2", port)) != 0


def test_name_that_leads_here_from_elsewhere_is_refused() -> None:
    """A site can let its name lead to any address: then the origin of its page is the host that the page asks for."""
    pytest.importorskip("viser", reason=MISSING)
    import viser
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    with eurdf.view("four_bar", host="0.0.0.0", port=0) as viewer:
        port = int(viewer.url.rpartition(":")[2])

        def answer(name: str) -> bytes | str:
            with (
                socket.create_connection(("127.0.0.1", port)) as route,
                connect(
                    f"ws://{name}:{port}",
                    sock=route,
                    subprotocols=[f"viser-v{viser.__version__}"],
                    origin=f"http://{name}:{port}",
                    max_size=None,
                ) as page,
            ):
                return page.recv(timeout=10)

        for own in ("localhost", "127.0.0.1", "192.0.2.7", "[::1]", socket.gethostname()):
            assert answer(own)
        for other in ("evil.example", "localhost.evil.example", f"{socket.gethostname()}.evil.example"):
            with pytest.raises(ConnectionClosed) as closed:
                answer(other)
            assert closed.value.rcvd is not None
            assert closed.value.rcvd.code == 1008


@pytest.mark.parametrize(
    ("origin", "host", "listens", "allowed"),
    [
        ("http://127.0.0.1:8080", "127.0.0.1:8080", "127.0.0.1", True),
        ("http://localhost:9000", "127.0.0.1:8080", "127.0.0.1", True),  # a forwarded port
        ("http://[::1]:8080", "[::1]:8080", "::1", True),
        (None, "127.0.0.1:8080", "127.0.0.1", True),
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


def test_port_in_use_is_an_error_and_default_is_the_next(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("viser", reason=MISSING)
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
    pytest.importorskip("viser", reason=MISSING)
    with pytest.raises(OSError, match=r"cannot listen on '192\.0\.2\.1'"):
        eurdf.view("four_bar", host="192.0.2.1", port=0)


def test_missing_viser_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(eurdf.errors.MissingExtra, match=r"the viewer needs viser; install it with: .*view"):
        eurdf.view("four_bar")
    assert main(["view", "four_bar", "--no-browser"]) == 2
    assert "the viewer needs viser" in capsys.readouterr().err


def test_shown_configurations_are_those_given(viewer: eurdf.viewing.Viewer) -> None:
    robot = viewer.robot
    q = robot.tree.integrate(viewer.q, np.full(robot.tree.nv, 0.1))
    viewer.show(q)
    assert (viewer.q == q).all()
    viewer.animate([q, robot.configurations["assembled"]], 0.01)
    assert (viewer.q == robot.configurations["assembled"]).all()
    with pytest.raises(ValueError, match="q"):
        viewer.show(q[:2])
    with pytest.raises(ValueError, match="dt"):
        viewer.animate([q], 0.0)
    with pytest.raises(ValueError, match="xyz"):
        viewer.add(robot, xyz=(0.0, 1.0))
    assert (viewer.q == robot.configurations["assembled"]).all()


def test_only_open_closures_are_red(viewer: eurdf.viewing.Viewer) -> None:
    """A distance closure has a line between its ends where it is closed, too."""
    shown = viewer.add(eurdf.load("double_wishbone", geometry=False))
    (lines, _), links = shown.figure._lines["closures"], shown.figure.scene.links

    def red() -> set[str]:
        between = np.asarray(lines.colors)[1::3, 0]
        return {link.name for link, color in zip(links, between.tolist(), strict=True) if color == [230, 30, 30]}

    assert red() == set()
    closed = shown.q
    shown.show(shown.robot.tree.integrate(closed, np.full(shown.robot.tree.nv, 0.1)))
    found = {opening.name for opening in eurdf.kinematics.closure_openings(shown.robot, shown.q) if opening.is_open}
    assert red() == found & {link.name for link in links} != set()
    shown.show(closed)
    assert red() == set()


def test_limits_are_those_at_the_configuration_shown(viewer: eurdf.viewing.Viewer) -> None:
    panel, robot = viewer._panel, viewer.robot
    contents = []
    for angle in (0.3, 0.9):
        viewer.show(eurdf.forward_kinematics(robot, {"motor_crank": angle}))
        viewer._worker.call(panel._analyze)
        contents.append(panel._limits.content)
        limit = next(each for each in passive_limits(robot, viewer.q) if each.name == "free_rocker")
        assert f"± {limit.velocity:.4g} rad/s" in contents[-1]
        assert f"± {limit.torque[1]:.4g} N·m" in contents[-1]
    assert contents[0] != contents[1]
    viewer.show(robot.tree.integrate(viewer.q, np.full(robot.tree.nv, 0.1)))
    viewer._worker.call(panel._analyze)
    assert "the loops are open" in panel._limits.content


def test_saved_page_needs_no_server(viewer: eurdf.viewing.Viewer, tmp_path: Path) -> None:
    page = viewer.save(tmp_path / "scene.html").read_text()
    assert "__VISER_EMBED_DATA__" in page
    assert viewer.url not in page


def test_pose_is_saved_to_the_description_and_comments_stay(tmp_path: Path) -> None:
    for name in ("robot.urdf", "robot.yaml"):
        (tmp_path / name).write_text((ROBOTS / "four_bar" / name).read_text())
    files = RobotOnDisk(tmp_path, {"root": "floating"})
    session = Session(files.load())
    assert files.can_save
    session.move(0, 0.4)
    assert files.save("bent knee", session) == f"saved configuration 'bent knee' to '{tmp_path / 'robot.yaml'}'"
    text_ = (tmp_path / "robot.yaml").read_text()
    assert "# Written by build.py" in text_
    robot = eurdf.load(tmp_path, strict=True)
    assert robot.joint_positions(robot.configurations["bent knee"])["motor_crank"] == pytest.approx((0.4,))
    assert np.abs(eurdf.residual(robot, robot.configurations["bent knee"])).max() < 1e-12
    assert not files.has_changed
    assert files.save("bent knee", session).endswith("already has this configuration")
    assert (tmp_path / "robot.yaml").read_text() == text_
    session.reset()
    with pytest.raises(ConfigurationExists, match="already has a different configuration 'bent knee'"):
        files.save("bent knee", session)
    (tmp_path / "robot.yaml").write_text(text_ + "# by hand\n")
    files.save("another", session)
    assert files.has_changed  # by hand, which is still to be shown
    session.show(session.robot.tree.integrate(session.q, np.full(session.robot.tree.nv, 0.3)))
    with pytest.raises(CannotSave, match="the loops are open"):
        files.save("open", session)


def test_pose_beyond_limits_is_saved_only_after_assembling(tmp_path: Path) -> None:
    lid = (
        '<link name="lid"/><joint name="hinge" type="revolute"><parent link="ground"/><child link="lid"/>'
        '<axis xyz="0 0 1"/><limit lower="0.5" upper="1" effort="1" velocity="1"/></joint></robot>'
    )
    urdf, yaml = ((ROBOTS / "four_bar" / name).read_text() for name in ("robot.urdf", "robot.yaml"))
    (tmp_path / "robot.urdf").write_text(urdf.replace("</robot>", lid))
    (tmp_path / "robot.yaml").write_text(yaml.replace("assembled: {}", "assembled: {hinge: 0.5}"))
    files = RobotOnDisk(tmp_path, {})
    session = Session(files.load())
    session.show(session.robot.tree.neutral())
    with pytest.raises(CannotSave, match=r"leaves out joints.*'hinge' \(limits 0.5 to 1 rad\)"):
        files.save("low", session)
    session.assemble()
    files.save("low", session)
    assert dict(eurdf.load(tmp_path).mechanism.configurations["low"]) == {"hinge": (0.5,)}


NOT_SAVED = ["four_bar", ROBOTS / "four_bar/robot.v1.yaml", ROBOTS / "four_bar/robot.urdf"]


@pytest.mark.parametrize("robot", [*NOT_SAVED, (ROBOTS / "four_bar/robot.urdf").read_text()], ids=range(4))
def test_pose_is_not_saved_where_it_cannot_be(robot: str | Path) -> None:
    files = RobotOnDisk(robot, {})
    files.load()
    assert not files.can_save
    assert not files.has_changed


def test_names_are_text_of_the_page() -> None:
    hostile = "<img src=x onerror=alert(1)>"
    opening = eurdf.results.Opening(hostile, 0.1, 0.0)
    limit = PassiveLimit(hostile, "m", np.inf, (-3.0, 2.0))
    for shown in (text.status(1.0, [opening], [hostile]), text.limits([limit])):
        assert "<img" not in shown
        assert "&lt;img src=x onerror=alert(1)&gt;" in shown
    assert "no limit" in text.limits([limit])
    assert "-3 to 2 N<" in text.limits([limit])


def test_graph_has_a_line_for_each_link_and_an_arc_for_each_closure() -> None:
    mechanism = eurdf.load("digit_leg", geometry=False).mechanism
    svg = ElementTree.fromstring(graph_svg(mechanism))
    space = {"svg": "http://www.w3.org/2000/svg"}
    lines = svg.findall(".//svg:text", space)
    assert [line.text for line in lines] == [body.name for body in mechanism.bodies]
    joints = [line.find("svg:title", space).text for line in lines[1:]]
    assert joints == [f"{joint.type} joint {joint.name}" for joint in mechanism.joints]
    arcs = [title.text for title in svg.findall(".//svg:path/svg:title", space)]
    assert arcs == [f"{closure.name} ({closure.type})" for closure in mechanism.closures]
    assert sum(line.get("font-weight") is not None for line in lines) == len(mechanism.actuators)
    attack = "<img src=x onerror=alert(1)>"
    hostile = graph_svg(replace(mechanism, bodies=(replace(mechanism.bodies[0], name=attack),), joints=(), closures=()))
    assert "<img" not in hostile
    assert attack in [element.text for element in ElementTree.fromstring(hostile).iter()]


@pytest.mark.slow
def test_command_ends_with_an_interrupt() -> None:
    pytest.importorskip("viser", reason=MISSING)
    command = [sys.executable, "-m", "eurdf", "view", "four_bar", "--no-browser", "--port", "0"]
    with subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # Where the tests run as a background job of a script, SIGINT is ignored, also by what they start.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:
        try:
            assert running.stdout is not None
            assert running.stdout.readline().startswith("four_bar: http://127.0.0.1:")
            running.send_signal(signal.SIGINT)
            assert running.communicate(timeout=30) == ("", "")
        finally:
            running.kill()
    assert running.returncode == 0


def test_trajectory_with_an_error_ends_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("viser", reason=MISSING)
    file = tmp_path / "walk.csv"
    file.write_text("time,motor\n0,0\n")
    assert main(["view", "four_bar", "--no-browser", "--port", "0", "--trajectory", os.fspath(file)]) == 2
    assert f"'{file}': line 1: there is no joint 'motor'" in capsys.readouterr().err


@pytest.mark.parametrize("port", ["-1", "65536", "a"])
def test_command_refuses_wrong_port(port: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_:
        main(["view", "four_bar", f"--port={port}"])
    assert exit_.value.code == 2
    assert "is not a port" in capsys.readouterr().err


def test_worker_runs_the_last_of_each_key_and_frames_between() -> None:
    errors: list[Exception] = []
    worker = Worker(errors.append)
    ran: list[int] = []
    begun, go_on = threading.Event(), threading.Event()
    worker.ask("first", lambda: (begun.set(), go_on.wait(10)))
    assert begun.wait(10)
    for number in range(5):
        worker.ask("slider", lambda number=number: ran.append(number))
    worker.ask("wrong", lambda: 1 / 0)
    go_on.set()
    assert worker.call(lambda: "done") == "done"
    assert ran == [4]
    assert [type(error) for error in errors] == [ZeroDivisionError]
    with pytest.raises(ZeroDivisionError):
        worker.call(lambda: 1 / 0)

    frames: list[int] = []
    ended = threading.Event()

    def play() -> Iterator[float]:
        for frame in range(3):
            frames.append(frame)
            yield 0.001
        ended.set()

    worker.play(play())
    assert ended.wait(10)
    assert frames == [0, 1, 2]
    worker.stop()
    with pytest.raises(RuntimeError, match="closed"):
        worker.call(lambda: None)
