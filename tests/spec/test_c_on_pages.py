"""The C and C++ on the pages: it compiles without a warning, runs, and gives what Python gives."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from spec.site.blocks import Code, read_blocks
from support.places import ROOT

FOLDERS = ("docs", "spec", "examples", "robots", "conformance", "ros")
STRICT = ("-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror")


class Shown(NamedTuple):
    """A program on a page, and the command there that generates the C which it calls."""

    page: str
    command: list[str]
    program: str


def shown() -> Iterator[Shown]:
    for page in [*ROOT.glob("*.md"), *(page for folder in FOLDERS for page in (ROOT / folder).rglob("*.md"))]:
        text = page.read_text(encoding="utf-8") if "node_modules" not in page.parts else ""
        if re.search(r"^ *[`~]{3,} *c\b", text, re.MULTILINE):
            (command,) = re.findall(r"^(?:\$ )?eurdf (transmission .* --c \w+)$", text, re.MULTILINE)
            blocks = [block for block in read_blocks(text) if isinstance(block, Code) and block.language == "c"]
            assert blocks, f"{page}: blocks of C are not found"
            for block in blocks:
                yield Shown(page.name, command.split(), block.text + "\n")


def output(language: str, each: Shown, folder: Path) -> str:
    """What a program writes, compiled as C or C++ and linked with the C that its page generates."""
    c, compiler = shutil.which("cc"), shutil.which("cc" if language == "c99" else "c++")
    if c is None or compiler is None:
        pytest.skip(f"no compiler of {language}: install `cc` and `c++`")
    assert main([*each.command, "--force"]) == 0
    (generated,) = (folder / each.command[-1]).glob("*.c")
    program = folder / ("program.c" if language == "c99" else "program.cpp")
    program.write_text(each.program, encoding="utf-8")
    made, objects = folder / "program", folder / "generated.o"
    subprocess.run([c, "-std=c99", *STRICT, "-c", generated, "-o", objects], check=True)
    arguments = [f"-std={language}", *STRICT, f"-I{generated.parent}", program, objects, "-lm", "-o", made]
    subprocess.run([compiler, *arguments], check=True)
    return subprocess.run([made], check=True, capture_output=True, text=True).stdout


@pytest.mark.parametrize("language", ["c99", "c++17"])
def test_programs_reach_what_python_reaches(language: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    programs = list(shown())
    assert [each.page for each in programs] == ["humanoids.md"]
    (ankle,) = programs
    robot, joints = eurdf.load("unitree_g1_ankle", geometry=False), ["free_pitch", "free_roll"]
    encoders = [0.2, -0.5]
    lines = output(language, ankle, tmp_path).splitlines()
    assert lines
    for line in lines:
        pitch, roll, *motors = map(float, re.findall(r"-?\d+\.\d+", line))
        seen = eurdf.transmissions.joint_values(robot, dict(zip(("motor_a", "motor_b"), encoders, strict=True))).values
        assert (pitch, roll) == pytest.approx([seen[name] for name in joints], abs=1e-4)
        asked = eurdf.transmissions.actuator_values(robot, {"free_pitch": -0.3, "free_roll": 0.05}).values
        assert motors == pytest.approx(list(asked.values()), abs=1e-4)
        encoders = motors


def test_component_of_ros2_control_reaches_what_python_reaches(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "humanoids.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"^eurdf (transmission .*) --ros2 ankle$", page, re.MULTILINE)
    ((program, shown),) = re.findall(r"^```cpp\n(.*?)^```\n\n```text\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    if shutil.which("cc") is None or shutil.which("c++") is None:
        pytest.skip("no compiler: install `cc` and `c++`")
    assert main([*command.split(), "--ros2", str(tmp_path)]) == 0
    (generated,), (folder,) = tmp_path.glob("src/*.c"), tmp_path.glob("include/*")
    made, objects, source = tmp_path / "program", tmp_path / "generated.o", tmp_path / "program.cpp"
    source.write_text(program, encoding="utf-8")
    subprocess.run(["cc", "-std=c99", *STRICT, f"-I{folder}", "-c", generated, "-o", objects], check=True)
    include = f"-I{folder.parent}", f"-I{ROOT / 'tests' / 'support' / 'ros2_control' / 'include'}"
    subprocess.run(["c++", "-std=c++17", *STRICT, *include, source, objects, "-lm", "-o", made], check=True)
    given = subprocess.run([made], check=True, capture_output=True, text=True).stdout
    numbers = [np.array(re.findall(r"-?\d+\.\d+", text), float).reshape(2, 3) for text in (shown, given)]
    assert numbers[0] == pytest.approx(numbers[1], abs=2e-4)
    robot, joints = eurdf.load("unitree_g1_ankle", geometry=False), ["free_pitch", "free_roll"]
    q = eurdf.forward_kinematics(robot, {"motor_a": 0.2, "motor_b": -0.5})
    at, positions = eurdf.transmission(robot, joints, q), robot.joint_positions(q)
    effort, velocity = at.G.T @ [10.0, 5.0], np.linalg.solve(at.G, [1.0, 2.0])
    for joint, row, *others in zip(joints, numbers[1], velocity, effort, strict=True):
        assert row == pytest.approx([*positions[joint], *others], abs=2e-4)
