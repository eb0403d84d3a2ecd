"""Version 2.1: what it adds to version 2.0, and what a file of version 2.0 is told that uses it."""

from __future__ import annotations

import pytest

from eurdf.diagnostics import Diagnostic, Diagnostics
from eurdf.format.extension import Extension
from eurdf.format.read_extension import read_extension, version_of
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml

HINGE = """\
extended_urdf: "2.1"
closures:
  - name: pin
    type: hinge
    frames: [a, b]
"""


DISTANCE = HINGE.replace("hinge", "distance") + "    length: 0.155\n"


def read(text: str) -> tuple[Extension | None, list[Diagnostic]]:
    diagnostics = Diagnostics()
    document = read_yaml(Source("robot.yaml", text, text.encode()))
    return read_extension(document, diagnostics), list(diagnostics)


@pytest.mark.parametrize(
    ("more", "axes"),
    [
        ("", ((0, 0, 1), (0, 0, 1))),
        ("    axis: [0, 2, 0]\n", ((0, 2, 0), (0, 2, 0))),
        ("    axes: [[0, 2, 0], [1, 0, 1.5]]\n", ((0, 2, 0), (1, 0, 1.5))),
    ],
)
def test_hinge_has_its_axes_or_z(more: str, axes: tuple[tuple[float, ...], ...]) -> None:
    extension, diagnostics = read(HINGE + more)
    assert extension is not None
    assert not diagnostics
    assert extension.version == "2.1"
    (closure,) = extension.closures
    assert (closure.name, closure.type, closure.axes) == ("pin", "hinge", axes)


def test_distance_has_its_length() -> None:
    extension, diagnostics = read(DISTANCE)
    assert extension is not None
    assert not diagnostics
    (closure,) = extension.closures
    assert (closure.type, closure.length) == ("distance", 0.155)


def test_other_closures_have_neither_axes_nor_length() -> None:
    extension, _ = read(HINGE.replace("hinge", "6d"))
    assert extension is not None
    assert (extension.closures[0].axes, extension.closures[0].length) == (None, None)


def test_version_2_0_is_read_alike_with_the_later_version() -> None:
    text = HINGE.replace("hinge", "3d")
    earlier, later = read(text.replace("2.1", "2.0"))[0], read(text)[0]
    assert earlier is not None
    assert later is not None
    assert (earlier.version, later.version) == ("2.0", "2.1")
    assert earlier.closures == later.closures


@pytest.mark.parametrize("version", ["2.0", "2.1"])
def test_version_of_a_file_is_what_it_states(version: str) -> None:
    text = HINGE.replace("2.1", version)
    assert version_of(read_yaml(Source("robot.yaml", text, text.encode()))) == version


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        (HINGE, "wrong-value", 4),
        (HINGE + "    axis: [0, 0, 1]\n", "wrong-value", 4),
        (HINGE + "    axes: [[0, 0, 1]]\n", "wrong-value", 4),
        (HINGE.replace("hinge", "3d") + "    axis: [0, 0, 1]\n", "unknown-key", 6),
        (DISTANCE, "wrong-value", 4),
        (DISTANCE.replace("distance", "3d"), "unknown-key", 6),
    ],
)
def test_closure_in_version_2_0_names_the_line_to_change(text: str, code: str, line: int) -> None:
    extension, diagnostics = read("# a robot\n" + text.replace("2.1", "2.0"))
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == (code, line + 1)
    assert found.hint is not None
    assert 'write extended_urdf: "2.1" on line 2' in found.hint


@pytest.mark.parametrize(
    ("text", "code", "line", "said"),
    [
        (HINGE + "    axis: [0, 0, 1]\n    axes: [[0, 0, 1], [0, 0, 1]]\n", "conflicting-keys", 6, "exclude"),
        (HINGE.replace("hinge", "3d") + "    axes: [[0, 0, 1], [0, 0, 1]]\n", "conflicting-keys", 6, "type 'hinge'"),
        (
            HINGE.replace("hinge", "hing") + "    axis: [0, 0, 1]\n",
            "wrong-value",
            4,
            "'3d', '6d', 'hinge' or 'distance'",
        ),
        (HINGE.replace("    type: hinge\n", "    axis: [0, 0, 1]\n"), "missing-key", 3, "lacks 'type'"),
        (HINGE + "    axis: z\n", "wrong-type", 6, "must be a list"),
        (HINGE + "    axis: [0, 1]\n", "wrong-length", 6, "must have 3 items"),
        (HINGE + "    axes: [[0, 0, 1]]\n", "wrong-length", 6, "must have 2 items"),
        (HINGE + "    length: 0.1\n", "conflicting-keys", 6, "'length' goes with type 'distance'"),
        (HINGE + "    radius: 0.1\n", "unknown-key", 6, "'radius'"),
        (DISTANCE.replace("0.155", "0.00009"), "out-of-range", 6, "'length' must be at least 0.0001, not 9e-05"),
        (DISTANCE.replace("0.155", "[0.155]"), "wrong-type", 6, "'length' must be a number"),
        (DISTANCE.replace("length: 0.155", "lenght: 0.155"), "unknown-key", 6, "'lenght'"),
        (DISTANCE.replace("    length: 0.155\n", ""), "missing-key", 3, "lacks 'length'"),
        (DISTANCE.replace("    type: distance\n", ""), "missing-key", 3, "lacks 'type'"),
        (DISTANCE.replace("distance", "3d"), "conflicting-keys", 6, "'length' goes with type 'distance'"),
        (DISTANCE + "    axis: [0, 0, 1]\n", "conflicting-keys", 7, "'axis' goes with type 'hinge'"),
    ],
)
def test_error_of_a_closure_is_reported_once(text: str, code: str, line: int, said: str) -> None:
    extension, diagnostics = read(text)
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == (code, line)
    assert said in found.message
