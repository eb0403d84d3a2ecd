"""A robot ready for Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import pinocchio as pin

from eurdf.array import Vector
from eurdf.diagnostics import Diagnostic
from eurdf.mechanism.constraint import Constraint
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.pinocchio.actuation import Actuation, build_actuation
from eurdf.pinocchio.configuration import Slot, configuration_vector, joint_coordinates, slots
from eurdf.pinocchio.constraint import build_constraint_models
from eurdf.pinocchio.geometry import Geometry, Resolve, build_geometry
from eurdf.pinocchio.memory import Cached
from eurdf.pinocchio.meshes import Mesh
from eurdf.pinocchio.model import build_model
from eurdf.pinocchio.tree import Tree, build_tree

if TYPE_CHECKING:
    from typing_extensions import Self


#: A contact with its type, its place, and the further keys of its type.
StatedContact = Mapping[str, Any]


@dataclass(frozen=True, eq=False, repr=False)
class Robot(Cached):
    """A robot with closed kinematic chains, in Pinocchio's terms.

    It unpacks as ``model, constraint_models, actuation, visual_model, collision_model = robot``, which raises
    `NoConstraintModel` if the robot has distance closures or couplings.

    What the kinematics finds out about a robot once is kept with it, so do not change its model in place. Build
    another robot of a changed mechanism: ``build_robot(replace(robot.mechanism, closures=...), geometry=False)``, with
    `dataclasses.replace`.

    Take the mass matrix from `eurdf.mass_matrix`: up to Pinocchio 4.1, that of `pin.crba` has wrong entries where a
    mimic joint carries several branches.

    Attributes:
        mechanism: What it was built from, as plain data.
        model: The spanning tree.
        geometry: Its shapes; None without geometry.
        no_geometry: What makes the error that `visual_model` and `collision_model` raise, where the geometry was asked
            for and cannot be built; else None.
        diagnose: Finds the `diagnostics` of a robot that was loaded; else None.
        derived: What the functions of kinematics have computed from the robot and keep with it.
    """

    mechanism: Mechanism
    model: pin.Model
    geometry: Geometry | None = None
    no_geometry: Callable[[], Exception] | None = None
    diagnose: Callable[[Robot], tuple[Diagnostic, ...]] | None = None
    derived: dict[Any, Any] = field(default_factory=dict, init=False)

    @cached_property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What is wrong with the robot that was loaded, but does not keep it from being built.

        Whether its loops can close is among it only if the robot has a configuration ``assembled``, or was loaded with
        ``check_loops=True``. Inertias and this configuration are checked when the diagnostics are first used.
        """
        return () if self.diagnose is None else self.diagnose(self)

    @cached_property
    def tree(self) -> Tree:
        """The spanning tree as kinematics asks for it."""
        return build_tree(self.mechanism, self.model, self.slots)

    @cached_property
    def actuation(self) -> Actuation:
        """The actuated joints, in file order."""
        return build_actuation(self.mechanism, self.model, self.slots)

    @property
    def configurations(self) -> Mapping[str, Vector]:
        """For each named configuration its q (nq,), a copy that is the caller's."""
        return MappingProxyType({name: q.copy() for name, q in self._configurations.items()})

    @cached_property
    def _configurations(self) -> Mapping[str, Vector]:
        named = self.mechanism.configurations
        return {name: self.configuration(coordinates) for name, coordinates in named.items()}

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """Every closure and coupling, in file order, and every contact."""
        return self.mechanism.constraints

    @property
    def constraint_models(self) -> list[pin.RigidConstraintModel]:
        """Pinocchio's constraint models, in this order: a new list of the robot's own models, whose gains can be set.

        A 3d or 6d closure is one model of that type and name. A hinge is two 3d models: ``NAME`` of its origin, and
        ``NAME/axis`` of a point on its axis. Set the same gains in both. Their 6 rows have the rank 5, so
        ``pin.constraintDynamics`` needs `pin.ProximalSettings` with mu above 0.

        Raises:
            NoConstraintModel: A constraint is a distance closure or a coupling, for which Pinocchio has none. Use
                the other attributes one by one, and the functions of eurdf, such as `eurdf.forward_dynamics`.
        """
        return list(self._constraint_models)

    @cached_property
    def _constraint_models(self) -> list[pin.RigidConstraintModel]:
        return build_constraint_models(self.constraints, self.tree)

    @cached_property
    def data(self) -> pin.Data:
        """Pinocchio's working memory for the model, made on first use.

        It takes some 64 nv³ bytes, 64 MB for 100 velocities. What needs none: `load`, `check`, `assemble`, `analyze`.
        """
        return self.model.createData()

    @property
    def visual_model(self) -> pin.GeometryModel | None:
        """The visual shapes; None without geometry.

        Raises:
            InvalidRobot: A mesh is missing.
        """
        return self._shapes and self._shapes.visual

    @property
    def collision_model(self) -> pin.GeometryModel | None:
        """The collision shapes; None without geometry.

        Raises:
            InvalidRobot: A mesh is missing.
        """
        return self._shapes and self._shapes.collision

    @property
    def _shapes(self) -> Geometry | None:
        if self.no_geometry is not None:
            raise self.no_geometry()
        return self.geometry

    @cached_property
    def slots(self) -> Mapping[str, Slot]:
        """Each joint that has coordinates of its own, by name, with the indices of these and of its velocities."""
        return MappingProxyType(slots(self.mechanism))

    def configuration(self, positions: Mapping[str, float | Sequence[float]]) -> Vector:
        """The configuration (nq,) in which joints have the given positions: the inverse of `joint_positions`.

        Args:
            positions: By name of the joint, as a file states them; a joint that is not named is neutral. Those of mimic
                joints follow from their leaders', and are ignored.

        Raises:
            ValueError: A name is not a joint with coordinates, or a joint is given too few or too many of them, or a
                quaternion of length 0.
        """
        return configuration_vector(self.mechanism, self.model, positions, self.slots)

    def joint_positions(
        self, q: Vector | Mapping[str, float | Sequence[float]], *, mimic: bool = False
    ) -> dict[str, tuple[float, ...]]:
        """The positions of the joints at a configuration, as a file states them: the inverse of `configuration`.

        Args:
            q: Configuration (nq,), or positions by name as `configuration` takes them.
            mimic: Whether to return also those of joints that mimic another, which follow from that one's.

        Returns:
            For each joint that has coordinates of its own, by name: an angle (rad) or a length (m); of a universal
            joint two angles, of a cylindrical one length and angle, of a planar one x, y and angle; of a spherical one
            a quaternion x, y, z, w, of a floating one x, y, z and a quaternion. The joint of a floating root is
            ``root_joint``. Fixed joints have none. The angle of a joint without limits that Pinocchio has as (cos, sin)
            is from -pi to pi.

        Raises:
            ValueError: q does not have the shape (nq,), or is not finite.
        """
        q = self.configuration(q) if isinstance(q, Mapping) else q
        every = joint_coordinates(self.mechanism, self.model, q)
        own = (name for name in every if mimic or name in self.slots or name == ROOT_JOINT)
        return {name: every[name] for name in own}

    def with_contacts(
        self,
        contacts: Mapping[str, str | StatedContact],
        *,
        at: Vector | Mapping[str, float | Sequence[float]] | None = None,
    ) -> Self:
        """The robot with frames that are held against the world, such as the feet of a robot that stands.

        ``robot.with_contacts({"left_sole": "6d", "right_sole": "3d"}, at=q)``. A contact is a closure of the name of
        its frame: frame A is a place in the world, B is the frame of the robot. It counts in every function as the
        closures do, after closures and couplings. Its forces λ act on the robot, in the axes of the place: for a 6d
        contact, which keeps the frame there, in those of the frame. The new configuration ``assembled`` is closed, with
        these contacts; the others are as they were, and may open them.

        Contacts are added to those that the robot has. They are no part of the description: an export leaves them out,
        and lists them as losses. The new robot shares the model and the geometry of this one.

        Args:
            contacts: For each frame, by the name of a link, a joint (its frame on the child side) or a frame of the
                description, the type of the contact, as closures have it; or a mapping with ``type``, the further keys
                of this type (`axis`, `axes`, `length`), and ``at``: the place, a pose (`pin.SE3`, or (4, 4)), or a
                position (3,), m, with the orientation that the frame has.
            at: A closed configuration (nq,); a contact without a place is where its frame is there. The default is
                `assembled`, or the closed configuration that is found from neutral.

        Returns:
            A robot of the same class.

        Raises:
            ValueError: A frame is unknown, does not move, is named twice or has the name of a constraint; a type is
                unknown; keys do not fit it; or ``at`` is not a configuration.
            NotClosable: ``at`` is open, or no configuration was found that closes the loops with the contacts.
        """
        from eurdf.kinematics.contacts import with_contacts  # only now: it is above this module

        return with_contacts(self, contacts, at)

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled and copied: the model and its own geometry; what is derived from them is computed anew."""
        state = {each.name: getattr(self, each.name) for each in fields(self)}
        geometry = self.geometry and Geometry(*(each.copy() for each in self.geometry))
        models = self.__dict__.get("_constraint_models", ())
        gains = [(each.m_baumgarte_parameters.Kp, each.m_baumgarte_parameters.Kd) for each in models]
        own = {"gains": gains, "model": self.model.copy(), "geometry": geometry, "derived": {}}
        return state | own | {"diagnose": None, "diagnostics": self.diagnostics}

    def __setstate__(self, state: dict[str, Any]) -> None:
        gains = state.pop("gains")
        self.__dict__.update(state)
        if gains:  # the models of constraints were used, and gains can be set in them
            for each, (kp, kd) in zip(self.constraint_models, gains, strict=True):
                each.m_baumgarte_parameters.Kp, each.m_baumgarte_parameters.Kd = kp, kd

    def __iter__(self) -> Iterator[Any]:
        return iter((self.model, self.constraint_models, self.actuation, self.visual_model, self.collision_model))

    def __repr__(self) -> str:
        return (
            f"<Robot '{self.mechanism.name}': nq {self.model.nq}, nv {self.model.nv}, "
            f"{len(self.mechanism.closures)} closures, {len(self.actuation.joints)} actuators"
            + (f", {len(self.mechanism.contacts)} contacts>" if self.mechanism.contacts else ">")
        )


def build_robot(
    mechanism: Mechanism,
    *,
    geometry: bool,
    resolve: Resolve | None = None,
    meshes: Mapping[str, Mesh] | None = None,
    no_geometry: Callable[[], Exception] | None = None,
    diagnose: Callable[[Robot], tuple[Diagnostic, ...]] | None = None,
) -> Robot:
    """Build the robot of a mechanism.

    Args:
        mechanism: A valid mechanism.
        geometry: Whether to build the visual and collision geometry.
        resolve: Path of the file that a URI of the URDF means; needed for geometry with meshes.
        meshes: The meshes by path, where they were read already.
        no_geometry: See `Robot`.
        diagnose: See `Robot`.

    Raises:
        UnreadableMesh: A mesh file cannot be read as a mesh.
        FileNotFoundError: `resolve` does not find a mesh.
    """
    model = build_model(mechanism)
    shapes = build_geometry(mechanism, model, resolve or _nothing, meshes) if geometry else None
    return Robot(mechanism, model, shapes, no_geometry, diagnose)


def carried_over(before: Robot, after: Robot) -> Geometry | None:
    """The geometry of a robot, fixed to the joints of another one whose bodies are at the same places.

    Both have the same frames in the same order: `build_model` creates the same frames for a fixed and a moving joint,
    except for the first of two joints in series, and frames that were added by hand come after them. So the first frame
    of each joint gives the new pose of what is attached to the joint.
    """
    if before.geometry is None:
        return None
    frames: dict[int, int] = {}
    sites: dict[int, tuple[int, pin.SE3]] = {}
    for (index, old), (new_index, new) in zip(_frames(before), _frames(after), strict=False):
        frames[index] = new_index
        if old.parentJoint not in sites:
            stays = old.placement == new.placement
            jMj = pin.SE3.Identity() if stays else new.placement * old.placement.inverse()
            sites[old.parentJoint] = new.parentJoint, jMj
    carried = Geometry(*(each.copy() for each in before.geometry))
    for geometry in (found for each in carried for found in each.geometryObjects):
        geometry.parentJoint, jMj = sites[geometry.parentJoint]
        geometry.parentFrame = frames.get(geometry.parentFrame, geometry.parentFrame)
        geometry.placement = jMj * geometry.placement
    return carried


def _frames(robot: Robot) -> list[tuple[int, pin.Frame]]:
    """The frames with their indices, but those of the first of two joints in series."""
    return [each for each in enumerate(robot.model.frames) if each[1].parentJoint not in robot.tree.in_series]


def _nothing(uri: str) -> None:
    """Finds no file."""
