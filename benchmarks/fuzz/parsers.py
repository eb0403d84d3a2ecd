"""Damaged robots, read by three parsers that were written apart: their verdicts and what they read are compared.

The three are the reference, the oracle of the conformance suite, and the parser in JavaScript. The oracle is no
validator: it may read what the others reject, but what they accept, it reads.
"""

from __future__ import annotations

import atexit
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path

from benchmarks.fuzz.robots import ROOT
from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.read import read
from eurdf_conformance.protocol.message import Accepted, CanonicalRobot, Rejected
from eurdf_conformance.runner.outcome import Answered
from eurdf_conformance.runner.session import Session

JAVASCRIPT = ROOT / "js"

#: How the parser in JavaScript rejects a description as EU-YML-012 permits: inside quotes, a line without indentation.
PERMITTED = ('yaml: Missing closing "quote', "yaml: Missing closing 'quote")

#: What the reference rejects as it permits: a key of more than 1024 characters.
LONG_KEY = re.compile(rb"[^\r\n]{1025}:")

#: What the oracle rejects as it permits: a tab outside scalars and comments.
TAB = "found character '\\t'"

#: What a description of a bare URDF says.
BARE = b'extended_urdf: "2.0"\n'


def why_not() -> str:
    """Why the parser in JavaScript cannot be run; empty if it can."""
    if (JAVASCRIPT / "node_modules").is_dir():
        return ""
    return f"the parser in JavaScript is not installed: npm install --prefix {JAVASCRIPT.relative_to(ROOT)}"


def try_parsers(description: Path, urdf: Path, clock: Callable[[], None] = lambda: None) -> str:
    """Let each parser read a robot.

    Args:
        description: The YAML file.
        urdf: The URDF, whatever the description names.
        clock: Called before each parser.

    Returns:
        ``refused``, ``robot``, or ``permitted`` where the text permits one parser to reject what the others read.

    Raises:
        AssertionError: Two parsers disagree.
    """
    clock()
    first = Reference().load(description, urdf)
    clock()
    outcome = javascript().load(description, urdf)
    assert isinstance(outcome, Answered), f"the parser in JavaScript {outcome}"
    second = outcome.answer
    if not isinstance(first, Accepted):
        if not isinstance(second, Accepted):
            return "refused"
        issue = first.issues[0]
        permitted = issue.code == "yaml-syntax" and LONG_KEY.search(description.read_bytes())
        assert permitted, f"only JavaScript reads it: {issue.message}"
        return "permitted"
    if isinstance(second, Rejected):
        message = second.issues[0].message or ""
        assert message.startswith(PERMITTED), f"only JavaScript rejects it: {message}"
        return "permitted"
    assert isinstance(second, Accepted), f"the parser in JavaScript answers '{second.outcome}'"
    clock()
    try:
        oracle = read(description, urdf)
    except NotRead as error:
        if TAB in str(error):
            return "permitted"
        raise AssertionError(f"only the oracle does not read it: {error}") from error
    _compare("reference", first.robot, oracle.canonical(), oracle.bodies)
    _compare("JavaScript", second.robot, oracle.canonical(), oracle.bodies)
    return "robot"


def _compare(name: str, given: CanonicalRobot | None, expected: CanonicalRobot, bodies: list[list[str]]) -> None:
    assert given is not None
    for difference in canonical_differences(expected, given, bodies):
        raise AssertionError(f"{name} reads another robot than the oracle: {difference}")


@cache
def javascript() -> Session:
    """The parser in JavaScript, which is started once."""
    session = Session(f"cmd:node {JAVASCRIPT / 'adapter' / 'main.js'}")
    atexit.register(session.stop)
    return session
