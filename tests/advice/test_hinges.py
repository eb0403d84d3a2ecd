"""What `check` suggests for loops that were cut at a pin and closed by 3d or 6d: a Sarrus linkage."""

from __future__ import annotations

from pathlib import Path

import eurdf
from eurdf.diagnostics import Diagnostic
from support.described import body
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf


def pin(name: str, parent: str, child: str, axis: str, at: str) -> str:
    return joint_element(
        name, "continuous", parent, child, f'<axis xyz="{axis}"/>', f'<origin xyz="{at}" rpy="0 0 0"/>'
    )


# Leg A folds about y and carries the plate, leg B folds about x; its last pin, to the plate, is cut.
SARRUS = urdf(
    *(body(name) for name in ("base", "lower_a", "upper_a", "plate", "lower_b", "upper_b")),
    pin("foot_a", "base", "lower_a", "0 1 0", "-0.1 0 0"),
    pin("knee_a", "lower_a", "upper_a", "0 1 0", "-0.06 0 0.08"),
    pin("top_a", "upper_a", "plate", "0 1 0", "0.06 0 0.08"),
    pin("foot_b", "base", "lower_b", "1 0 0", "0 -0.1 0"),
    pin("knee_b", "lower_b", "upper_b", "1 0 0", "0 -0.06 0.08"),
)

HINGE = "is closure 'top_b' a pin, of type hinge with axis: [1, 0, 0] (version 2.1), which"


def advice(folder: Path, closure: str, frame_b: str = "{link: plate, xyz: [0.1, -0.1, 0]}") -> Diagnostic:
    (folder / "robot.urdf").write_text(SARRUS, encoding="utf-8")
    frames = f"[{{link: upper_b, xyz: [0, 0.06, 0.08]}}, {frame_b}]"
    text = (
        f'extended_urdf: "2.1"\nclosures:\n  - {{name: top_b, {closure}, frames: {frames}}}\n'
        "actuators: [foot_a]\nconfigurations: {assembled: {}}\n"
    )
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    (found,) = eurdf.check(folder).diagnostics
    return found


def test_3d_that_leaves_a_freedom_is_suggested_as_a_hinge(tmp_path: Path) -> None:
    found = advice(tmp_path, "type: 3d")
    assert found.code == "x-uncontrolled-motion"
    assert found.hint is not None
    assert f"{HINGE} leaves fewer motions?" in found.hint


def test_6d_that_locks_the_loop_is_suggested_as_a_hinge(tmp_path: Path) -> None:
    found = advice(tmp_path, "type: 6d")
    assert (found.code, found.line) == ("x-dependent-actuators", 3)
    assert found.hint == f"{HINGE} frees the actuators?"


def test_suggested_axes_are_those_of_turned_frames(tmp_path: Path) -> None:
    found = advice(tmp_path, "type: 3d", "{link: plate, xyz: [0.1, -0.1, 0], rpy: [0, 0, 1.5707963267948966]}")
    assert found.hint is not None
    assert "type hinge with axes: [[1, 0, 0], [0, -1, 0]] (version 2.1)" in found.hint


def test_suggested_hinge_leaves_nothing_to_report(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_text(SARRUS, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(
        'extended_urdf: "2.1"\nclosures:\n  - {name: top_b, type: hinge, axis: [1, 0, 0], frames: '
        "[{link: upper_b, xyz: [0, 0.06, 0.08]}, {link: plate, xyz: [0.1, -0.1, 0]}]}\nactuators: [foot_a]\n",
        encoding="utf-8",
    )
    assert eurdf.check(tmp_path).diagnostics == ()
