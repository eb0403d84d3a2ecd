"""Damaged robots: drawn from sound ones, checked, loaded and moved."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from benchmarks.fuzz.mutators import XML_BYTES, YAML_BYTES, mutate_bytes, mutate_xml, mutate_yaml

ROOT = Path(__file__).parents[2]


@dataclass(frozen=True, slots=True)
class Seed:
    """A sound robot: its URDF, and a description or None."""

    title: str
    urdf: bytes
    description: bytes | None


def seeds(folders: Sequence[Path] = ()) -> list[Seed]:
    """The robots to damage: those in the folders, or else those of the project."""
    if folders:
        return [
            Seed(folder.name, (folder / "robot.urdf").read_bytes(), (folder / "robot.yaml").read_bytes())
            for folder in folders
        ]
    found = []
    data = ROOT / "tests" / "data"
    workbench = (data / "workbench.urdf").read_bytes()
    for folder, stem in (
        (data, "workbench"),
        *((ROOT / "robots" / name, "robot") for name in ("digit_leg", "four_bar")),
    ):
        urdf = (folder / f"{stem}.urdf").read_bytes()
        for ending in (".yaml", ".v1.yaml"):
            found.append(Seed(f"{folder.name}/{stem}{ending}", urdf, (folder / f"{stem}{ending}").read_bytes()))
    found.append(Seed("workbench.2.1.yaml", workbench, (data / "workbench.2.1.yaml").read_bytes()))
    found.append(Seed("bare workbench", workbench, None))
    return found


@dataclass(frozen=True, slots=True)
class Case:
    """A damaged robot."""

    title: str
    urdf: bytes
    description: bytes | None


def case_of(seed: int, index: int, robots: Sequence[Seed]) -> Case:
    """The case of a seed; the same for the same robots, whatever ran before it."""
    chance = random.Random(f"{seed}:{index}")
    robot = chance.choice(robots)
    names = [
        name for name in (found.get("name") for found in etree.fromstring(robot.urdf).iter("link", "joint")) if name
    ]
    urdf, description = robot.urdf, robot.description
    how = chance.choice(
        ("yaml tree", "yaml tree", "urdf tree", "urdf tree", "both trees", "yaml bytes", "urdf bytes", "all")
    )
    if description is not None and how in ("yaml tree", "both trees", "all"):
        description = mutate_yaml(description, chance, names)
    if description is None or how in ("urdf tree", "both trees", "all"):
        urdf = mutate_xml(urdf, chance, names)
    if description is not None and how in ("yaml bytes", "all"):
        description = mutate_bytes(description, chance, YAML_BYTES)
    if how in ("urdf bytes", "all"):
        urdf = mutate_bytes(urdf, chance, XML_BYTES)
    return Case(f"{robot.title}, {how}", urdf, description)


def write_case(case: Case, folder: Path) -> Path:
    """Write the files of a case; the path to give to `eurdf.check`."""
    for name in ("robot.urdf", "workbench.urdf"):  # what the descriptions name
        (folder / name).write_bytes(case.urdf)
    if case.description is None:
        return folder / "robot.urdf"
    (folder / "robot.yaml").write_bytes(case.description)
    return folder / "robot.yaml"


def try_robot(path: Path, *, analyse: bool, clock: Callable[[], None] = lambda: None) -> str:
    """Check, load and move a robot.

    Args:
        path: What to check.
        analyse: Whether to analyse a robot that was loaded.
        clock: Called before each step that should end soon.

    Returns:
        What it came to: ``refused``, ``no geometry`` or ``robot``.

    Raises:
        AssertionError: A promise is broken.
        Exception: One that should not have left the package.
    """
    import numpy as np
    import pinocchio as pin

    import eurdf
    from eurdf.diagnostics import REGISTRY
    from eurdf.diagnostics.registry import REFUSED_PHASES
    from eurdf.diagnostics.report import reports_to_json
    from eurdf.diagnostics.text import report_lines

    clock()
    report = eurdf.check(path)
    for found in report.diagnostics:
        assert found.code in REGISTRY
        assert found.message
        assert len(str(found)) < 5000, f"a diagnostic of {len(str(found))} characters"
    json.dumps(reports_to_json([report]), allow_nan=False).encode()
    "".join(text for line in report_lines(report) for text, _ in line).encode("utf-8", "strict")
    refused = any(found.phase in REFUSED_PHASES for found in report.errors)
    clock()
    try:
        robot = eurdf.load(path, check_loops=True)
    except eurdf.InvalidRobot as error:
        if not refused:
            raise AssertionError("load refuses what check passes") from error
        return "refused"
    assert not refused, "load takes what check refuses"
    told = {found.code for found in robot.diagnostics}
    # Advice is check's own.
    assert told == {found.code for found in report.diagnostics if found.clause is not None}
    q = pin.neutral(robot.model)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    pin.computeJointJacobians(robot.model, robot.data, q)
    for configuration in robot.configurations.values():
        assert np.isfinite(configuration).all()
    if "urdf-mesh-missing" not in told:
        data = pin.GeometryData(robot.collision_model)
        pin.updateGeometryPlacements(robot.model, robot.data, robot.collision_model, data, q)
    if analyse:
        clock()
        analysis = eurdf.analyze(robot)
        assert analysis.closes == (analysis.rank is not None)
        assert np.isfinite(analysis.q).all()
    return "robot"
