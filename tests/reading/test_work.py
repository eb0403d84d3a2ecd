"""The work and the memory that a file takes are bounded, however it is made."""

from __future__ import annotations

import os
from collections.abc import KeysView
from pathlib import Path

import pytest

import eurdf
from eurdf.diagnostics import Diagnostics
from eurdf.diagnostics.diagnostic import LISTED
from eurdf.format.urdf import read
from eurdf.format.urdf.data import UrdfJoint
from eurdf.format.urdf.elements import UrdfReader
from eurdf.format.urdf.mimics import check_mimics
from eurdf.reading.reporter import XmlReporter
from eurdf.reading.source import read_source
from eurdf.reading.xml_reader import read_xml
from support.hostile import chain, joint, numbered, robot, star


class Counted(dict[str, UrdfJoint]):
    """Joints by name, which counts how often all names are listed."""

    listed = 0

    def keys(self) -> KeysView[str]:  # type: ignore[override]
        self.listed += 1
        return dict(self).keys()


def test_names_are_listed_for_listed_errors_only(tmp_path: Path) -> None:
    mimics = [joint(f"j{i}", "l0", f"l{i + 1}", content=f'<mimic joint="x{i}"/>') for i in range(500)]
    path = tmp_path / "robot.urdf"
    path.write_text(robot(numbered(501), mimics), encoding="utf-8")
    document = read_xml(read_source(path))
    ignored = Diagnostics()
    reader = UrdfReader(XmlReporter(document, ignored), XmlReporter(document, ignored))
    urdf = read.read_urdf(document, ignored, mimic_diagnostics=Diagnostics())
    assert urdf is not None
    joints = Counted(urdf.joints)
    check_mimics(reader, joints)
    assert len(ignored) == 500
    assert 0 < joints.listed <= LISTED


def test_joints_of_too_large_robot_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(read, "JOINT_LIMIT", 5)
    path = tmp_path / "robot.urdf"
    path.write_text(star(5), encoding="utf-8")
    assert {found.code for found in eurdf.check(path).errors} == {"leaf-without-inertia"}
    path.write_text(chain(6), encoding="utf-8")
    monkeypatch.setattr(read, "read_link", None)
    (found,) = eurdf.check(path).diagnostics
    assert (found.code, found.line, found.column, found.pointer) == ("file-too-large", 1, 1, "/robot")
    assert found.message == "the robot has 6 joints; the maximum is 5"


def test_merging_leaves_number_of_joints(tmp_path: Path) -> None:
    axes = ("1 0 0", "0 1 0", "0 0 1")
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}", content=f'<axis xyz="{axis}"/>') for i, axis in enumerate(axes)]
    (tmp_path / "robot.urdf").write_text(robot(numbered(4), joints), encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(
        'extended_urdf: "2.0"\njoints: {ball: {type: spherical, merges: [j0, j1, j2]}}\n', encoding="utf-8"
    )
    mechanism = eurdf.load(tmp_path, geometry=False).mechanism
    assert [(joint.name, joint.type) for joint in mechanism.joints] == [
        ("ball", "spherical"),
        ("j0", "fixed"),
        ("j1", "fixed"),
    ]


def test_file_is_opened_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "robot.urdf").write_text(star(1), encoding="utf-8")
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nclosurs: []\n', encoding="utf-8")
    opened: list[str] = []
    original = os.open

    def counted(path: str, *rest: int) -> int:
        opened.append(Path(path).name)
        return original(path, *rest)

    monkeypatch.setattr(os, "open", counted)
    report = eurdf.check(tmp_path)
    assert "closurs" in str(report.diagnostics[0])
    assert sorted(opened) == ["robot.urdf", "robot.yaml"]
