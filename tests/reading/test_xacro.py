"""Robots that are given as xacro files."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics.text import report_lines
from eurdf.linking.robot_files import read_robot
from eurdf.reading import xacro
from eurdf.viewing.files import RobotOnDisk
from support.described import ARM_DESCRIPTION as DESCRIPTION

pytest.importorskip("xacro", reason='xacro is not installed: pip install -e ".[xacro]"')

ARM = """\
<?xml version="1.0"?>
<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="mass" default="2"/>
  <xacro:property name="length" value="0.5"/>
  <xacro:macro name="body" params="name">
    <link name="${name}">
      <inertial><mass value="$(arg mass)"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    </link>
  </xacro:macro>
  <link name="base"/>
  <xacro:body name="upper"/>
  <joint name="shoulder" type="continuous">
    <origin xyz="0 0 ${2*length}"/>
    <parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  </joint>
</robot>
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "arm.urdf.xacro").write_text(ARM, encoding="utf-8")
    return tmp_path


def robot_with(content: str) -> str:
    return f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{content}</robot>'


def test_xacro_is_expanded_with_arguments() -> None:
    robot = eurdf.load("arm.urdf.xacro")
    assert robot.model.names[1] == "shoulder"
    assert robot.model.jointPlacements[1].translation[2] == 1
    assert robot.model.inertias[1].mass == 2
    assert eurdf.load("arm.urdf.xacro", xacro_args={"mass": "5"}).model.inertias[1].mass == 5
    assert eurdf.check("arm.urdf.xacro", xacro_args={"mass": "5"}).ok


def describe_arm(folder: Path, content: str = ARM) -> None:
    (folder / "arm.urdf.xacro").write_text(content, encoding="utf-8")
    (folder / "arm.yaml").write_text(DESCRIPTION + "urdf: arm.urdf.xacro\n", encoding="utf-8")


