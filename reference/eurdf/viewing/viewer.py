"""`eurdf.view`: robots on a page in the browser."""

from __future__ import annotations

import html
import os
import webbrowser
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from eurdf.array import Vector
from eurdf.errors import EurdfError
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.robot import Robot
from eurdf.reading.robot_source import RobotSource
from eurdf.viewing.files import RobotOnDisk
from eurdf.viewing.panel import Panel
from eurdf.viewing.playback import read_trajectory
from eurdf.viewing.server import LOOPBACK, start_server, stop_server, url_of
from eurdf.viewing.shown import Page, ShownRobot
from eurdf.viewing.worker import Worker
from eurdf.writing.atomic_file import write_atomically


class Viewer:
    """A page in the browser that shows robots; made by `eurdf.view`.

    The first robot has sliders and the other controls of the page. In a notebook, the viewer shows itself.
    """

    def __init__(self, robot: Robot, files: RobotOnDisk | None, host: str, port: int | None, q: Vector | None) -> None:
        self._server = start_server(host, port, robot.mechanism.name)
        self._worker = Worker(self._report)
        self._robots = 0
        try:
            self._first = self._shown(robot, q, np.zeros(3))
            self._look_at_first()
            self._page = Page(self._server, self._worker, self._first, files)
            self._panel = Panel(self._page)
            self._worker.call(self._first.place)
        except BaseException:
            self._worker.stop()
            stop_server(self._server)
            raise

    @property
    def url(self) -> str:
        """The address of the page."""
        return url_of(self._server)

    @property
    def robot(self) -> Robot:
        """The first robot."""
        return self._first.robot

    @property
    def q(self) -> Vector:
        """The configuration (nq,) of the first robot that is shown."""
        return self._first.q

    def show(self, q: Vector) -> None:
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
        self._panel.play(read_trajectory(Path(file).read_text(encoding="utf-8"), self.robot))

    def add(self, robot: Robot, q: Vector | None = None, *, xyz: Sequence[float] = (0.0, 0.0, 0.0)) -> ShownRobot:
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

        shown: ShownRobot = self._worker.call(lambda: self._shown(robot, q, origin))
        return shown

    def save(self, file: str | os.PathLike[str]) -> Path:
        """Write the scene, as it is now, to a page that needs no server and no network.

        Args:
            file: Path of the HTML file; an existing one is replaced.

        Returns:
            The path.

        Raises:
            OSError: It cannot be written.
        """
        path = Path(file)
        write_atomically(path, self._worker.call(self._server.scene.as_html))
        return path

    def close(self) -> None:
        """Close the page and stop the server."""
        self._panel.close()
        self._worker.stop()
        stop_server(self._server)

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Viewer of '{self.robot.mechanism.name}' at {self.url}>"

    def _repr_html_(self) -> str:
        """The page itself, in a notebook."""
        return f'<iframe src="{html.escape(self.url)}" width="100%" height="600" style="border: 0"></iframe>'

    def _shown(self, robot: Robot, q: Vector | None, origin: Vector) -> ShownRobot:
        self._robots += 1
        return ShownRobot(self._server, self._worker, robot, q, f"/robot{self._robots}", origin)

    def _report(self, error: Exception) -> None:
        """Show an error of what the user did."""
        known = isinstance(error, (EurdfError, ValueError))
        self._page.say(str(error) if known else f"{type(error).__name__}: {error}")

    def _look_at_first(self) -> None:
        scene = self._first.figure.scene
        camera, size = self._server.initial_camera, scene.size
        camera.look_at = scene.center
        camera.position = scene.center + 0.7 * size * np.array((1.0, -0.75, 0.45))
        camera.near = 0.01 * size
        self._server.scene.add_grid(
            "/ground",
            width=4.0 * size,
            height=4.0 * size,
            cell_size=0.1 * size,
            section_size=0.5 * size,
            position=(0.0, 0.0, scene.lowest),
        )


def view(
    robot: RobotSource | Robot,
    q: Vector | None = None,
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
