"""How often a fact is stated, and how large the parts are: duplicates may only become fewer, the rest are caps."""

from __future__ import annotations

import ast
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from types import CodeType
from typing import Any

import eurdf
from support.places import ROOT

SOURCES = {
    path.relative_to(ROOT / "reference").as_posix(): path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "reference" / "eurdf").rglob("*.py"))
}


def naming(pattern: str) -> list[str]:
    """Modules that contain a pattern."""
    return [name for name, text in SOURCES.items() if re.search(pattern, text)]


def lines(*folders: str) -> int:
    return sum(
        len(path.read_text(encoding="utf-8").splitlines())
        for folder in folders
        for path in (ROOT / folder).rglob("*.py")
        if "node_modules" not in path.parts
    )


def numbers(text: str) -> Iterator[tuple[str, str]]:
    """Name and value of each numeric constant of a module."""
    for statement in ast.parse(text).body:
        target = statement.targets[0] if isinstance(statement, ast.Assign) else None
        if not isinstance(target, ast.Name) or not target.id.strip("_").isupper():
            continue
        parts = list(ast.walk(statement.value))  # type: ignore[attr-defined]
        if all(isinstance(part, ast.Constant | ast.BinOp | ast.UnaryOp | ast.operator | ast.unaryop) for part in parts):
            values = [part.value for part in parts if isinstance(part, ast.Constant)]
            if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
                yield target.id.strip("_"), ast.unparse(statement.value)  # type: ignore[attr-defined]


def test_a_kind_of_closure_is_named_in_few_files() -> None:
    assert len(naming(r'DistanceClosure|"distance"')) <= 6, naming(r'DistanceClosure|"distance"')


def test_a_joint_type_is_named_in_few_files() -> None:
    assert len(naming(r"JointType\.")) <= 15, naming(r"JointType\.")
    assert sum(text.count("match joint.type") for text in SOURCES.values()) <= 1


def test_a_number_is_stated_once() -> None:
    found: dict[tuple[str, str], set[str]] = defaultdict(set)
    for module, text in SOURCES.items():
        for constant in numbers(text):
            found[constant].add(module)
    assert not {constant: sorted(modules) for constant, modules in found.items() if len(modules) > 1}


def test_a_class_has_a_name_of_its_own() -> None:
    found: dict[str, set[str]] = defaultdict(set)
    for module, text in SOURCES.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ClassDef):
                found[node.name.strip("_")].add(module)
    named_twice = {name: sorted(modules) for name, modules in found.items() if len(modules) > 1}
    # The results of `eurdf.batch` have the names of its functions.
    assert named_twice.keys() <= {"InverseKinematics"}, named_twice


def test_a_module_has_one_subject() -> None:
    count = {name: len(text.splitlines()) for name, text in SOURCES.items() if not name.endswith("__init__.py")}
    short = {name: of for name, of in count.items() if of <= 45}
    assert len(short) <= 10, short
    long = {name: of for name, of in count.items() if of > 400}
    assert len(long) <= 2, long


def test_few_names_are_public() -> None:
    assert len(eurdf.__all__) <= 45


def test_lines_stay_within_bounds() -> None:
    assert lines("reference") <= 63_400  # to become 40,000
    assert lines("tests", "conformance/tests") <= 50_800  # to become 36,000


def test_forward_kinematics_passes_through_few_functions() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = eurdf.assemble(robot).q
    values = q[robot.actuation.idx_q] + 0.01
    eurdf.forward_kinematics(robot, values, q)  # what is made once is made here
    seen: set[CodeType] = set()

    def note(frame: Any, event: str, _: object) -> None:
        if event == "call" and "/eurdf/" in frame.f_code.co_filename:
            seen.add(frame.f_code)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        eurdf.forward_kinematics(robot, values, q)
    finally:
        sys.setprofile(before)
    assert len({code.co_filename for code in seen}) <= 14, sorted({code.co_filename for code in seen})
    assert len(seen) <= 80
