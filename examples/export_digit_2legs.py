"""Writes an MJCF of two legs of Digit, ready to train on: a floor, a start above it, position actuators, closed loops.

Run as ``python examples/export_digit_2legs.py [FOLDER]``; needs MuJoCo.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
from lxml import etree

import eurdf

DURATION = 1.0  # s


class Trainable(NamedTuple):
    """What was written, and how it does.

    Attributes:
        path: The file.
        actuators: Number of actuators.
        opening: How far loops come open while it falls onto the floor: the largest row of an equality, m or rad.
        height: Height of the root above the floor in the end, m.
    """

    path: Path
    actuators: int
    opening: float
    height: float


def main(folder: str | Path = ".") -> Trainable:
    """Export, add a floor, and drop the robot onto it, its actuators holding the start."""
    export = eurdf.export("digit_2legs", "mjcf", root="floating", actuators="position")
    root = etree.fromstring(export.main)
    world = root.find("worldbody")
    assert world is not None
    etree.SubElement(world, "geom", type="plane", size="0 0 0.05", rgba="0.8 0.8 0.8 1")
    etree.SubElement(world, "light", pos="0 0 4", directional="true")

    model = mujoco.MjModel.from_xml_string(etree.tostring(root).decode())
    data = mujoco.MjData(model)
    start = model.key("assembled").qpos
    data.qpos[:] = start
    mujoco.mj_forward(model, data)
    solid = [
        g for g in range(model.ngeom) if model.geom_contype[g] and model.geom_type[g] != mujoco.mjtGeom.mjGEOM_PLANE
    ]
    lowest = min(float(data.geom_xpos[g, 2] - model.geom_rbound[g]) for g in solid)
    raised = np.array(start)
    raised[2] -= lowest
    key = root.find("keyframe/key")
    assert key is not None
    key.set("qpos", " ".join(map(repr, raised.tolist())))
    path = Path(folder) / "digit_2legs.xml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8"))

    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[:] = [data.joint(model.actuator(a).trnid[0]).qpos[0] for a in range(model.nu)]
    opening = 0.0
    for _ in range(round(DURATION / model.opt.timestep)):  # the time is set back to 0 if it diverges
        mujoco.mj_step(model, data)
        opening = max(opening, float(np.abs(data.efc_pos[: data.efc_type.tolist().count(0)]).max()))
    return Trainable(path, model.nu, opening, float(data.qpos[2]))


if __name__ == "__main__":
    result = main(*sys.argv[1:])
    print(f"wrote            {result.path}, with {result.actuators} actuators")
    print(f"loops open by    {result.opening:.1e} m or rad at most, in {DURATION} s")
    print(f"root ends at     {result.height:.3f} m")
