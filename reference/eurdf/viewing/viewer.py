"""`eurdf.view`: robots on a page in the browser."""

from __future__ import annotations

import html
import math
import os
import threading
import webbrowser
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from eurdf.array import Vector
from eurdf.diagnostics import Diagnostic
from eurdf.diagnostics.registry import Severity
from eurdf.diagnostics.wording import visible
from eurdf.errors import EurdfError, InvalidRobot
from eurdf.kinematics.analysis import FIGURES, analyze
from eurdf.kinematics.named import Named
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.robot import Robot
from eurdf.reading.robot_source import RobotSource
from eurdf.transmissions.passive_limits import PassiveLimit, passive_limits
from eurdf.viewing import messages
from eurdf.viewing.files import RobotOnDisk
from eurdf.viewing.graph import graph_svg
from eurdf.viewing.live_robot import PageRobot, live_page, page_robot_of
from eurdf.viewing.page_files import served_page
from eurdf.viewing.playback import GravityPlayback, TrajectoryPlayback, read_trajectory
from eurdf.viewing.player import Player
from eurdf.viewing.server import LOOPBACK, Server
from eurdf.viewing.shown import ShownRobot, carried_to
from eurdf.viewing.worker import Worker
from eurdf.writing.atomic_file import write_atomically
from eurdf.writing.saved_configuration import CannotSave, ConfigurationExists

# Time between looks at the files, s.
_LOOK = 0.5
# Time without a motion after which the singularity and the limits are computed, s.
_PAUSE = 0.25


