"""A robot in a viewer: where it is, and the files from which a page makes it again."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Vector
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.closing import start
from eurdf.kinematics.named import Named, configuration_of
from eurdf.kinematics.tolerances import START
from eurdf.mechanism.body import Body
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, root_joint
from eurdf.viewing.live_robot import PageRobot, page_robot_of
from eurdf.viewing.messages import Coordinates, Facts, Model, Show
from eurdf.viewing.worker import Worker

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class ShownRobot:
    """A robot in a viewer; made by `Viewer.add`.

    Attributes:
        robot: The robot.
        configurations: The named configurations (nq,): those of the description, and those saved since.
        version: How many versions of it there were before.
        on_show: Called after each change of the configuration.
        interrupt: Called before a program shows a configuration.
    """

    def __init__(
        self,
        send: Callable[[Any], None],
        worker: Worker,
        robot: Robot,
        files: PageRobot | None,
        q: Named | None,
        number: int,
        origin: Vector,
    ) -> None:
        self._send, self._worker, self._number, self._origin = send, worker, number, origin
        self.on_show: Callable[[], None] = lambda: None
        self.interrupt: Callable[[], None] = lambda: None
        self.version = -1
        self.replace(robot, files, q)

    @property
    def q(self) -> Vector:
        """The configuration (nq,) that is shown."""
        return np.array(self._q)

    def show(self, q: Named) -> None:
        """Show a configuration.

        Args:
            q: Configuration (nq,); it may be open.

        Raises:
            ValueError: ``q`` has another shape or is not finite.
        """

        def go() -> None:
            self.interrupt()
            self.go_to(q)

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

    def go_to(self, q: Named, *, sends: Callable[[Any], None] | None = None) -> None:
        """Go to a configuration, which is sent to every page unless told otherwise; for the thread of the worker."""
        self._q = np.array(configuration_of(self.robot, q))
        (sends or self._send)(Show(self._number, self.robot.joint_positions(self._q)))
        self.on_show()

    def replace(self, robot: Robot, files: PageRobot | None, q: Named | None) -> None:
        """Take another version of the robot, near q, without sending it; for the thread of the worker.

        Its files are written anew if there are none.

        Raises:
            ValueError: ``q`` is not a configuration.
        """
        q = assemble(robot, start(robot, q, "q"), tolerance=START).q
        self._files = files or page_robot_of(replace(robot, mechanism=_with_contacts_as_closures(robot.mechanism)))
        self.robot, self._q, self.configurations = robot, q, dict(robot.configurations)
        self.version += 1

    def model(self, facts: Facts | None) -> Model:
        """The message that describes this robot to a page."""
        return Model(
            robot=self._number,
            version=self.version,
            urdf=self._files.urdf,
            description=self._files.description,
            meshes={name: address for address, name in self._addresses().items()},
            xyz=tuple(self._origin.tolist()),
            q=self.robot.joint_positions(self._q),
            configurations={name: self.robot.joint_positions(q) for name, q in self.configurations.items()},
            facts=facts,
        )

    def mesh(self, address: str) -> bytes | None:
        """The content of the mesh file that has an address, if there is one."""
        name = self._addresses().get(address)
        return None if name is None else self._files.meshes[name]

    def _addresses(self) -> dict[str, str]:
        place = f"/mesh/{self._number}/{self.version}"
        return {f"{place}/{index}": name for index, name in enumerate(self._files.meshes)}

    def __repr__(self) -> str:
        return f"<ShownRobot '{self.robot.mechanism.name}', number {self._number}>"


def carried_to(robot: Robot, q: Vector, other: Robot) -> Coordinates:
    """The configuration of another version of a robot in which its joints are where they are at q (nq,)."""
    names = {joint.name: len(joint.type.coordinates) for joint in other.mechanism.joints if joint.mimic is None}
    here = robot.joint_positions(q)
    kept = {name: values for name, values in here.items() if names.get(name) == len(values)}
    if other.mechanism.root == "floating" and ROOT_JOINT in here:
        kept[ROOT_JOINT] = here[ROOT_JOINT]
    return kept


def _with_contacts_as_closures(mechanism: Mechanism) -> Mechanism:
    """A mechanism whose contacts are closures, as files have no others; a floating root then hangs from a link."""
    if not mechanism.contacts:
        return mechanism
    contacts = mechanism.contacts
    if mechanism.root == "floating":
        names = {body.name for body in mechanism.bodies}
        world = next(name for name in ("world", *(f"world_{n}" for n in range(len(names) + 1))) if name not in names)
        contacts = tuple(replace(each, a=replace(each.a, body=world)) for each in contacts)
        joint = replace(root_joint(mechanism.bodies[0].name), parent=world)
        mechanism = replace(
            mechanism, root="fixed", bodies=(Body(world), *mechanism.bodies), joints=(joint, *mechanism.joints)
        )
    return replace(mechanism, closures=(*mechanism.closures, *contacts), contacts=())
