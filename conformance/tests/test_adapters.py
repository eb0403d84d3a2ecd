"""The reference and the examples behind the protocol: what they say of robots, in the terms of the specification."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from eurdf_conformance.adapters import example
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.certificate.certificate import read_certificate
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.level import Level
from eurdf_conformance.oracle import read
from eurdf_conformance.protocol.message import (
    REQUEST,
    Accepted,
    AnyAnswer,
    CanonicalRobot,
    Errored,
    Evaluated,
    Rejected,
    Unsupported,
)
from eurdf_conformance.runner.answer import read_answer
from eurdf_conformance.runner.outcome import Answered, Malformed, Misplaced, Outcome
from eurdf_conformance.runner.session import Session
from support.every_joint import CONFIGURATION, write_every_joint
from support.processes import JAVASCRIPT as PACKAGE
from support.processes import MODULES, why_not_installed
from support.session import SharedRun

ROOT = Path(__file__).parents[2]
ROBOTS = ROOT / "robots"
REFERENCE = "eurdf_conformance.adapters.reference:PARSER"
EXAMPLE = "eurdf_conformance.adapters.example:Example"
JAVASCRIPT = Path(example.__file__).with_name("example.mjs")
NO_JAVASCRIPT = why_not_installed("yaml", "@xmldom/xmldom")


def answer_of(outcome: Outcome) -> AnyAnswer:
    assert isinstance(outcome, Answered), str(outcome)
    return outcome.answer


def canonical(answer: Any) -> CanonicalRobot:
    assert isinstance(answer, Accepted), answer
    assert answer.robot is not None
    return answer.robot


# -- the canonical description ---------------------------------------------------------------------------------------


def test_the_reference_gives_its_name_and_claims_every_level() -> None:
    with Session(REFERENCE) as session:
        assert session.started.claims == {"1": list(Level), "2": list(Level), "2.1": list(Level)}
        assert session.started.parser.name == "eurdf"


# -- right and wrong -------------------------------------------------------------------------------------------------


def test_missing_urdf_is_reported_in_the_description(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\nurdf: other.urdf\n', encoding="utf-8")
    answer = Reference().load(tmp_path / "robot.yaml", tmp_path / "other.urdf")
    assert isinstance(answer, Rejected)
    assert [(issue.code, issue.line) for issue in answer.issues] == [("urdf-not-found", 2)]


def test_a_missing_description_is_rejected(tmp_path: Path) -> None:
    answer = Reference().load(tmp_path / "robot.yaml", tmp_path / "robot.urdf")
    assert isinstance(answer, Rejected)
    assert [issue.code for issue in answer.issues] == ["file-unreadable"]


def test_the_urdf_may_have_another_name_than_the_description_gives(tmp_path: Path) -> None:
    description, urdf = write_every_joint(tmp_path)
    assert isinstance(Reference().load(description, urdf.rename(tmp_path / "arm.urdf")), Accepted)


# -- values ----------------------------------------------------------------------------------------------------------


def test_answer_has_only_requested_quantities(tmp_path: Path) -> None:
    parser = Reference()
    parser.load(*write_every_joint(tmp_path))
    (values,) = parser.evaluate([{}], [], ["mass"])
    assert values.model_dump(exclude_none=True).keys() == {"mass"}


@pytest.mark.parametrize(
    ("configuration", "frames", "words"),
    [
        ({"elbow": [0.0]}, [], "'elbow' is not a joint with coordinates"),
        ({"cardan": [0.0]}, [], "joint 'cardan' is given 1 coordinates; it has 2"),
        ({}, ["elbow"], "'elbow' is not a link, joint or frame"),
    ],
)
def test_a_senseless_request_is_errored(configuration: Any, frames: Sequence[str], words: str) -> None:
    with TemporaryDirectory() as folder, Session(REFERENCE) as session:
        assert isinstance(answer_of(session.load(*write_every_joint(Path(folder)))), Accepted)
        answer = answer_of(session.evaluate([configuration], frames, ["poses"]))
        assert isinstance(answer, Errored)
        assert words in answer.message
        assert isinstance(answer_of(session.evaluate([CONFIGURATION], ["tip"], ["poses"])), Evaluated)


def test_evaluating_without_an_accepted_robot_is_errored(tmp_path: Path) -> None:
    robot, missing = write_every_joint(tmp_path), tmp_path / "missing.yaml"
    with Session(REFERENCE) as session:
        for load, outcome in ((None, Errored), (robot, Evaluated), ((missing, robot[1]), Errored), (robot, Evaluated)):
            if load:
                session.load(*load)
            answer = answer_of(session.evaluate([CONFIGURATION], ["tip"], ["poses"]))
            assert isinstance(answer, outcome)
            assert outcome is Evaluated or "the last load did not accept a robot" in answer.message


# -- the examples ----------------------------------------------------------------------------------------------------


@pytest.fixture
def javascript(tmp_path: Path) -> str:
    """The example beside the libraries that it imports, as a reader of the page has it."""
    folder = tmp_path / "adapter"
    folder.mkdir()
    shutil.copy(JAVASCRIPT, folder)
    (folder / "node_modules").symlink_to(MODULES)
    return f"cmd:node {folder / JAVASCRIPT.name}"


def examples() -> Any:
    skip = pytest.mark.skipif(bool(NO_JAVASCRIPT), reason=NO_JAVASCRIPT)
    return pytest.mark.parametrize("example", [EXAMPLE, pytest.param("javascript", marks=skip)])


def parser_of(example: str, request: pytest.FixtureRequest) -> str:
    return str(request.getfixturevalue("javascript")) if example == "javascript" else example


@examples()
def test_an_example_and_the_reference_agree_on_plain_robots(example: str, request: pytest.FixtureRequest) -> None:
    names = sorted(path.parent.name for path in ROBOTS.glob("*/robot.v1.yaml") if "joint_name" not in path.read_text())
    assert len(names) >= 5
    with Session(parser_of(example, request)) as session:
        assert session.started.claims == {"1": ["accept", "structure"]}
        for name in names:
            files = ROBOTS / name / "robot.v1.yaml", ROBOTS / name / "robot.urdf"
            given, expected = canonical(answer_of(session.load(*files))), canonical(Reference().load(*files))
            assert canonical_differences(expected, given, read(*files).bodies) == [], name
    assert isinstance(session.ended, Answered)


@examples()
@pytest.mark.parametrize(
    ("description", "urdf", "kind"),
    [
        ("name_mot: [motor]\nmine: 3\n", '<robot name="r"><link name="a"/></robot>', Accepted),
        ("closed_loop: [[a, nowhere]]\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("closed_loop: [[a, a]]\ntype: [4d]\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("closed_loop: [[a, a]]\ntype: []\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("closed_loop: [[a, a]\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("mine: \udcff\n", '<robot name="r"><link name="a"/></robot>', Rejected),
        ("mine: 3\n", '<robot name="r"><link name="a"></robot>', Rejected),
        ("joint_name: [a]\njoint_type: [SPHERICAL]\n", '<robot name="r"><link name="a"/></robot>', Unsupported),
        ('extended_urdf: "2.0"\n', '<robot name="r"><link name="a"/></robot>', Unsupported),
    ],
)
def test_an_example_distinguishes_invalid_from_unsupported(
    tmp_path: Path, example: str, description: str, urdf: str, kind: type[AnyAnswer], request: pytest.FixtureRequest
) -> None:
    (tmp_path / "robot.yaml").write_text(description, encoding="utf-8", errors="surrogateescape")
    (tmp_path / "robot.urdf").write_text(urdf, encoding="utf-8")
    with Session(parser_of(example, request)) as session:
        assert isinstance(answer_of(session.load(tmp_path / "robot.yaml", tmp_path / "robot.urdf")), kind)
        assert session.restarts == 0


# -- the page ----------------------------------------------------------------------------------------------------------


def blocks(language: str) -> list[str]:
    """The blocks of code of that language on the page."""
    text = (ROOT / "docs" / "write_an_adapter.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def test_the_page_shows_the_examples_as_they_are() -> None:
    assert blocks("python") == [Path(example.__file__).read_text(encoding="utf-8")]
    assert blocks("js") == [JAVASCRIPT.read_text(encoding="utf-8")]


def test_the_conversation_on_the_page_keeps_the_protocol() -> None:
    (conversation,) = blocks("text")
    lines = conversation.splitlines()
    assert len(lines) >= 8
    for asked, answered in zip(lines[::2], lines[1::2], strict=True):
        request = REQUEST.validate_json(asked.removeprefix("→ "))
        found = read_answer(answered.removeprefix("← ").encode(), request)
        assert not isinstance(found, Malformed | Misplaced), str(found)


MISSING = why_not_installed("yaml", "saxes")


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_the_javascript_parser_is_certified_at_every_level(shared_run: Callable[..., SharedRun]) -> None:
    # The newest version, which has few cases; the workflow of the repository certifies it for all of them.
    done = shared_run(
        "--parser", f"cmd:node {PACKAGE / 'adapter' / 'main.js'}", "--seed", "0", "--format-version", "2.1"
    )
    assert done.returncode == 0, done.stdout + done.stderr
    certificate = read_certificate(Path(done.certificate))
    assert certificate.failures == ()
    certified = {(level.version, level.level) for level in certificate.levels if level.certified}
    assert certified == {("2.1", level) for level in Level}
