"""A robot of the oracle, with all quantities of the protocol."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eurdf_conformance.oracle import canonical, closing, configuration, coupling, distance, hinge, mass_matrix
from eurdf_conformance.oracle.configuration import Configuration
from eurdf_conformance.oracle.description import Description
from eurdf_conformance.oracle.dimensions import Dimensions, dimensions
from eurdf_conformance.oracle.jacobian import jacobian
from eurdf_conformance.oracle.joint_property import properties
from eurdf_conformance.oracle.kinematics import Kinematics, kinematics
from eurdf_conformance.oracle.residual import residual
from eurdf_conformance.oracle.spatial import Array, inverse
from eurdf_conformance.oracle.tree import Placed, Tree
from eurdf_conformance.oracle.urdf import Inertia, Urdf
from eurdf_conformance.protocol.message import CanonicalRobot, Jacobian, MassMatrix, Pose, Quantity, Values

#: For each type of closure whether its rows are lengths, `l`, or angles, `a`.
ROWS = {"3d": "lll", "6d": "lllaaa", "hinge": "lllaa", "distance": "l"}


@dataclass(frozen=True)
class OracleRobot:
    """What two files say. Configurations are by joint, in the coordinates of files; one left out is at its neutral."""

    urdf: Urdf
    description: Description
    tree: Tree

    def canonical(self) -> CanonicalRobot:
        """The canonical description."""
        return canonical.canonical(self.urdf, self.description, self.tree)

    def neutral(self) -> dict[str, list[float]]:
        """The configuration with every joint at neutral."""
        return {name: list(q) for name, q in configuration.neutral(self.tree).items()}

    def moved(self, q: Configuration, v: Array) -> dict[str, list[float]]:
        """The configuration q ⊕ v, after 1 s of a constant velocity; v in the order of `velocities`."""
        return configuration.moved(self.tree, q, v)

    @cached_property
    def velocities(self) -> list[tuple[str, int]]:
        """The columns of K and M: a joint and the index of its velocity."""
        return configuration.velocities(self.tree)

    @cached_property
    def closures(self) -> dict[str, tuple[str, Placed, Placed]]:
        """Types and frames A and B of the closures, by name."""
        refer = self.tree.refer
        return {
            closure.name: (closure.type, refer(closure.a), refer(closure.b)) for closure in self.description.closures
        }

    def row_sizes(self, L: float) -> dict[str, list[float]]:
        """By the name of a closure or coupling, what each of its rows is divided by to be free of units.

        Args:
            L: A length, m, that counts as much as a radian.
        """
        sizes = {
            name: [L if unit == "l" else 1.0 for unit in ROWS[kind]] for name, (kind, _, _) in self.closures.items()
        }
        for each in self.description.couplings:
            largest, unit = coupling.unit(self.tree, each)
            sizes[each.name] = [largest * (L if unit == "l" else 1.0)]
        return sizes

    @cached_property
    def masses(self) -> list[tuple[Inertia, Placed]]:
        """Inertias and poses of links."""
        places = self.tree.links
        return [(link.inertia, places[name]) for name, link in self.urdf.links.items() if link.inertia]

    @cached_property
    def _sharing(self) -> Array:
        return configuration.sharing(self.tree)

    @cached_property
    def armature(self) -> Array:
        """Armature for each velocity, kg·m² or kg."""
        return armature_at_leaders(self)

    def kinematics(self, q: Configuration) -> Kinematics:
        """Poses and motions of the bodies."""
        return kinematics(self.tree, configuration.coordinates(self.tree, q))

    @cached_property
    def bodies(self) -> list[list[str]]:
        """For each body of the URDF its links, which fixed or locked joints connect."""
        found: dict[int, list[str]] = {}
        for name, place in self.tree.links.items():
            found.setdefault(place.body, []).append(name)
        return list(found.values())

    def residuals(self, q: Configuration) -> dict[str, Array]:
        """The rows of r of each closure and coupling; m, rad."""
        at = self.kinematics(q)
        found = {}
        for closure, (kind, a, b) in zip(self.description.closures, self.closures.values(), strict=True):
            if closure.length is not None:
                found[closure.name] = distance.residual(at, a, b, closure.length)
            elif closure.axes:
                found[closure.name] = hinge.residual(at, a, b, closure.axes)
            else:
                found[closure.name] = residual(at, kind, a, b)
        return found | {each.name: coupling.residual(self.tree, q, each) for each in self.description.couplings}

    def jacobians(self, q: Configuration) -> dict[str, Array]:
        """The rows of K of each closure and coupling."""
        at = self.kinematics(q)
        found = {
            closure.name: jacobian(at, self._sharing, *placed, *([closure.axes] if closure.axes else []))
            for closure, placed in zip(self.description.closures, self.closures.values(), strict=True)
        }
        return found | {each.name: coupling.jacobian(self.velocities, each) for each in self.description.couplings}

    def residual(self, q: Configuration) -> Array:
        """The rows of r of all closures, in their order."""
        return np.concatenate([np.zeros(0), *self.residuals(q).values()])

    def jacobian(self, q: Configuration) -> Array:
        """All rows of K."""
        return np.vstack([np.zeros((0, len(self.velocities))), *self.jacobians(q).values()])

    def closed(self, q: Configuration) -> Configuration:
        """A configuration near q with all closures closed, or as nearly closed as possible."""
        return closing.closed(q, self.residual, self.jacobian, self.moved)

    def is_closed(self, q: Configuration) -> bool:
        """EU-CLO-005: whether every closure and every coupling is within its bound."""
        at, sizes, open_by = self.kinematics(q), self.row_sizes(1.0), [0.0]
        for name, rows in self.residuals(q).items():
            kind, *frames = self.closures.get(name, ("coupling",))
            distance_and_angle = rows / sizes[name]
            if kind == "6d":  # its first rows are no distance
                a, b = (at.pose(frame) for frame in frames)
                distance_and_angle[:3] = (inverse(a) @ b)[:3, 3]
            open_by += [float(np.linalg.norm(part)) for part in (distance_and_angle[:3], distance_and_angle[3:])]
        return max(open_by) <= closing.BOUND

    def loops_close(self) -> bool:
        """EU-CLO-005, EU-CLO-016: whether the robot is closed at `assembled`; if it has none, by the least search."""
        assembled = self.description.configurations.get("assembled")
        return self.least_search() is not None if assembled is None else self.is_closed(assembled)

    def least_search(self) -> Configuration | None:
        """EU-CLO-016: the closed configuration that every parser finds; None if this search finds none."""
        size = np.array([each for sizes in self.row_sizes(1.0).values() for each in sizes])
        neutral, ones = self.neutral(), np.ones(len(self.velocities))
        starts = [neutral, *(self.moved(neutral, aside * ones) for aside in closing.ASIDE)]
        found = (
            closing.search(
                q,
                self.is_closed,
                lambda q: self.residual(q) / size,
                lambda q: self.jacobian(q) / size[:, None],
                self.moved,
            )
            for q in starts
        )
        return next((q for q in found if q is not None), None)

    def mass_matrix(self, q: Configuration) -> Array:
        """M, with armatures."""
        return mass_matrix.mass_matrix(self.kinematics(q), self._sharing, self.armature, self.masses)

    def size(self, q: Configuration) -> float:
        """L: the largest distance of two frames, m, EU-PRO-008."""
        at = self.kinematics(q)
        frames = [*self.tree.links.values(), *self.tree.joint_frames.values(), *self.tree.added.values()]
        frames += [frame for _, *pair in self.closures.values() for frame in pair]
        points = np.array([at.pose(frame)[:3, 3] for frame in frames])
        return float(max(np.max(np.linalg.norm(points - point, axis=1)) for point in points))

    def dimensions(self, q: Configuration) -> Dimensions:
        """Rank, mobility and the other dimensions, which are defined at a closed configuration."""
        L = self.size(q) or 1.0
        rows = np.array([size for sizes in self.row_sizes(L).values() for size in sizes])
        columns = np.array([L if kind == "l" else 1.0 for kind in configuration.kinds(self.tree)])
        driven = {actuator.joint for actuator in self.description.actuators}
        S = np.eye(len(columns))[[name in driven for name, _ in self.velocities]]
        open_by = float(np.max(np.abs(self.residual(q) / rows), initial=0.0))
        return dimensions(self.jacobian(q), S, open_by, rows, columns)

    def evaluate(self, q: Configuration, frames: Sequence[str], quantities: Sequence[Quantity]) -> Values:
        """The answer to `evaluate` at one configuration: chapter The parser protocol, Values."""
        at = self.kinematics(q)
        values = Values()
        columns = self.velocities
        for quantity in quantities:
            found: object
            match quantity:
                case "poses":
                    found = {name: world_pose(at, self.tree.frame(name)) for name in frames}
                case "residuals":
                    found = {name: rows.tolist() for name, rows in self.residuals(q).items()}
                case "jacobian":
                    found = Jacobian(
                        columns=columns, rows={name: rows.tolist() for name, rows in self.jacobians(q).items()}
                    )
                case "mass_matrix":
                    found = MassMatrix(columns=columns, matrix=self.mass_matrix(q).tolist())
                case "mass":
                    found = mass_matrix.mass(self.masses)
                case "center_of_mass":
                    center = mass_matrix.center_of_mass(at, self.masses)
                    found = None if center is None else center.tolist()
            values = values.model_copy(update={quantity: found})
        return values


def armature_at_leaders(robot: OracleRobot) -> Array:
    """One a velocity, kg·m² or kg: Gᵀ diag(I) G, with the armature I of every joint, mimics too, EU-JNT-032."""
    motors = {actuator.joint: actuator for actuator in robot.description.actuators}
    found = [properties(joint, motors.get(joint.name)).armature for joint in robot.tree.joints]
    G = configuration.sharing(robot.tree)
    return np.diag(G.T @ np.diag([each for joint in found for each in joint]) @ G)


def world_pose(at: Kinematics, frame: Placed) -> Pose:
    """Of a frame in the world."""
    wMf = at.root @ at.pose(frame)
    return Pose(rotation=wMf[:3, :3].tolist(), translation=wMf[:3, 3].tolist())
