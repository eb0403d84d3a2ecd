"""The README and the pages: done as they show, their commands and code give what they show."""

from __future__ import annotations

import importlib.util
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eurdf.commands.main import main
from eurdf.writing.naming_conventions import conventions
from eurdf_conformance.corpus import lint, show
from eurdf_conformance.corpus.read import CASES, all_cases
from eurdf_conformance.judging.known_failures import read_known_failures
from eurdf_conformance.strict_yaml import load_strictly
from eurdf_conformance.suite.item import planned_items
from spec.figures import draw
from support.page_reader import PageReader
from support.places import ROOT
from support.warm import run_module

README = (ROOT / "README.md").read_text(encoding="utf-8")


def _block(language: str) -> str:
    found = re.search(rf"^```{language}\n(.*?)^```", README, re.M | re.S)
    assert found
    return found[1]


def _joint(name: str, parent: str, child: str) -> str:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    return (
        f'<link name="{child}">{inertial}</link><joint name="{name}" type="continuous">'
        f'<parent link="{parent}"/><child link="{child}"/></joint>'
    )


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A robot for the description that the README shows."""
    tree = "".join(
        _joint(*names)
        for names in (("motor_hip", "base", "leg"), ("motor_knee", "leg", "foot"), ("rod_ball", "leg", "rod_tip"))
    )
    (tmp_path / "my_robot").mkdir()
    (tmp_path / "my_robot" / "robot.urdf").write_text(f'<robot name="r"><link name="base"/>{tree}</robot>')
    monkeypatch.chdir(tmp_path)
    return tmp_path / "my_robot" / "robot.yaml"


def test_shown_description_is_valid_apart_from_names(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot.write_text(_block("yaml"), encoding="utf-8")
    main(["check", "my_robot"])
    assert set(re.findall(r"\[([a-z-]+) EU", capsys.readouterr().out)) <= {"assembled-open"}


def test_shown_message_is_current(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot.write_text(_block("yaml").replace("[rod_tip", "[rod_tpi"), encoding="utf-8")
    assert main(["check", "my_robot"]) == 1
    _, shown = _block("console").split("\n", 1)
    assert capsys.readouterr().out.strip() == shown.strip()


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_shown_python_runs(page: str) -> None:
    names: dict[str, object] = {}
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
    assert blocks
    for block in blocks:
        exec(block, names)


def test_first_command_runs_main_job(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    _, *commands = _block("sh").strip().split(" && ")
    for command in commands:
        assert main(command.split()[1:]) == 0
    assert ": valid" in capsys.readouterr().out


SPEC = ROOT / "spec"
PAGES = ("solidworks", "onshape")
#: Pages whose commands and code are run, as a reader of the page would.
FOLLOWED = [
    *(f"docs/{name}" for name in ("from_mjcf", "from_sdf", "from_toolbox", "from_urdf_plus")),
    *(pytest.param(f"docs/{name}", marks=pytest.mark.slow) for name in ("humanoids", "training")),
    *(f"spec/{name}" for name in (*PAGES, "tutorial")),
]


@pytest.mark.parametrize("page", FOLLOWED)
def test_commands_code_and_files_give_what_the_page_shows(page: str, tmp_path: Path) -> None:
    if "mjcf" in page and importlib.util.find_spec("mujoco") is None:
        pytest.skip("mujoco is not installed: pip install -e '.[mujoco]'")
    reader = PageReader(ROOT / f"{page}.md", tmp_path)
    reader.follow()
    assert len(reader.told) >= 2
    for line, shown, given in reader.told:
        assert given == shown, f"{page}.md:{line}"
    example = SPEC / "examples" / Path(page).name
    for file in ("robot.urdf", "robot.yaml") if example.is_dir() else ():
        assert (tmp_path / file).read_text(encoding="utf-8") == (example / file).read_text(encoding="utf-8"), file


@pytest.mark.parametrize("name", PAGES)
def test_options_on_page_exist(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["generate", "--help"])
    options = capsys.readouterr().out
    named = set(re.findall(r"`(--[a-z-]+)`", (SPEC / f"{name}.md").read_text(encoding="utf-8")))
    assert "--type" in named
    assert [option for option in sorted(named) if option not in options] == []


def test_proposed_names_are_recognised() -> None:
    text = (SPEC / "solidworks.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^ +\| ([^|]+?) \| ([^|]+?) \|", text, re.M))
    proposed = {what: re.findall(r"`([^`]+)`", names) for what, names in rows.items()}
    known = conventions()
    for what, patterns in (
        ("the two links at a cut", known.closures),
        ("the same, with the type", known.closures),
        ("actuated joints", known.motors),
        ("ball joints", known.sphericals),
    ):
        assert proposed[what]
        for name in proposed[what]:
            assert any(pattern.search(name) for pattern in patterns), name


# -- Figures of the specification


@pytest.mark.parametrize("name", sorted(draw.FIGURE))
def test_figures_are_current(name: str) -> None:
    assert (SPEC / "figures" / f"{name}.svg").read_text(encoding="utf-8") == draw.FIGURE[name]().text()


def test_figures_are_readable_on_any_background() -> None:
    for path in sorted((SPEC / "figures").glob("*.svg")):
        for colour in set(re.findall(r'(?:fill|stroke)="([^"]+)"', path.read_text(encoding="utf-8"))):
            if colour not in ("none", draw.INK):
                assert _contrast(colour, 1.0) >= 3.0, f"{path.name}: {colour} on white"
                assert _contrast(colour, 0.0) >= 3.0, f"{path.name}: {colour} on black"


def _contrast(colour: str, ground: float) -> float:
    """Contrast ratio of a colour with a ground of a relative luminance, as WCAG 2 defines it."""
    parts = [int(colour[start : start + 2], 16) / 255 for start in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    luminance = sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))
    brighter, darker = max(luminance, ground), min(luminance, ground)
    return (brighter + 0.05) / (darker + 0.05)


# -- The case that CONTRIBUTING adds from beginning to end


SECTION = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").partition("\n## A case for the suite\n")[2]
SECTION = SECTION.partition("\n## ")[0]
NAME = "urdf/damping-fortran-exponent"


def blocks(language: str, text: str = SECTION) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def command(program: str) -> tuple[list[str], str]:
    """The arguments of a shown command, and its output."""
    (found,) = [block for block in blocks("console") if block.startswith(f"$ {program}")]
    line, _, output = found.partition("\n")
    return shlex.split(line.removeprefix(f"$ {program}")), output


def same(shown: str, given: str) -> bool:
    """Whether an output is as shown, where … is any text."""
    return re.fullmatch(".*?".join(map(re.escape, shown.split("…"))), given, re.DOTALL) is not None


def test_lint_reports_what_the_shown_case_lacks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (text,) = blocks("yaml")
    assert f"cases/{NAME}.yaml`" in SECTION
    (tmp_path / "urdf").mkdir()
    for path in (CASES / "urdf").glob("every-element*"):  # the twin, and its base
        shutil.copyfile(path, tmp_path / "urdf" / path.name)
    path = tmp_path / f"{NAME}.yaml"
    path.write_text(text, encoding="utf-8")
    assert lint.main([str(tmp_path)]) == 1
    # Most clauses have no case among these.
    given = re.sub(r"missing: .*\n", "", capsys.readouterr().out)
    shown = command("python -m eurdf_conformance.corpus.lint")[1]
    assert same(shown.replace("0 clauses", "… clauses"), given), given
    added = text.replace("clauses: [", "clauses: [EU-URD-007, ")
    path.write_text(added, encoding="utf-8")
    assert lint.main([str(tmp_path)]) == 0
    assert load_strictly(added) == load_strictly((CASES / f"{NAME}.yaml").read_text(encoding="utf-8"))


def test_show_prints_the_shown_case(capsys: pytest.CaptureFixture[str]) -> None:
    arguments, shown = command("python -m eurdf_conformance.corpus.show")
    assert show.main(arguments) == 0
    assert capsys.readouterr().out == shown


@pytest.mark.slow
def test_run_of_the_shown_case_passes() -> None:
    arguments, shown = command("pytest")
    argv = [sys.executable, "-m", "pytest", *arguments, "-p", "no:cacheprovider"]
    done = subprocess.run(argv, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    assert same(shown.rstrip("\n"), done.stdout.rstrip("\n")), done.stdout
    assert done.returncode == 0


# -- What the page for those who write an adapter shows is what happens


PAGE = ROOT / "docs" / "write_an_adapter.md"
TEXT = PAGE.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "shown",
    [
        pytest.param(blocks("console", TEXT)[0], id="smoke"),
        pytest.param(blocks("console", TEXT)[1], id="whole", marks=pytest.mark.slow),
    ],
)
def test_first_runs_give_shown_results(shown: str) -> None:
    command, *lines = shown.splitlines()
    program, *arguments = shlex.split(command.removeprefix("$ "))
    assert program == "pytest"
    # The shown lines are of version 1, the only one that the parser claims.
    less = ["--seed=0", "--format-version=1"]
    done = run_module(program, [*arguments, *less, "-n0", "-p", "no:cacheprovider", "--tb=no", "-q"], cwd=ROOT)
    assert lines
    for line in lines:
        # Each case that is added changes the numbers, but not what they show.
        pattern = re.sub(r"\d+(?=\\ (?:of|excused))|(?<=of\\ )\d+", r"\\d+", ".*".join(map(re.escape, line.split("…"))))
        assert re.search(f"^{pattern}$", done.stdout, re.MULTILINE), f"{line}\n{done.stdout}"
    assert done.returncode == int("--smoke" not in arguments)


def test_shown_known_failures_are_usable(tmp_path: Path) -> None:
    (shown,) = blocks("yaml", TEXT)
    (tmp_path / "known.yaml").write_text(shown, encoding="utf-8")
    known = read_known_failures(tmp_path / "known.yaml")
    assert known.failures
    assert known.unexpected([], planned_items(all_cases())) == []


def test_options_for_adapters_exist(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["certify", "--help"])
    options = capsys.readouterr().out
    named = set(
        re.findall(r"`?(--[a-z]+(?:-[a-z]+)*)", "".join(blocks("sh", TEXT)) + " ".join(re.findall("`--[^`]+`", TEXT)))
    )
    assert {"--verify", "--compare", "--certificate", "--explore", "--known-failures", "--smoke"} <= named
    assert [option for option in sorted(named) if option not in options] == []