def test_every_command_expands_the_xacro_that_a_description_names(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    describe_arm(folder)
    for arguments, masses in (((), "2"), (("--xacro-arg", "mass:=5"), "5")):
        assert main(["check", "arm.yaml", *arguments]) == 0
        assert main(["info", "arm.yaml", *arguments]) == 0
        assert f"{masses} kg" in capsys.readouterr().out
        assert main(["export", "arm.yaml", *arguments, "--to", "urdf", "-o", "out", "--force"]) == 0
        assert f'mass value="{masses}' in (folder / "out" / "robot.urdf").read_text(encoding="utf-8")
        assert main(["migrate", "arm.yaml", *arguments]) == 0
        assert eurdf.load("arm.yaml", xacro_args=dict.fromkeys(["mass"], masses)).actuation.joints == ("shoulder",)
    with pytest.raises(eurdf.errors.CannotExpand, match=r"no argument 'mas'.*did you mean 'mass'"):
        eurdf.check("arm.yaml", xacro_args={"mas": "5"})
    with pytest.raises(SystemExit):
        main(["check", "arm.urdf.xacro", "--xacro-arg", "mass=3"])
    assert "NAME:=VALUE" in capsys.readouterr().err


def test_error_in_a_named_xacro_is_at_its_name(folder: Path) -> None:
    describe_arm(folder, robot_with('<link name="${lenght}"/>'))
    (found,) = eurdf.check("arm.yaml").diagnostics
    assert (found.code, found.file, found.line, found.column) == ("file-unreadable", "arm.yaml", 3, 7)
    assert "lenght" in found.message
    describe_arm(folder, ARM.replace('"1"/></inertial>', '"one"/></inertial>'))
    assert {found.file for found in eurdf.check("arm.yaml").errors} == {"arm.urdf.xacro (expanded)"}


def test_named_xacro_is_a_regular_file(folder: Path) -> None:
    describe_arm(folder)
    (folder / "arm.urdf.xacro").unlink()
    os.mkfifo(folder / "arm.urdf.xacro")
    (found,) = eurdf.check("arm.yaml").diagnostics
    assert found.message == "'arm.urdf.xacro' is a pipe or a device, not a file"


#: Through the frames of Python: the globals of the module xacro.
GLOBALS = "(lambda l: [l.append((x.gi_frame.f_back.f_back.f_back.f_globals for x in l)), *l[0]])([])[1]"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('<link name="$(env SECRET)"/>', "it reads the environment variable 'SECRET'"),
        ('<link name="$(optenv SECRET no)"/>', "it reads the environment variable 'SECRET'"),
        ("<link name=\"${xacro.load_yaml('../secret.yaml')}\"/>", "secret.yaml', which is outside"),
        ('<xacro:include filename="../secret.xacro"/>', "secret.xacro', which is outside"),
        ('<xacro:include filename="../secret.xacro" optional="true"/><link name="a"/>', "secret.xacro', which is"),
        ('<xacro:include filename="link.xacro"/>', "link.xacro', which is outside"),
        (f"<link name=\"${{{GLOBALS}['os'].system('touch pwned')}}\"/>", "it uses '"),
    ],
)
def test_named_xacro_does_nothing_but_read_files_of_the_robot(
    folder: Path, content: str, message: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SECRET", "swordfish")
    (folder / "secret.yaml").write_text("swordfish\n")
    (folder / "secret.xacro").write_text(robot_with('<link name="swordfish"/>'))
    home = folder / "home"
    home.mkdir()
    monkeypatch.chdir(home)
    (home / "link.xacro").symlink_to(folder / "secret.xacro")
    describe_arm(home, robot_with(content))
    (found,) = eurdf.check("arm.yaml").diagnostics
    assert message in found.message
    assert "--urdf" in found.message
    assert "swordfish" not in str(found)
    assert not (home / "pwned").exists()
    if "os" not in content:  # the caller vouches for it
        assert "file-unreadable" not in {each.code for each in eurdf.check("arm.yaml", "arm.urdf.xacro").diagnostics}
    if "filename" in content or "load_yaml" in content:
        assert "file-unreadable" not in {each.code for each in eurdf.check("arm.yaml", allow_outside=True).diagnostics}
    (found,) = eurdf.check("arm.yaml", confined=True).diagnostics
    assert "a xacro, which is a program" in found.message


@pytest.mark.parametrize("where", ["environ", "environb", "sys.modules[posix].environ"])
def test_named_xacro_does_not_see_the_environment(folder: Path, where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SECRET", "swordfish")
    path = f"'\\x7b0._' + '_globals_' + '_[os].{where}\\x7d'"
    content = f"<link name=\"seen ${{({path}).format(xacro.load_yaml).count('swordfish')}} times\"/>"
    describe_arm(folder, robot_with(content))
    (folder / "arm.yaml").write_text('extended_urdf: "2.0"\nurdf: arm.urdf.xacro\n', encoding="utf-8")
    assert [body.name for body in read_robot("arm.yaml").mechanism.bodies] == ["seen 0 times"]
    assert [body.name for body in read_robot("arm.urdf.xacro").mechanism.bodies] == ["seen 1 times"]


def test_links_of_an_installer_are_followed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    describe_arm(folder, ARM.replace("<link", '<xacro:include filename="part.xacro"/>\n<link', 1))
    (folder / "part.xacro").write_text(robot_with(""), encoding="utf-8")
    share = folder / "install" / "share"
    share.mkdir(parents=True)
    for name in ("arm.yaml", "arm.urdf.xacro", "part.xacro"):
        (share / name).symlink_to(folder / name)
    assert [str(found) for found in eurdf.check(share / "arm.yaml").diagnostics] == []


def test_files_of_a_xacro_are_watched(folder: Path) -> None:
    part = robot_with('<xacro:property name="mass" value="2"/>')
    (folder / "part.xacro").write_text(part, encoding="utf-8")
    describe_arm(folder, ARM.replace("<link", '<xacro:include filename="part.xacro"/>\n<link', 1))
    for path in ("arm.yaml", "arm.urdf.xacro"):
        files = RobotOnDisk(path, {})
        files.load()
        assert not files.has_changed
        (folder / "part.xacro").write_text(part + "\n" * len(path), encoding="utf-8")
        assert files.has_changed


def test_places_are_in_expanded_text(folder: Path) -> None:
    (folder / "arm.urdf.xacro").write_text(ARM.replace('"1"/></inertial>', '"one"/></inertial>'), encoding="utf-8")
    report = eurdf.check("arm.urdf.xacro")
    (found,) = report.diagnostics
    assert found.file == "arm.urdf.xacro (expanded)"
    lines = ["".join(piece for piece, _ in line) for line in report_lines(report)]
    assert f"{found.line:>5} | " + " " * 6 + '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="one"/>' in lines


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("<link", "not well-formed"),
        ('<link name="${lenght}"/>', "lenght"),
        ('<link name="$(arg side)"/>', "side"),
        ('<xacro:include filename="legs.xacro"/>', "legs.xacro"),
        ('<xacro:macro name="leg" params="a"><link name="${a + b}"/></xacro:macro><xacro:leg a="1"/>', "macro 'leg'"),
        ('<xacro:macro name="leg"><xacro:leg/></xacro:macro><xacro:leg/>', "contain themselves"),
        ('<link name="$(find no_such_package)"/>', "--package-dir"),
        ("${__import__('os')}", "__import__"),
    ],
)
def test_xacro_error_is_refused_in_one_line(
    folder: Path, content: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "wrong.xacro").write_text(robot_with(content), encoding="utf-8")
    for function in (eurdf.load, eurdf.check):
        with pytest.raises(eurdf.errors.CannotExpand, match=r"'wrong\.xacro'") as caught:
            function("wrong.xacro")
        assert said in str(caught.value)
    assert main(["check", "wrong.xacro"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("eurdf: xacro cannot expand 'wrong.xacro': ")
    assert captured.err.count("\n") == 1


def test_arguments_without_xacro_are_refused(folder: Path) -> None:
    (folder / "robot.urdf").write_text('<robot name="r"><link name="base"/></robot>', encoding="utf-8")
    (folder / "robot.yaml").write_text('extended_urdf: "2.0"\n', encoding="utf-8")
    for path in ("robot.urdf", "robot.yaml", '<robot name="r"><link name="base"/></robot>'):
        with pytest.raises(eurdf.errors.CannotExpand, match=r"only a \.xacro file accepts arguments"):
            eurdf.check(path, xacro_args={"mass": "1"})


def test_package_files_are_found_like_meshes(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package = folder / "install" / "share" / "legs"
    package.mkdir(parents=True)
    (package / "leg.xacro").write_text(robot_with('<link name="foot"/>'), encoding="utf-8")
    including = robot_with('<xacro:include filename="$(find legs)/leg.xacro"/>')
    (folder / "home").mkdir()
    monkeypatch.chdir(folder / "home")
    Path("robot.xacro").write_text(including, encoding="utf-8")
    Path("robot.yaml").write_text('extended_urdf: "2.0"\nurdf: robot.xacro\n', encoding="utf-8")
    for path in ("robot.xacro", "robot.yaml"):
        for dirs in ([package.parent], [package], str(package.parent)):
            found = read_robot(path, package_dirs=dirs)
            assert [body.name for body in found.mechanism.bodies] == ["foot"], list(found.diagnostics)
    assert "--package-dir" in eurdf.check("robot.yaml").errors[0].message
    monkeypatch.setenv("AMENT_PREFIX_PATH", os.fspath(folder / "install"))
    assert eurdf.check("robot.xacro").ok
    assert eurdf.check("robot.yaml").ok


def test_xacro_warning_is_a_warning(folder: Path) -> None:
    (folder / "robot.xacro").write_text(robot_with("<link name=\"${xacro.warning('old')}base\"/>"), encoding="utf-8")
    (found,) = eurdf.check("robot.xacro").diagnostics
    assert (found.code, found.file, found.line) == ("x-xacro-warning", "robot.xacro", None)
    assert "old" in found.message


def test_missing_extra_shows_install_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(xacro, "find_spec", lambda name: None)
    with pytest.raises(eurdf.errors.MissingExtra) as caught:
        eurdf.load("arm.urdf.xacro")
    assert caught.value.extra == "xacro"
    assert main(["check", "arm.urdf.xacro"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("eurdf: 'arm.urdf.xacro' is a xacro file")
    assert said.endswith('pip install "eurdf[xacro]"\n')


def test_module_beside_robot_is_not_run(folder: Path) -> None:
    (folder / "xacro.py").write_text("raise RuntimeError('not mine')\n", encoding="utf-8")
    assert eurdf.check("arm.urdf.xacro").ok


@pytest.mark.parametrize(
    ("program", "reason"),
    [
        ("import no_such_module", "exit code 1: ModuleNotFoundError: No module named 'no_such_module'"),
        ("import os; os.abort()", "exit code -6: it printed no reason"),
    ],
)
def test_failed_process_gives_its_reason(
    folder: Path, monkeypatch: pytest.MonkeyPatch, program: str, reason: str
) -> None:
    (folder / "program.py").write_text(program, encoding="utf-8")
    monkeypatch.setattr(xacro, "_PROGRAM", folder / "program.py")
    with pytest.raises(eurdf.errors.CannotExpand, match=f"{reason}$"):
        eurdf.check("arm.urdf.xacro")


def test_expansion_is_bounded_in_time_and_size(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    doubled = "".join(f'<xacro:macro name="m{i + 1}"><xacro:m{i}/><xacro:m{i}/></xacro:macro>' for i in range(40))
    text = robot_with(f'<xacro:macro name="m0"><link name="l"/></xacro:macro>{doubled}<xacro:m40/>')
    (folder / "bomb.xacro").write_text(text, encoding="utf-8")
    monkeypatch.setattr(xacro, "TIME_LIMIT", 1.0)
    with pytest.raises(eurdf.errors.CannotExpand, match="longer than 1 s"):
        eurdf.check("bomb.xacro")
    monkeypatch.undo()
    monkeypatch.setattr(xacro, "FILE_LIMIT", 100)
    monkeypatch.chdir(folder)
    assert [found.code for found in eurdf.check("arm.urdf.xacro").diagnostics] == ["file-too-large"]


def test_generated_description_names_the_xacro(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--motor", "shoulder", "--xacro-arg", "mass:=3", "-o", "arm.yaml")
    assert main(["generate", "arm.urdf.xacro", *options]) == 0
    assert "use --xacro-arg each time" in capsys.readouterr().err
    assert eurdf.load("arm.yaml").actuation.joints == ("shoulder",)
    assert main(["generate", "arm.urdf.xacro", "--version", "1"]) == 0
    assert "write it to 'robot.urdf'" in capsys.readouterr().err
    assert main(["schema", "--for", "arm.urdf.xacro"]) == 0
    assert '"shoulder"' in capsys.readouterr().out
    assert main(["schema", "--xacro-arg", "mass:=3"]) == 2


def test_file_with_error_is_named(folder: Path) -> None:
    (folder / "legs.xacro").write_text(robot_with('<link name="${lenght}"/>'), encoding="utf-8")
    (folder / "robot.xacro").write_text(robot_with('<xacro:include filename="legs.xacro"/>'), encoding="utf-8")
    with pytest.raises(eurdf.errors.CannotExpand, match=r"lenght.*in 'legs\.xacro'"):
        eurdf.check("robot.xacro")
