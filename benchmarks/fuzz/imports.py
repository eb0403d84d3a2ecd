"""Damaged files of simulators: drawn from exports of robots of the project, imported, checked and loaded."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from lxml import etree

from benchmarks.fuzz.mutators import ATTRIBUTES, TAGS, XML_BYTES, mutate_bytes, mutate_xml
from benchmarks.fuzz.robots import ROOT

#: Formats that can be imported.
FORMATS = ("sdf", "mjcf", "drake", "urdf-plus", "loop-joint")

_ROBOTS = ("robots/four_bar", "robots/digit_leg", "robots/spherical_four_bar", "robots/screw_press", "tests/data")


def import_of(format_: str, chance: random.Random) -> tuple[str, bytes]:
    """The robot and the damage in words, and a damaged file of a format."""
    title, content = chance.choice(_exports(format_))
    tags, attributes, names = _words(format_)
    how = chance.choice(("tree", "tree", "tree", "bytes", "both"))
    if how != "bytes":
        content = mutate_xml(content, chance, names, tags, attributes)
    if how != "tree":
        content = mutate_bytes(content, chance, XML_BYTES)
    return f"{title}, {how}", content


@cache
def _exports(format_: str) -> list[tuple[str, bytes]]:
    import eurdf

    found = []
    for name in _ROBOTS:
        path = ROOT / name / "workbench.2.1.yaml" if name == "tests/data" else ROOT / name
        files = eurdf.export(path, "loop-joint" if format_ == "urdf-plus" else format_).files
        content = next(iter(files.values()))
        found.append((name.rpartition("/")[2], _urdf_plus(content) if format_ == "urdf-plus" else content))
    return found


def _urdf_plus(content: bytes) -> bytes:
    """A URDF with loop joints as one of URDF+, to which nothing is exported; its first and last joints are coupled."""
    root = etree.fromstring(content)
    for loop in root.findall("loop_joint"):
        loop.tag = "loop"
        for end, tag in zip(loop.findall("*")[:2], ("predecessor", "successor"), strict=True):
            end.tag = tag
            origin = etree.SubElement(end, "origin")
            for key in ("xyz", "rpy"):
                if key in end.attrib:
                    origin.set(key, end.attrib.pop(key))
    turning = [joint for joint in root.findall("joint") if joint.get("type") in ("revolute", "continuous")]
    moved = [joint.find("child") for joint in turning if joint.find("mimic") is None]
    coupling = etree.SubElement(root, "coupling", name="coupled")
    for tag, child in (("predecessor", moved[0]), ("successor", moved[-1])):
        assert child is not None
        etree.SubElement(coupling, tag, link=child.get("link", ""))
    etree.SubElement(coupling, "ratio", value="2")
    return etree.tostring(root)


@cache
def _words(format_: str) -> tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]:
    """The tags and attributes of a format, and the names in the files to damage."""
    tags, attributes, names = dict.fromkeys(TAGS), dict.fromkeys(ATTRIBUTES), dict[str, None]()
    for _, content in _exports(format_):
        for element in etree.fromstring(content).iter("*"):
            tags[str(element.tag)] = None
            attributes |= dict.fromkeys(map(str, element.attrib))
            names |= dict.fromkeys(filter(None, [element.get("name")]))
    return tuple(tags), tuple(attributes), tuple(names)


def try_import(path: Path, format_: str, *, clock: Callable[[], None] = lambda: None) -> str:
    """Import a file, write the robot beside it, check it and load it.

    Args:
        path: The file.
        format_: Its format.
        clock: Called before each step that should end soon.

    Returns:
        What it came to: ``refused``, ``imported``, or ``with errors``, of which the import says the same as a check.

    Raises:
        AssertionError: A promise is broken.
        Exception: One that should not have left the package.
    """
    import numpy as np

    import eurdf

    clock()
    try:
        found = eurdf.import_robot(path, format=format_)
    except eurdf.errors.CannotImport as refusal:
        reason = str(refusal)
    else:
        reason = ""
    if reason:
        assert reason.isprintable(), "the message has several lines, or control characters"
        return "refused"
    folder = path.parent / "imported"
    found.write(folder)
    clock()
    report = eurdf.check(folder)
    assert _said(report.diagnostics) == _said(found.diagnostics), "import and check say different things"
    clock()
    robot = eurdf.load(folder, geometry=False)
    assert all(np.isfinite(q).all() for q in robot.configurations.values())
    return "imported" if report.ok else "with errors"


def _said(diagnostics: Any) -> list[tuple[str, int | None]]:
    return [(each.code, each.line) for each in diagnostics]
