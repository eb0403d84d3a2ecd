"""An exported robot as the library of USD reads it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf

pytest.importorskip("pxr", reason="usd-core is not installed: pip install -e '.[usd]'", exc_type=ImportError)

from pxr import UsdPhysics, UsdValidation

from eurdf.convert.verification.usd_model import Stage

#: Rotations and translations of the axes of a joint with several.
D6_AXES = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")


class InUsd(Stage):
    """An exported robot on a stage.

    Args:
        export: The robot in USD.
        folder: Where to write it.
    """

    def __init__(self, export: eurdf.convert.Export, folder: Path) -> None:
        self.path = export.write(folder)[0]
        super().__init__(self.path)

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
        """Of a body, kg·m²."""
        return list(UsdPhysics.MassAPI(body).GetDiagonalInertiaAttr().Get())
