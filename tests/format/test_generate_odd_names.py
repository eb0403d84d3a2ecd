"""Generated files of URDFs whose names, line ends or encodings are unusual: written, read back, checked."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import pytest
import yaml

from eurdf import check
from eurdf.commands.main import main
from eurdf.linking.robot_files import read_robot

#: Names that YAML would read as something else, or that need quotes, in other scripts, or on two lines.
NAMES = [
    "no", "on", "null", "~", "1e3", "012", "0x1F", "1_000", "12:30", "2001-12-14", ".inf", "true", "-", "a: b", "a #b",
    "[x]", "{x}", "&x", "*x", "!x", "%x", "@x", "`x", "'x'", '"x"', "x\\n", "a, b", " x ", "x\ty", "x\ny", "café",
    "膝", "колено", "مفصل", "🦿", "e\u0301", "\ufeffx", "\u2028", "x\u00a0y", "<<", "=", "y", "🦵🏽_ß",
]  # fmt: skip


def urdf_text(name: str) -> str:
    """A four-bar in which every name has another in it."""

    def attribute(text: str) -> str:
        return quoteattr(text, {"\n": "&#10;", "\t": "&#9;"})

    links = {word: attribute(f"{name}{word}") for word in ("ground", "crank", "coupler", "rocker")}
    frames = [attribute(f"{name}closedloop{name}_{side}") for side in "AB"]
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    joints = [
        (attribute(f"motor_{name}"), "continuous", "0 0 0", links["ground"], links["crank"]),
        (attribute(name), "continuous", "1 0 0", links["crank"], links["coupler"]),
        (attribute(f"{name}rocker"), "continuous", "0 2 0", links["ground"], links["rocker"]),
        (attribute(f"{name}fix1"), "fixed", "0 2 0", links["coupler"], frames[0]),
        (attribute(f"{name}fix2"), "fixed", "1 0 0", links["rocker"], frames[1]),
    ]
    lines = ['<?xml version="1.0"?>', "<robot name='r'>"]
    lines += [f"<link name={link}>{inertial}</link>" for link in links.values()]
    lines += [f"<link name={frame}/>" for frame in frames]
    for joint, kind, xyz, parent, child in joints:
        lines += [f"<joint name={joint} type='{kind}'>", f"<origin xyz='{xyz}'/>", f"<parent link={parent}/>"]
        lines += [f"<child link={child}/>", "<axis xyz='0 0 1'/>", "</joint>"]
    return "\n".join([*lines, "</robot>", ""])


def generated(folder: Path, data: bytes, urdf: str = "robot.urdf", *options: str) -> Any:
    """What is written for a URDF, once the check finds nothing wrong with it."""
    (folder / urdf).write_bytes(data)
    out = folder / "out.yaml"
    assert main(["generate", str(folder / urdf), "-o", str(out), *options]) == 0
    assert [str(found) for found in check(out).diagnostics if found.severity == "error"] == []
    return yaml.safe_load(out.read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_any_name_survives_round_trip(tmp_path: Path, name: str) -> None:
    written = generated(tmp_path, urdf_text(name).encode(), "robot.urdf", "--schema", "robot")
    assert written["actuators"] == [f"motor_{name}"]
    (closure,) = written["closures"]
    assert closure["frames"] == [f"{name}closedloop{name}_A", f"{name}closedloop{name}_B"]
    schema = json.loads((tmp_path / "out.schema.json").read_text(encoding="utf-8"))
    assert f"motor_{name}" in schema["$defs"]["UrdfJointName"]["enum"]
    mechanism = read_robot(tmp_path / "out.yaml").mechanism
    assert mechanism is not None
    assert mechanism.actuators == (f"motor_{name}",)


@pytest.mark.parametrize("name", ["no", "膝", "a: b", "x\ny"], ids=ascii)
def test_version_1_survives_round_trip(tmp_path: Path, name: str) -> None:
    written = generated(tmp_path, urdf_text(name).encode(), "robot.urdf", "--version", "1")
    assert written["name_mot"] == [f"motor_{name}"]


@pytest.mark.parametrize(
    "data",
    [
        urdf_text("é").replace("\n", "\r\n").encode(),
        urdf_text("é").replace("\n", "\r").encode(),
        b"\xef\xbb\xbf" + urdf_text("é").encode(),
    ],
    ids=["CRLF", "CR", "byte order mark"],
)
def test_urdf_line_ends_do_not_matter(tmp_path: Path, data: bytes) -> None:
    assert generated(tmp_path, data)["actuators"] == ["motor_é"]
    text = (tmp_path / "out.yaml").read_bytes()
    assert b"\r" not in text
    assert b"motor_\xc3\xa9" in text


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16"])
def test_other_encoding_is_refused_without_writing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], encoding: str
) -> None:
    (tmp_path / "robot.urdf").write_bytes(urdf_text("é").encode(encoding))
    assert main(["generate", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "out.yaml")]) == 1
    assert "file-not-utf8" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["robot.urdf"]


@pytest.mark.parametrize(
    "urdf", ["no.urdf", "a: b.urdf", "my robot #1.urdf", "膝.urdf", "'x'.urdf", "1e3.urdf", "-x.urdf", "[a].urdf"]
)
def test_urdf_of_any_file_name_is_named(tmp_path: Path, urdf: str) -> None:
    assert generated(tmp_path, urdf_text("x").encode(), urdf)["urdf"] == urdf
