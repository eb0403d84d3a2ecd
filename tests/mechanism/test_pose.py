"""Poses: rotations that take x to an axis."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from eurdf.mechanism.pose import Pose, turn_from_x


@pytest.mark.parametrize("axis", [(1, 0, 0), (-1, 0, 0), (0, 2, 0), (-1, 1e-9, 1e-12), (-0.3, 0.4, -5.0)])
def test_rotation_from_x_takes_x_to_the_axis(axis: Any) -> None:
    found = Pose(quaternion=turn_from_x(axis)).rotate((1.0, 0.0, 0.0))
    assert found == pytest.approx(np.divide(axis, np.linalg.norm(axis)), abs=1e-15)
