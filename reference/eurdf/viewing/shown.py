"""A robot in a viewer: its state, and what is drawn of it; and a page with one that has controls."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Vector
from eurdf.kinematics.named import Named
from eurdf.viewing.figure import Figure
from eurdf.viewing.files import RobotOnDisk
from eurdf.viewing.scene import PlacedRobot, Scene
from eurdf.viewing.session import Session
from eurdf.viewing.worker import Worker

if TYPE_CHECKING:
    import viser

    from eurdf.pinocchio.robot import Robot


class ShownRobot:
    """A robot in a viewer; made by `Viewer.add`.

    Attributes:
        session: Its state.
        figure: Its nodes in the scene.
        on_place: Called after each change of what is shown.
    """

    def __init__(
        self, server: viser.ViserServer, worker: Worker, robot: Robot, q: Named | None, node: str, origin: Vector
    ) -> None:
        self._server, self._worker = server, worker
        self._node, self._origin, self._versions = node, origin, 0
        self.on_place: Callable[[PlacedRobot], None] = lambda placed: None
        self.session = Session(robot, q)
        self.figure = self._drawn()

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.session.robot

    @property
    def q(self) -> Vector:
        """The configuration (nq,) that is shown."""
        return np.array(self.session.q)

    def show(self, q: Named) -> None:
        """Show a configuration.

        Args:
            q: Configuration (nq,); it may be open.

        Raises:
            ValueError: ``q`` has another shape or is not finite.
        """

        def go() -> None:
            self._worker.play(None)
            self.session.show(q)
            self.place()

        self._worker.call(go)

    def animate(self, qs: Iterable[Vector], dt: float) -> None:
        """Show configurations one after the other, and return after the last.

        Args:
            qs: Configurations (nq,).
            dt: Time from one to the next, s.

        Raises:
            ValueError: A configuration has another shape or is not finite, or ``dt`` is not a positive number.
        """
        if not 0.0 < dt < np.inf:
            raise ValueError(f"dt is {dt!r}; it must be a positive time, s")
        due = time.monotonic()
        for q in qs:
            self.show(q)
            due += dt
            time.sleep(max(0.0, due - time.monotonic()))

    def place(self) -> None:
        """Bring the page to the state of the session; for the thread of the worker."""
        with self._server.atomic():
            placed = self.figure.scene.at(self.session.q)
            self.figure.place(placed)
            self.on_place(placed)

    def replace(self, robot: Robot) -> None:
        """Show another version of the robot, where the old one is; for the thread of the worker."""
        before, shown = self.figure, self.figure.shown
        self.session = Session(robot, self.session.carried_to(robot))
        with self._server.atomic():
            self.figure = self._drawn()
            for layer, visible in shown.items():
                self.figure.toggle(layer, visible)
            before.remove()

    def _drawn(self) -> Figure:
        """Nodes of their own, at the state of the session."""
        scene = Scene(self.robot, self.session.q)
        self._versions += 1
        placed = scene.at(self.session.q)
        figure = Figure(self._server, scene, placed, f"{self._node}/version{self._versions}", self._origin)
        figure.highlight(frozenset(name for each in self.session.analysis.dependent_actuators for name in each))
        return figure

    def __repr__(self) -> str:
        return f"<ShownRobot '{self.robot.mechanism.name}' at '{self._node}'>"


@dataclass(slots=True, eq=False)
class Page:
    """A page with one robot that has controls.

    Attributes:
        server: The server of the page.
        worker: Does all that changes the state.
        shown: The robot.
        files: Where the robot comes from, if from files.
        messages: What the user should know, below the state of the loops.
        in_hand: Index of the slider that the user moves; it is not moved under the hand.
    """

    server: viser.ViserServer
    worker: Worker
    shown: ShownRobot
    files: RobotOnDisk | None
    messages: tuple[str, ...] = ()
    in_hand: int | None = field(default=None, init=False)

    def ask(self, key: Hashable, motion: Callable[[], Any], *, in_hand: int | None = None) -> None:
        """Have the user's motion done soon, in place of an earlier one of the same key; what is played stops.

        Args:
            key: What the motion is of.
            motion: Changes the session, and returns what to tell the user, or None.
            in_hand: Index of the slider that is moved, if one is.
        """

        def done() -> None:
            self.worker.play(None)
            said = motion()
            self.messages = () if said is None else (str(said),)
            self.in_hand = in_hand if said is None else None
            self.shown.place()
            self.in_hand = None

        self.worker.ask(key, done)

    def say(self, *messages: str) -> None:
        """Show messages, in place of those before; for the thread of the worker."""
        self.messages = messages
        self.shown.place()
