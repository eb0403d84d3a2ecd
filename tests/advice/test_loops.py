"""What `check` reports of loops that move to first order only."""

from __future__ import annotations

from pathlib import Path

import eurdf
from support.described import body
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf


def two_bars(folder: Path, span: float) -> tuple[str, ...]:
    """Codes reported of two bars of 0.5 m in a row between two points at a distance, m."""
    axis = '<axis xyz="0 0 1"/>'
    joints = [
        joint_element("first", "continuous", "base", "left", axis),
        joint_element("second", "continuous", "left", "right", axis, '<origin xyz="0.5 0 0" rpy="0 0 0"/>'),
    ]
    (folder / "robot.urdf").write_text(urdf(body("base"), body("left"), body("right"), *joints), encoding="utf-8")
    frames = f"[{{link: right, xyz: [0.5, 0, 0]}}, {{link: base, xyz: [{span}, 0, 0]}}]"
    text = f'extended_urdf: "2.0"\nclosures:\n  - {{name: end, type: 3d, frames: {frames}}}\nactuators: [first]\n'
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return tuple(found.code for found in eurdf.check(folder).diagnostics)


def test_stretched_bars_are_reported_as_shaky(tmp_path: Path) -> None:
    assert two_bars(tmp_path, 1.0) == ("x-shaky-loops",)


def test_bent_bars_are_rigid_and_not_shaky(tmp_path: Path) -> None:
    assert two_bars(tmp_path, 0.8) == ("x-dependent-actuators",)
