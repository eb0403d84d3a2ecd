"""A URDF for Drake, and the tree of an SDFormat file, as Drake reads them."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from importlib.metadata import version
from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant
from pydrake.systems.analysis import Simulator

from eurdf.array import Matrix, Vector
from eurdf.convert.coordinates import rotation_matrix
from eurdf.convert.verification.read_model import (
    CannotRead,
    Diverged,
    Exported,
    Instant,
    Range,
    ReadModel,
    anchored,
    opening_between,
)
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.residual import closure_openings
from eurdf.mechanism.constraint import Coupling

# It warns of each unphysical inertia, and that friction has no effect, which is a loss.
logging.getLogger("drake").setLevel(logging.ERROR)

READER = f"Drake {version('drake')}"

_DRAKE = "{http://drake.mit.edu}"
_LOOPS = "model/joint[physics/simbody/must_be_loop_joint='true']"


class Plant:
    """A file in Drake: in discrete time, with the solver that has constraints.

    Args:
        text: Content of the file.
        kind: ``urdf`` or ``sdf``.
        step: s.

    Raises:
        CannotRead: Drake refuses it.
    """

    def __init__(self, text: str, kind: str, step: float = 1e-3) -> None:
        self.plant: Any = MultibodyPlant(step)
        self.plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        try:
            Parser(self.plant).AddModelsFromString(text, kind)
            self.plant.Finalize()
        except (RuntimeError, ValueError) as error:
            raise CannotRead(READER, error) from None
        self.context: Any = self.plant.CreateDefaultContext()

    @property
    def joints(self) -> list[Any]:
        """The joints that move, in the order of Drake's vectors."""
        joints = [self.plant.get_joint(index) for index in self.plant.GetJointIndices()]
        return sorted((each for each in joints if each.num_positions()), key=lambda each: each.position_start())

    def pose(self, frame: str) -> Any:
        """Of a link or a frame, (4, 4)."""
        return self.plant.GetFrameByName(frame).CalcPoseInWorld(self.context).GetAsMatrix4()

    @property
    def mass_matrix(self) -> Any:
        """For Drake's velocities."""
        return self.plant.CalcMassMatrix(self.context)

    @property
    def ranges(self) -> tuple[Range, ...]:
        """Of the coordinates that are rates of velocities."""
        found = []
        for joint in self.joints:
            lower, upper = joint.position_lower_limits(), joint.position_upper_limits()
            values = self.plant.GetPositions(self.context)[joint.position_start() :]
            if joint.type_name() not in ("quaternion_floating", "ball_rpy"):
                limits = zip(values, lower, upper, strict=False)
                found += [Range(joint.name(), *map(float, each)) for each in limits if np.isfinite(each[1:]).any()]
        return tuple(found)


class DrakeModel(ReadModel):
    """A URDF for Drake; see `ReadModel`."""

    reader = READER
    unverified = ("the robot falls without contacts: its shapes are not read",)
    step = 1e-3
    shorter = "divide the time step of MultibodyPlant by 2"

    def __init__(self, exported: Exported) -> None:
        self._exported, self.coordinates = exported, exported.coordinates
        self._text = exported.path.read_text(encoding="utf-8")
        self._here = Plant(self._text, "urdf")
        self.velocities = [
            (joint.name(), "m" if joint.type_name() == "prismatic" else "rad")
            for joint in self._here.joints
            for _ in range(joint.num_velocities())
        ]
        self._balls = self._read_balls()

    @property
    def mass(self) -> float:
        return float(self._here.plant.CalcTotalMass(self._here.context))

    def mass_matrix(self, q: Vector) -> Matrix:
        self._at(self._here, q)
        T = self.coordinates.rates(q)
        return np.asarray(T.T @ self._here.mass_matrix @ T)

    def openings(self, q: Vector) -> tuple[Opening, ...]:
        self._at(self._here, q)
        return self._openings(self._here)

    def ranges(self, q: Vector) -> tuple[Range, ...]:
        self._at(self._here, q)
        return self._here.ranges

    def fall(self, q: Vector, seconds: float, *, slower: int = 1, contacts: bool = True) -> Iterator[Instant]:
        step = self.step / slower
        there = Plant(self._text, "urdf", step)
        simulator = Simulator(there.plant)
        there.context = simulator.get_mutable_context()
        self._at(there, q)
        for count in range(1, round(seconds / step) + 1):
            try:
                simulator.AdvanceTo(count * step)
            except RuntimeError as error:
                raise Diverged(str(error).splitlines()[0]) from None
            positions, velocities = there.plant.GetPositions(there.context), there.plant.GetVelocities(there.context)
            if not (np.isfinite(positions).all() and np.isfinite(velocities).all()):
                raise Diverged("")
            yield Instant(count * step, positions, velocities, self._openings(there))

    def _at(self, there: Plant, q: Vector) -> None:
        there.plant.SetPositions(there.context, self.coordinates.to_q(q))
        there.plant.SetVelocities(there.context, np.zeros(there.plant.num_velocities()))

    def _read_balls(self) -> list[tuple[str, list[Any]]]:
        """The points that each closure holds together, as the file has them."""
        counts = {"3d": 1, "6d": 3, "hinge": 2}
        balls = iter(etree.fromstring(self._text.encode()).findall(f"{_DRAKE}ball_constraint"))
        found = []
        for closure in self._exported.robot.mechanism.closures:
            if closure.type in counts:
                found.append((closure.name, [_ends(next(balls)) for _ in range(counts[closure.type])]))
        return found

    def _openings(self, there: Plant) -> tuple[Opening, ...]:
        found = []
        for name, balls in self._balls:
            gaps = [there.pose(a) @ p - there.pose(b) @ r for (a, p), (b, r) in balls]
            found.append(Opening(name, max(float(np.linalg.norm(gap)) for gap in gaps), 0.0))
        return (*found, *_relations(self._exported, there.plant.GetPositions(there.context)))


