"""Files of other formats: every command says what they are, and what to do with them."""

import io
import zipfile
from pathlib import Path

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.convert.import_format import import_format
from eurdf.convert.xml_elements import recognized
from eurdf.reading.other_formats import IMPORTED

LINKS = (
    '<link name="a"/><link name="b"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
)
JOINT = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'


def robot(content: str) -> bytes:
    return f'<robot name="r" xmlns:drake="http://drake.mit.edu">{LINKS}{content}</robot>'.encode()


def archive(name: str) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as file:
        file.writestr(name, b"PXR-USDC\x00\xff")
    return stream.getvalue()


#: By file name: the content, and the format that `eurdf import` reads it as, or words of what to do instead.
FILES = {
    "robot.usda": (
        b'#usda 1.0\n(\n    upAxis = "Z"\n)\ndef Xform "r"\n{\n}\n',
        "cannot read USD; import the MJCF",
    ),
    "robot.usd": (b"PXR-USDC\x00\x08\xff\xbe", "cannot read USD; import the MJCF"),
    "robot.usdz": (archive("robot.usdc"), "cannot read USD; import the MJCF"),
    "robot.xml": (b'<mujoco model="r"><worldbody/></mujoco>', "mjcf"),
    "robot.sdf": (b'<?xml version="1.0"?>\n<!-- r -->\n<sdf version="1.11"><model name="r"/></sdf>', "sdf"),
    "isaac.urdf": (robot(JOINT + '<loop_joint name="l"/>'), "loop-joint"),
    "drake.urdf": (robot(JOINT + '<drake:ball_constraint name="l"/>'), "drake"),
    "other_namespace.urdf": (
        robot(JOINT + '<drake:ball_constraint name="l"/>').replace(b"http://drake.mit.edu", b"urn:drake"),
        "drake",
    ),
    "joint.urdf": (robot('<drake:joint name="j" type="ball"/>'), "drake"),
    "plus.urdf": (robot(JOINT + '<coupling name="l"/>'), "urdf-plus"),
    "proposal.urdf": (robot(JOINT + '<constraint name="l"/>'), "cannot read the <constraint> proposed for URDF; write"),
    "both.urdf": (robot(JOINT + '<constraint name="l"/><loop_joint name="k"/>'), "loop-joint"),
    "loop_closures.yaml": (
        b"closures:\n- {link_a: a, link_b: b, point: [0, 0, 0], axis: [0, 0, 1]}\ndependent: [j]\n",
        "scikit-robot; write each loop under 'closures'",
    ),
    "pins.yaml": (b"pin_loops:\n- {name: l, parent: a, child: b}\n", "robonex; write each loop under 'closures'"),
}


@pytest.mark.parametrize("name", FILES)
def test_every_command_says_what_to_do_with_other_formats(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    content, what = FILES[name]
    Path(name).write_bytes(content)
    Path("robot.urdf").write_bytes(robot(JOINT))
    words = IMPORTED[what].hint if what in IMPORTED else what
    hints = [str(found.hint) for found in eurdf.check(name).diagnostics]
    assert any(words in hint for hint in hints), hints
    assert not any("extended_urdf" in hint for hint in hints)
    if eurdf.check(name).errors:
        with pytest.raises(eurdf.InvalidRobot) as refused:
            eurdf.load(name)
        assert words in str(refused.value)
    main(["generate", name])
    assert words in " ".join(capsys.readouterr().err.split()) or name.endswith(".yaml")
    if what in IMPORTED:
        assert recognized(Path(name)) == what
    else:
        assert main(["import", name, "-o", "out"]) == 1
        assert words in " ".join(capsys.readouterr().err.split())


def test_folder_names_the_file_of_another_format(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text("<package/>")
    (tmp_path / "robot.usda").write_text("#usda 1.0\n")
    with pytest.raises(eurdf.errors.RobotNotFound, match=r"no URDF, but 'robot\.usda'; name the file"):
        eurdf.check(tmp_path)


def test_import_refuses_what_needs_no_import(tmp_path: Path) -> None:
    for name, content, words in (
        ("robot.yaml", b'extended_urdf: "2.0"\n', "it is a description; use it as it is"),
        ("robot.urdf", robot(JOINT), "URDF without loops of another dialect; use it as it is"),
    ):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(eurdf.errors.CannotImport, match=words):
            eurdf.import_robot(tmp_path / name)


def test_urdf_with_the_name_of_a_description_is_recognized(tmp_path: Path) -> None:
    (tmp_path / "robot.txt").write_bytes(robot(JOINT))
    (found,) = eurdf.check(tmp_path / "robot.txt").diagnostics
    assert (found.message, found.hint) == ("the file is URDF", "give its file a name that ends with .urdf")


def test_long_preamble_takes_no_time(tmp_path: Path) -> None:
    (tmp_path / "robot.sdf").write_text("<!-- -->" * 100_000 + "<!--")
    assert not eurdf.check(tmp_path / "robot.sdf").ok


def test_every_format_of_the_table_is_imported() -> None:
    assert all(import_format(name).losses for name in IMPORTED)