class Viewer:
    """A page in the browser that shows robots; made by `eurdf.view`.

    The first robot has sliders and the other controls of the page. In a notebook, the viewer shows itself.
    """

    def __init__(self, robot: Robot, files: RobotOnDisk | None, host: str, port: int | None, q: Named | None) -> None:
        self._files, self._closed = files, threading.Event()
        self._worker = Worker(self._report)
        self._later: threading.Timer | None = None
        self._analyzed: messages.Analyzed | None = None
        self._shown: list[ShownRobot] = []
        try:
            served_page("/live.js")  # an error now, if the page is not built
            self._first = self._new(robot, None if files is None else files.page_robot(), q, np.zeros(3))
            self._facts = self._worker.call(self._known)
            self._shown.append(self._first)
            self._player = Player(self._worker, self._send)
            self._server = Server(host, port, file=self._file, greeting=self._greeting, receive=self._receive)
        except BaseException:
            self._worker.stop()
            raise
        self._first.on_show, self._first.interrupt = self._analyze_later, self._player.pause
        self._analyze_later()
        if files is not None:
            threading.Thread(target=self._watch, name="eurdf viewer files", daemon=True).start()

    @property
    def url(self) -> str:
        """The address of the page."""
        return self._server.url

    @property
    def robot(self) -> Robot:
        """The first robot."""
        return self._first.robot

    @property
    def q(self) -> Vector:
        """The configuration (nq,) of the first robot that is shown."""
        return self._first.q

    def show(self, q: Named) -> None:
        """Show a configuration of the first robot; see `ShownRobot.show`."""
        self._first.show(q)

    def animate(self, qs: Iterable[Vector], dt: float) -> None:
        """Show configurations of the first robot one after the other; see `ShownRobot.animate`."""
        self._first.animate(qs, dt)

    def replay(self, file: str | os.PathLike[str]) -> None:
        """Start to replay a trajectory with the first robot.

        Args:
            file: A CSV file. The first line names the columns: ``time`` (s) and joints (rad or m); those with several
                coordinates have a column for each, ``NAME:1``, ``NAME:2`` and so on. The other joints follow.

        Raises:
            OSError: It cannot be read.
            ValueError: It has an error; the text says in which line.
        """
        trajectory = read_trajectory(Path(file).read_text(encoding="utf-8"), self.robot)
        self._worker.call(lambda: self._player.play(TrajectoryPlayback(self._first, trajectory)))

    def add(self, robot: Robot, q: Named | None = None, *, xyz: Sequence[float] = (0.0, 0.0, 0.0)) -> ShownRobot:
        """Add a robot to the scene, without controls.

        Args:
            robot: The robot.
            q: Where it starts (nq,), closed if it is open; by default as in `eurdf.view`.
            xyz: Where the origin of its world is in the scene (3,), m.

        Returns:
            What moves it: ``.show(q)`` and ``.animate(qs, dt)``.

        Raises:
            ValueError: ``q`` or ``xyz`` does not fit.
        """
        origin = checked_array("xyz", xyz, (3,))

        def add() -> ShownRobot:
            shown = self._new(robot, None, q, origin)
            self._shown.append(shown)
            self._send(shown.model(None))
            return shown

        added: ShownRobot = self._worker.call(add)
        return added

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Write the first robot, as it is now, to a page that needs no server and no network.

        Args:
            file: Path of the HTML file; an existing one is replaced.

        Returns:
            The path.

        Raises:
            OSError: It cannot be written.
        """
        path = Path(file)
        write_atomically(path, live_page(page_robot_of(self.robot, self.q)))
        return path

    def close(self) -> None:
        """Close the page and stop the server."""
        self._closed.set()
        if self._later is not None:
            self._later.cancel()
        self._worker.stop()
        self._server.stop()

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Viewer of '{self.robot.mechanism.name}' at {self.url}>"

    def _repr_html_(self) -> str:
        """The page itself, in a notebook."""
        return f'<iframe src="{html.escape(self.url)}" width="100%" height="600" style="border: 0"></iframe>'

    def _new(self, robot: Robot, files: PageRobot | None, q: Named | None, origin: Vector) -> ShownRobot:
        return ShownRobot(self._send, self._worker, robot, files, q, len(self._shown), origin)

    def _send(self, message: Any, *, but: Any = None, to: Any = None) -> None:
        self._server.send(messages.text_of(message), but=but, to=to)

    def _report(self, error: Exception) -> None:
        """Show an error of what the user did."""
        known = isinstance(error, (EurdfError, ValueError))
        self._send(messages.Say(str(error) if known else f"{type(error).__name__}: {error}", error=True))

    def _file(self, path: str) -> bytes | None:
        """The content of the file at a path of an address: of the page, or a mesh of a robot."""
        page = served_page(path)
        if page is not None:
            return page
        return next(filter(None, (each.mesh(path) for each in self._shown)), None)

    def _greeting(self) -> list[str]:
        """The messages for a page that connects."""
        found: list[Any] = [each.model(self._facts if each is self._first else None) for each in self._shown]
        found += [self._player.playing, *([self._analyzed] if self._analyzed else [])]
        return [messages.text_of(each) for each in found]

    def _known(self) -> messages.Facts:
        robot = self.robot
        analysis = analyze(robot, self._first.q)
        return messages.Facts(
            dimensions=tuple((name, getattr(analysis, name), meaning) for name, meaning in FIGURES.items()),
            dependent=analysis.dependent_actuators,
            note=analysis.left_out or "",
            graph=graph_svg(robot.mechanism),
            saves=self._files is not None and self._files.can_save,
            diagnostics=tuple(map(_stated, robot.diagnostics)),
        )

    def _receive(self, text: str | bytes, page: Any) -> None:
        """Have what a page says done soon, in place of an earlier message of its kind."""
        request = messages.request_of(text)
        self._worker.ask(type(request).__name__, lambda: self._do(request, page))

    def _do(self, request: messages.Request, page: Any) -> None:
        first, player = self._first, self._player
        match request:
            case messages.Moved(version, q):
                if version == first.version:  # else the page does not have the robot yet
                    player.pause()
                    first.go_to(q, sends=lambda message: self._send(message, but=page))
            case messages.Save(name, replace):
                self._save(name, replace, page)
            case messages.Gravity(dissipation, held):
                player.play(GravityPlayback(first, dissipation=dissipation, held=held))
            case messages.Follow(name, content):
                try:
                    trajectory = read_trajectory(content, first.robot)
                except ValueError as error:
                    raise ValueError(f"'{name}': {error}") from None
                player.play(TrajectoryPlayback(first, trajectory))
            case messages.Pause(paused, step):
                player.pause(paused, step=step)
            case messages.Seek(time, speed):
                player.seek(time, speed)
            case messages.End():
                player.play(None)

    def _save(self, name: str, replace: bool, page: Any) -> None:
        """Save where the robot is; a configuration that would be replaced is asked about."""
        first = self._first
        try:
            if self._files is None:
                raise CannotSave("the robot does not come from files, so its configurations cannot be saved")
            said = self._files.save(name, first.robot, first.q, replace=replace)
        except ConfigurationExists as reason:
            self._send(messages.Exists(name, str(reason)), to=page)
        except CannotSave as reason:
            self._send(messages.Say(str(reason), error=True), to=page)
        else:
            first.configurations[name] = first.q
            self._send(messages.Saved(name, first.robot.joint_positions(first.q), said))

    def _analyze_later(self) -> None:
        """Compute the distance to singularity and the limits of passive joints once the robot is still."""
        if self._later is not None:
            self._later.cancel()
        self._later = threading.Timer(_PAUSE, lambda: self._worker.ask("analysis", self._analyze))
        self._later.daemon = True
        self._later.start()

    def _analyze(self) -> None:
        first = self._first
        found = analyze(first.robot, first.q)
        limits: tuple[PassiveLimit, ...] = ()
        reason = ""
        try:
            limits = passive_limits(first.robot, first.q)
        except (EurdfError, ValueError) as error:
            reason = str(error)
        self._analyzed = messages.Analyzed(
            found.singularity, found.actuation_singularity, tuple(map(_limit, limits)), reason
        )
        self._send(self._analyzed)

    def _watch(self) -> None:
        """Load the robot again when its files change."""
        assert self._files is not None
        while not self._closed.wait(_LOOK):
            if self._files.has_changed:
                self._worker.ask("files", self._reload)

    def _reload(self) -> None:
        assert self._files is not None
        first, player = self._first, self._player
        try:
            robot = self._files.load()
        except InvalidRobot as refusal:
            error = next((str(each) for each in refusal.diagnostics if each.severity is Severity.ERROR), "")
            text = f"the files changed and have errors; this is the robot before. {error}"
            self._send(messages.BadFiles(text, tuple(map(_stated, refusal.diagnostics))))
        except (EurdfError, OSError) as error:
            text = f"the files changed and cannot be loaded; this is the robot before. {error}"
            self._send(messages.BadFiles(text, ()))
        else:
            falls = player.gravity
            player.play(None)
            first.replace(robot, self._files.page_robot(), carried_to(first.robot, first.q, robot))
            self._facts = self._known()
            self._send(first.model(self._facts))
            self._send(messages.Say("the files changed: this is the robot now"))
            self._analyze_later()
            if falls is not None:
                player.play(GravityPlayback(first, dissipation=falls.dissipation, held=falls.held))


def view(
    robot: RobotSource | Robot,
    q: Named | None = None,
    *,
    host: str = LOOPBACK,
    port: int | None = None,
    browser: bool = False,
    options: Mapping[str, Any] | None = None,
) -> Viewer:
    """Show a robot on a page in the browser, with a slider for each actuator.

    The loops stay closed: the passive joints follow on the same branch. The page shows what the analysis says and the
    diagnostics. If `robot` is a path, the page is updated when its files change, and can write configurations to them.

    Args:
        robot: A robot, or what `eurdf.load` takes.
        q: Where to start (nq,); the loops are closed first if they are open. The default is the ``assembled``
            configuration, or a closed one that is found.
        host: The address to listen on. By default only programs on this machine can connect; with another one,
            programs on other machines can move the robot, and write configurations if `robot` is a path. The page
            opens under an IP address, ``localhost``, the host name of this machine, or this name.
        port: The port to listen on, 0 for any; by default 8080 or the next free one.
        browser: Whether to open the page.
        options: Keyword arguments of `eurdf.load`, if `robot` is not loaded yet.

    Returns:
        The viewer. It ends with the program, or when it is closed.

    Raises:
        MissingExtra: The extra ``view`` is not installed.
        InvalidRobot: The robot cannot be built without guessing.
        RobotNotFound: There are no such files.
        OSError: The address cannot be listened on.
        ValueError: ``q`` is not a configuration.
    """
    files = None
    if not isinstance(robot, Robot):
        files = RobotOnDisk(robot, dict(options or {}))
        robot = files.load()
    viewer = Viewer(robot, files, host, port, q)
    if browser:
        webbrowser.open(viewer.url)
    return viewer


def _limit(limit: PassiveLimit) -> Mapping[str, Any]:
    def finite(value: float) -> float | None:
        return value if math.isfinite(value) else None

    return {
        "name": limit.name,
        "unit": limit.unit,
        "velocity": finite(limit.velocity),
        "torque": tuple(map(finite, limit.torque)),
    }


def _stated(found: Diagnostic) -> Mapping[str, Any]:
    """A diagnostic as a page shows it."""
    return {
        "severity": found.severity.value,
        "code": found.code,
        "place": visible(str(found.place)),
        "message": visible(found.message),
        "hint": None if found.hint is None else visible(found.hint),
    }
