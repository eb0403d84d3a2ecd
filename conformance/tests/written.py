"""Robots for the oracle, written element by element."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from eurdf_conformance.oracle import OracleRobot, read

UNIT = '<limit lower="-9" upper="9" velocity="1" effort="1"/>'


def words(values: Sequence[float]) -> str:
    return " ".join(map(repr, map(float, values)))


def link(
    name: str, mass: float = 0.0, center: Sequence[float] = (0, 0, 0), moments: Sequence[float] = (0, 0, 0)
) -> str:
    """A link with three moments about its centre of mass, along its own axes."""
    if not mass and not any(moments):
        return f'<link name="{name}"/>'
    xx, yy, zz = moments
    return (
        f'<link name="{name}"><inertial><origin xyz="{words(center)}"/><mass value="{mass!r}"/>'
        f'<inertia ixx="{xx!r}" ixy="0" ixz="0" iyy="{yy!r}" iyz="0" izz="{zz!r}"/></inertial></link>'
    )


def joint(
    name: str,
    kind: str,
    parent: str,
    child: str,
    axis: Sequence[float] = (0, 0, 1),
    xyz: Sequence[float] = (0, 0, 0),
    rpy: Sequence[float] = (0, 0, 0),
    more: str = UNIT,
) -> str:
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{words(xyz)}" rpy="{words(rpy)}"/><parent link="{parent}"/>'
        f'<child link="{child}"/><axis xyz="{words(axis)}"/>{more}</joint>'
    )


def chain(*joints: str) -> list[str]:
    """Elements of joints, after the links that they name, which weigh nothing."""
    names = {part.split('"')[0]: None for text in joints for part in text.split(' link="')[1:]}
    return [*map(link, names), *joints]


def robot(elements: Sequence[str], yaml: str = 'extended_urdf: "2.0"', **options: Any) -> OracleRobot:
    """What the oracle reads."""
    with tempfile.TemporaryDirectory() as folder:
        urdf, description = Path(folder, "robot.urdf"), Path(folder, "robot.yaml")
        urdf.write_text(f'<robot name="written">{"".join(elements)}</robot>', encoding="utf-8")
        description.write_text(yaml, encoding="utf-8")
        return read(description, urdf, **options)


def two(yaml: str) -> str:
    """A description of version 2."""
    return f'extended_urdf: "2.0"\n{yaml}'
