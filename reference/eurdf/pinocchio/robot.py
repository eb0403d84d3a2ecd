"""A robot ready for Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pinocchio as pin

from eurdf.diagnostics import Diagnostic
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.actuation import Actuation, build_actuation
from eurdf.pinocchio.configuration import Vector, configuration_vector, own_coordinates
from eurdf.pinocchio.constraint import build_constraint_models
from eurdf.pinocchio.coordinates import slots
from eurdf.pinocchio.geometry import Meshes, Resolve, build_geometry
from eurdf.pinocchio.model import build_model


class Robot:
    """A robot with closed kinematic chains, in Pinocchio's terms.

    It unpacks as ``model, constraint_models, actuation, visual_model, collision_model = robot``.

    Take the mass matrix from `eurdf.mass_matrix`: up to Pinocchio 4.1, that of `pin.crba` has wrong entries where a
    mimic joint carries several branches.

    Attributes:
        mechanism: What it was built from, as plain data.
        model: The spanning tree.
        constraint_models: The closures, in file order.
        actuation: The actuated joints, in file order.
        configurations: For each named configuration its q.
        no_geometry: What makes the error that `visual_model` and `collision_model` raise, where the geometry was asked
            for and cannot be built; else None.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        model: pin.Model,
        constraint_models: list[pin.RigidConstraintModel],
        actuation: Actuation,
        visual_model: pin.GeometryModel | None,
        collision_model: pin.GeometryModel | None,
        configurations: dict[str, Vector],
        diagnostics: tuple[Diagnostic, ...] = (),
    ) -> None:
        self.mechanism = mechanism
        self.model = model
        self.constraint_models = constraint_models
        self.actuation = actuation
        self._visual_model = visual_model
        self._collision_model = collision_model
        self.no_geometry: Callable[[], Exception] | None = None
        self.configurations = configurations
        self._diagnostics: tuple[Diagnostic, ...] | Callable[[], tuple[Diagnostic, ...]] = diagnostics
        self._data: pin.Data | None = None

    @property
    def data(self) -> pin.Data:
        """Pinocchio's working memory for the model, made when first asked for.

        It takes some 64 nv³ bytes, 64 MB for 100 velocities. What needs none: `load`, `check`, `assemble`, `analyze`.
        """
        if self._data is None:
            self._data = self.model.createData()
        return self._data

    @property
    def visual_model(self) -> pin.GeometryModel | None:
        """What is seen; None without geometry.

        Raises:
            InvalidRobot: A mesh is missing.
        """
        self._require_geometry()
        return self._visual_model

    @visual_model.setter
    def visual_model(self, geometry_model: pin.GeometryModel | None) -> None:
        self._visual_model = geometry_model

    @property
    def collision_model(self) -> pin.GeometryModel | None:
        """What collides; None without geometry.

        Raises:
            InvalidRobot: A mesh is missing.
        """
        self._require_geometry()
        return self._collision_model

    @collision_model.setter
    def collision_model(self, geometry_model: pin.GeometryModel | None) -> None:
        self._collision_model = geometry_model

    def _require_geometry(self) -> None:
        if self.no_geometry is not None:
            raise self.no_geometry()

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """What was found wrong with the robot, but did not keep it from being built."""
        if callable(self._diagnostics):
            self._diagnostics = self._diagnostics()
        return self._diagnostics

    @diagnostics.setter
    def diagnostics(self, found: tuple[Diagnostic, ...]) -> None:
        self._diagnostics = found

    def defer_diagnostics(self, find: Callable[[], tuple[Diagnostic, ...]]) -> None:
        """Let the diagnostics be found when first asked for."""
        self._diagnostics = find

    def coordinates(self, q: Vector) -> dict[str, tuple[float, ...]]:
        """The coordinates of a configuration as a file states them: the inverse of what makes `configurations`.

        Args:
            q: Configuration, of shape (nq,).

        Returns:
            For each joint that has coordinates of its own, by name: an angle (rad) or a length (m); of a universal
            joint two angles, of a cylindrical one length and angle, of a planar one x, y and angle; of a spherical one
            a quaternion x, y, z, w, of a floating one x, y, z and a quaternion. The joint of a floating root is
            ``root_joint``. Fixed joints and those that mimic another have none. The angle of a joint
            without limits that Pinocchio has as (cos, sin) is from -pi to pi.

        Raises:
            ValueError: q does not have the shape (nq,).
        """
        return own_coordinates(self.mechanism, self.model, q)

    def __iter__(self) -> Iterator[Any]:
        return iter((self.model, self.constraint_models, self.actuation, self.visual_model, self.collision_model))

    def __repr__(self) -> str:
        return (
            f"<Robot '{self.mechanism.name}': nq {self.model.nq}, nv {self.model.nv}, "
            f"{len(self.constraint_models)} closures, {len(self.actuation.joints)} actuators>"
        )


def build_robot(
    mechanism: Mechanism,
    *,
    geometry: bool,
    resolve: Resolve | None = None,
    diagnostics: tuple[Diagnostic, ...] = (),
) -> Robot:
    """Build the robot of a mechanism.

    Args:
        mechanism: A sound mechanism.
        geometry: Whether to build the visual and collision geometry.
        resolve: Path of the file that a URI of the URDF means; needed for geometry with meshes.
        diagnostics: What was found wrong with it so far.

    Raises:
        UnreadableMesh: A mesh file is no mesh.
        FileNotFoundError: `resolve` does not find a mesh.
    """
    model = build_model(mechanism)
    visual_model = collision_model = None
    if geometry:
        find = _nothing if resolve is None else resolve
        meshes: Meshes = {}
        visual_model = build_geometry(mechanism, model, pin.GeometryType.VISUAL, find, meshes)
        collision_model = build_geometry(mechanism, model, pin.GeometryType.COLLISION, find, meshes)
    at = slots(mechanism, model)
    return Robot(
        mechanism,
        model,
        build_constraint_models(mechanism, model),
        build_actuation(mechanism, model, at),
        visual_model,
        collision_model,
        {
            name: configuration_vector(mechanism, model, coordinates, at)
            for name, coordinates in mechanism.configurations.items()
        },
        diagnostics,
    )


def _nothing(uri: str) -> None:
    """Finds no file."""
