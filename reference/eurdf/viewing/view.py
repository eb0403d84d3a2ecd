"""`eurdf.view`: a robot in the browser."""

from __future__ import annotations

import webbrowser
from collections.abc import Mapping
from typing import Any

from eurdf.kinematics.array import Vector
from eurdf.pinocchio.robot import Robot
from eurdf.reading.robot_source import RobotSource
from eurdf.viewing.files import RobotOnDisk
from eurdf.viewing.server import LOOPBACK
from eurdf.viewing.viewer import Viewer


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
