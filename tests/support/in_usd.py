"""An exported robot as the library of USD reads it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf

pytest.importorskip("pxr", reason="usd-core is not installed: pip install -e '.[usd]'", exc_type=ImportError)

from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdValidation

#: Rotations and translations of the axes of a joint with several.
D6_AXES = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")


class InUsd:
    """An exported robot on a stage.

    Args:
        export: The robot in USD.
        folder: Where to write it.
    """

    def __init__(self, export: eurdf.Export, folder: Path) -> None:
        self.path = export.write(folder)[0]
        self.stage = Usd.Stage.Open(str(self.path))
        self.robot = self.stage.GetDefaultPrim()
        self._poses = UsdGeom.XformCache()

    def prims(self, scope: str) -> dict[str, Any]:
        """The prims in a scope of the robot, by the name that they show."""
        found = self.stage.GetPrimAtPath(self.robot.GetPath().AppendChild(scope))
        return {prim.GetDisplayName() or prim.GetName(): prim for prim in found.GetChildren()} if found else {}

    def named(self, name: str) -> Any:
        """The prim of a link or a frame."""
        for prim in self.stage.Traverse():
            if (
                prim.GetTypeName() == "Xform"
                and prim != self.robot
                and (prim.GetDisplayName() or prim.GetName()) == name
            ):
                return prim
        raise KeyError(name)

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

    def between(self, joint: Any) -> Any:
        """Pose (4, 4) of the second frame of a joint in the first."""
        a, b = self.frames(joint)
        return np.linalg.inv(a) @ b

    def errors(self) -> list[str]:
        """What the validators of USD report, all of them."""
        registry = UsdValidation.ValidationRegistry()
        context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
        return [f"{error.GetName()}: {error.GetMessage()}" for error in context.Validate(self.stage)]

    def principal_moments(self, body: Any) -> list[float]:
        return list(UsdPhysics.MassAPI(body).GetDiagonalInertiaAttr().Get())

    def inertia(self, body: Any) -> tuple[float, Any, Any]:
        """Mass, centre of mass (3,), and rotational inertia (3, 3) about it along the axes of the body."""
        mass = UsdPhysics.MassAPI(body)
        axes = np.array(Gf.Matrix3d(Gf.Quatd(mass.GetPrincipalAxesAttr().Get()))).T
        moments = axes @ np.diag(mass.GetDiagonalInertiaAttr().Get()) @ axes.T
        return mass.GetMassAttr().Get(), np.array(mass.GetCenterOfMassAttr().Get()), moments