def _ends(ball: Any) -> tuple[tuple[str, Any], ...]:
    """Of a ball constraint: for both bodies the name, and the point in it (4,)."""
    names = (ball.find(f"{_DRAKE}ball_constraint_body_{side}").get("name") for side in "AB")
    points = (ball.find(f"{_DRAKE}ball_constraint_p_{each}").get("value").split() for each in ("AP", "BQ"))
    return tuple((name, np.array([*map(float, point), 1.0])) for name, point in zip(names, points, strict=True))


def _relations(exported: Exported, positions: Any) -> Iterator[Opening]:
    """Of couplings and mimic joints."""
    yield from exported.off_mimics(positions)
    if exported.robot.mechanism.couplings:
        openings = closure_openings(exported.robot, exported.coordinates.from_q(positions))
        for constraint, opening in zip(exported.robot.constraints, openings, strict=True):
            if isinstance(constraint, Coupling):
                yield opening


class SdfTree(ReadModel):
    """An SDFormat file in Drake, which refuses joints with two parents: its loops are left out. See `ReadModel`."""

    reader = READER
    unverified = (
        "Drake reads the tree alone: the joints that close loops are compared by the poses of their links",
        "the fall is not simulated: Drake has no loop joints; simulate it where the file is used",
    )
    # Links between the joints that a joint becomes have 1e-9 kg and kg·m², which small robots notice.
    mass_tolerance = 1e-4

    def __init__(self, exported: Exported) -> None:
        self._exported = exported
        sdf = etree.parse(str(exported.path)).getroot()
        loops: Any = sdf.xpath(_LOOPS)
        self.loops: list[Any] = loops
        for loop in loops:
            loop.getparent().remove(loop)
        self.there = Plant(etree.tostring(sdf, encoding="unicode"), "sdf")

    @property
    def mass(self) -> float:
        return float(self.there.plant.CalcTotalMass(self.there.context))

    def mass_matrix(self, q: Vector) -> Matrix:
        T = self.at(q)
        return np.asarray(T.T @ self.there.mass_matrix @ T)

    def openings(self, q: Vector) -> tuple[Opening, ...]:
        self.at(q)
        written = {(loop.findtext("parent"), loop.findtext("child")) for loop in self.loops}
        return tuple(
            opening_between(closure, *(anchored(anchor, self.there.pose) for anchor in closure.anchors))
            for closure in self._exported.robot.mechanism.closures
            if (closure.a.body, closure.b.body) in written
        )

    def ranges(self, q: Vector) -> tuple[Range, ...]:
        self.at(q)
        return self.there.ranges

    def at(self, q: Vector) -> Matrix:
        """Move to q (nq,) of the robot; returns T: Drake's velocities are T v."""
        plant, context, map_ = self.there.plant, self.there.context, self._exported.coordinates
        values, rates = map_.to_q(q), map_.rates(q)
        positions, T = plant.GetPositions(context), np.zeros((plant.num_velocities(), rates.shape[1]))
        at_q = at_v = 0
        for part in map_.parts:
            if part.joint == "root_joint":
                # Drake has the orientation first, and angular velocities in the world.
                positions[:7] = np.roll(values[:7], 4)
                T[:6] = np.roll(rates[:6], 3, axis=0)
                T[:3] = rotation_matrix(_xyzw(values[3:7])) @ T[:3]
                at_q, at_v = 7, 6
                continue
            for name in part.names:
                joint = plant.GetJointByName(name)
                start, v, n = joint.position_start(), joint.velocity_start(), joint.num_velocities()
                mine = values[at_q : at_q + n]
                T[v : v + n] = rates[at_v : at_v + n]
                if joint.type_name() == "ball_rpy":
                    R = rotation_matrix(_xyzw(values[at_q : at_q + 4]))
                    mine = pin.rpy.matrixToRpy(R)
                    T[v : v + n] = R @ T[v : v + n]
                    at_q += 1
                positions[start : start + n] = mine
                at_q, at_v = at_q + n, at_v + n
        plant.SetPositions(context, positions)
        return T


def _xyzw(wxyz: Any) -> Any:
    w, x, y, z = wxyz
    return x, y, z, w
