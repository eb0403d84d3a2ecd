"""A USD stage as the library of USD reads it: bodies, joints and inertias, and no dynamics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from eurdf.array import Matrix, Vector
from eurdf.closures.hinge import HingeClosure
from eurdf.convert.verification.read_model import CannotRead, Exported, Range, ReadModel, opening_between
from eurdf.kinematics.dynamics import mass_matrix
from eurdf.kinematics.opening import Opening
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot


class Stage:
    """An exported robot on a stage.

    Args:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.stage = Usd.Stage.Open(str(path))
        self.robot = self.stage.GetDefaultPrim()
        self._poses = UsdGeom.XformCache()

    def prims(self, scope: str) -> dict[str, Any]:
        """The prims in a scope of the robot, by the name that they show."""
        found = self.stage.GetPrimAtPath(self.robot.GetPath().AppendChild(scope))
        return {prim.GetDisplayName() or prim.GetName(): prim for prim in found.GetChildren()} if found else {}

    def pose(self, prim: Any) -> Any:
        """Pose in the world, (4, 4)."""
        return np.array(self._poses.GetLocalToWorldTransform(prim)).T

    def frames(self, joint: Any) -> tuple[Any, Any]:
        """Poses (4, 4) in the world of the two frames of a joint."""
        joint = UsdPhysics.Joint(joint)
        found = []
        for end in "01":
            (target,) = getattr(joint, f"GetBody{end}Rel")().GetTargets()
            local = Gf.Matrix4d()
            local.SetRotate(Gf.Quatd(getattr(joint, f"GetLocalRot{end}Attr")().Get()))
            local.SetTranslateOnly(Gf.Vec3d(getattr(joint, f"GetLocalPos{end}Attr")().Get()))
            found.append(self.pose(self.stage.GetPrimAtPath(target)) @ np.array(local).T)
        return found[0], found[1]

    def inertia(self, body: Any) -> tuple[float, Any, Any]:
        """Mass, centre of mass (3,), and rotational inertia (3, 3) about it along the axes of the body."""
        mass = UsdPhysics.MassAPI(body)
        axes = np.array(Gf.Matrix3d(Gf.Quatd(mass.GetPrincipalAxesAttr().Get()))).T
        moments = axes @ np.diag(mass.GetDiagonalInertiaAttr().Get()) @ axes.T
        return mass.GetMassAttr().Get(), np.array(mass.GetCenterOfMassAttr().Get()), moments


class UsdModel(ReadModel):
    """See `ReadModel`. The mass matrix is that of the robot with the inertias of the stage."""

    reader = "usd-core {}".format(".".join(map(str, Usd.GetVersion()[1:])))
    unverified = (
        "the fall is not simulated, and axes and armature of joints are not compared: the library of USD has no "
        "dynamics; open the file in Newton or Isaac Sim",
    )
    # USD has inertias, and frames of joints, in single precision.
    tolerance = mass_tolerance = 1e-5

    def __init__(self, exported: Exported) -> None:
        self._exported = exported
        try:
            self.stage = Stage(exported.path)
        except Exception as error:  # of a class that USD keeps to itself
            raise CannotRead(self.reader, error) from None
        self._bodies = self.stage.prims("bodies")
        self._closures = self.stage.prims("closures")

    @property
    def mass(self) -> float:
        base = self._exported.robot.mechanism.bodies[0]
        # A base without mass that is fixed to the world has 1 kg there: it does not move.
        left_out = base.name if base.inertia is None or base.inertia.mass == 0.0 else ""
        prims = [body for name, body in self._bodies.items() if name != left_out]
        return float(sum(UsdPhysics.MassAPI(prim).GetMassAttr().Get() or 0.0 for prim in prims))

    def mass_matrix(self, q: Vector) -> Matrix:
        mechanism = self._exported.robot.mechanism
        bodies = tuple(replace(body, inertia=self._inertia(body.name)) for body in mechanism.bodies)
        return mass_matrix(build_robot(replace(mechanism, bodies=bodies), geometry=False), q)

    def openings(self, q: Vector) -> tuple[Opening, ...]:
        closures = {closure.name: closure for closure in self._exported.robot.mechanism.closures}
        found = []
        for name, prim in self._closures.items():
            closure = closures[name]
            if isinstance(closure, HingeClosure):  # those of a hinge are the x axes
                closure = replace(closure, axes=((1.0, 0.0, 0.0),) * 2)
            found.append(opening_between(closure, *self.stage.frames(prim)))
        return tuple(found)

    def ranges(self, q: Vector) -> tuple[Range, ...]:
        found = []
        for name, prim in self.stage.prims("joints").items():
            for kind, axis, unit in (
                (UsdPhysics.RevoluteJoint, "angular", np.pi / 180.0),
                (UsdPhysics.PrismaticJoint, "linear", 1.0),
            ):
                joint = kind(prim)
                state = prim.GetAttribute(f"state:{axis}:physics:position")
                if joint and state and joint.GetLowerLimitAttr().HasAuthoredValue():
                    values = (state.Get(), joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get())
                    found.append(Range(name, *(unit * value for value in values)))
        return tuple(found)

    def _inertia(self, body: str) -> Inertia | None:
        if body not in self._bodies or not UsdPhysics.MassAPI(self._bodies[body]).GetMassAttr().Get():
            return None
        mass, centre, A = self.stage.inertia(self._bodies[body])
        x, y, z = map(float, centre)
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = A.tolist()
        return Inertia(float(mass), Pose((x, y, z)), (xx, xy, xz, yy, yz, zz))
