"""To add a joint type, write its row, and what files state of it: all that moves, reads, writes and exports follows.

Its clauses go into `spec/joints.md`, its transform into the oracle and the JavaScript, and cases into the suite. A
format to export to that has such a joint names it in its ``facts.py``; others get it as slides and turns in series.
"""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml

import eurdf
from eurdf.commands.output import output_schemas, to_json
from eurdf.commands.robot_info import robot_info
from eurdf.convert.formats import EXPORTS
from eurdf.format.schema import json_schema
from eurdf.kinematics.residual import acceleration_drift
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.same_model import differences
from eurdf.writing.description import describe_mechanism
from support.changed_package import run_with

TYPE = (
    (
        "mechanism/joint_types.py",
        "    HELICAL = _Row(",
        '    TABLE = _Row("table", ("x", "y"), (Step("slide", X), Step("slide", Y)), replaces=SLIDING)\n',
    ),
    (
        "format/joint_model.py",
        "class _JointRecord(Record):",
        '''\
@entry
class Table(JointEntry):
    """A table that slides in a plane."""

    title = "Table"
    since = VERSION2_1
    type: str = required(Choice("table"), "Type", "Slides along x and y of the joint's frame.", "table")


''',
    ),
)

URDF = """<robot name="press">
  <link name="base"/>
  <link name="plate"><inertial><mass value="3"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="table" type="prismatic"><origin rpy="0.1 0.2 0.3"/><parent link="base"/><child link="plate"/>
    <limit lower="-2" upper="2" effort="5" velocity="6"/></joint>
  <joint name="pin" type="continuous"><parent link="plate"/><child link="arm"/><axis xyz="0 0 1"/></joint>
</robot>"""
YAML = """extended_urdf: "2.1"
joints: {table: {type: table, limits: {lower: [-1, -1.5], upper: 1, effort: 7}, damping: [0.1, 0.2]}}
actuators: [table]
closures:
  - {name: rod, type: distance, frames: [{link: arm, xyz: [1, 0, 0]}, {link: base, xyz: [1.1, 0.2, 0]}], length: 0.3}
"""


def test_row_and_form_are_all_that_a_type_needs(tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    (folder / "robot.yaml").write_text(YAML, encoding="utf-8")
    program = "import sys, test_add_a_joint_type as recipe; from pathlib import Path; recipe.show(Path(sys.argv[1]))"
    found = json.loads(run_with(tmp_path, TYPE, "-c", program, folder))
    assert found == {name: [["export-joint-kind", "table"]] for name in found}
    assert {*EXPORTS} - {"usd"} <= found.keys()


def show(folder: Path) -> None:
    """What a parser that has the type does with a robot that has such a joint; prints the losses of exports."""
    assert eurdf.check(folder).ok
    robot = eurdf.load(folder)
    mechanism, kind = robot.mechanism, JointType("table")
    assert (kind.nv, mechanism.joints[0].type, mechanism.joints[0].properties.effort) == (2, kind, (7.0, 7.0))
    assert mechanism.joints[0].properties.lower == (-1.0, -1.5)

    tree, v = robot.tree, np.array([0.3, -0.4, 0.5])
    q = eurdf.assemble(robot).q
    h = 1e-4
    behind, here, ahead = (eurdf.residual(robot, tree.integrate(q, t * v)) for t in (-h, 0.0, h))
    r, K = eurdf.residual_and_jacobian(robot, q)
    np.testing.assert_allclose(K @ v, (ahead - behind) / (2.0 * h), atol=1e-7)
    np.testing.assert_allclose(acceleration_drift(robot, q, v), (ahead - 2.0 * here + behind) / h**2, atol=1e-6)
    for one, many in zip((r, K), eurdf.batch.residual_and_jacobian(robot, np.tile(q, (3, 1))), strict=True):
        np.testing.assert_allclose(many, np.tile(one, (3, *(1,) * np.ndim(one))), atol=1e-12)
    M = eurdf.mass_matrix(robot, q)
    np.testing.assert_allclose(M[:2, :2], 5.0 * np.eye(2), atol=1e-12)
    there = eurdf.forward_kinematics(robot, {"table": np.array(robot.joint_positions(q)["table"]) + 0.01}, q)
    np.testing.assert_allclose(eurdf.residual(robot, there), 0.0, atol=1e-9)
    assert eurdf.simulate(robot, q, np.zeros(3), duration=0.01).q.shape[1] == robot.model.nq

    files = describe_mechanism(mechanism)
    jsonschema.validate(yaml.safe_load(files.yaml), json_schema("2.1"))
    (folder / "robot.urdf").write_bytes(files.urdf)
    (folder / "robot.yaml").write_text(files.yaml, encoding="utf-8")
    assert differences(mechanism, eurdf.load(folder).mechanism) == []
    info = to_json(robot_info(robot, eurdf.analyze(robot)))
    assert info["joint_list"][0]["type"] == "table"
    jsonschema.validate(info, output_schemas()["info.schema.json"])
    losses = {}
    for name in EXPORTS:
        if name != "usd" or pytest.importorskip("pxr"):
            found = eurdf.export(robot, name, actuators="none").losses
            losses[name] = [(each.code, each.name) for each in found if each.concept == "joint"]
    print(json.dumps(losses))  # noqa: T201 - to the test
