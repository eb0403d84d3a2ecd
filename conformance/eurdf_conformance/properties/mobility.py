"""Properties on counts: nv, nc, rank and mobility, of random mechanisms and of families where they are known."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.properties.agreement import accepted
from eurdf_conformance.properties.counts import Counts, count_differences, counts_of
from eurdf_conformance.properties.document import configuration
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.families import paradoxical, planar, platforms, spherical
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.truth import truth

_CLAUSES = ("EU-CLO-010", "EU-CLO-011", "EU-PRO-007", "EU-CLO-008", "EU-CLO-009")


def mobility(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """The counts at the closed configuration; the examples are well conditioned."""
    robot = truth(example.mechanism, version)
    assembled = example.mechanism.configurations["assembled"]
    q = configuration(example.mechanism, assembled, version)
    (values,) = harness.evaluate(
        query_of(example.mechanism, version, at={"assembled": assembled}, frames=[]), ("jacobian",)
    )
    assert values.jacobian is not None
    rows = [np.array(rows).reshape(-1, len(robot.velocities)) for rows in values.jacobian.rows.values()]
    given = counts_of(np.vstack([np.zeros((0, len(robot.velocities))), *rows]), robot, q)
    expected = Counts(*example.known) if example.known else counts_of(robot.jacobian(q), robot, q)
    return count_differences(expected, given, "/values/0/jacobian")


def family(name: str, title: str, member: Callable[[int], Example], sizes: Sequence[int]) -> Property:
    """The property for one family."""
    return Property(
        name,
        title,
        _CLAUSES,
        (Level.KINEMATICS,),
        mobility,
        versions=("2",),
        examples=lambda version: [member(size) for size in sizes],
        family=member,
        smallest=sizes[0],
    )


def redundant() -> list[Example]:
    """The members of all families that have redundant rows."""
    members = [planar.polygon(4), planar.spatial_polygon(5), planar.parallelograms(3), spherical.polygon(4)]
    return [*members, paradoxical.sarrus(2), paradoxical.bennett(8)]


PROPERTIES = (
    Property(
        "redundant-rows",
        "A mechanism whose closures have redundant rows is accepted.",
        ("EU-CLO-011", "EU-CNF-002"),
        (Level.ACCEPT,),
        accepted,
        versions=("2",),
        examples=lambda version: redundant(),
        family=planar.spatial_polygon,
        smallest=4,
    ),
    Property(
        "mobility",
        "nv, nc, rank, mobility, redundant rows and uncontrolled mobility are those of the mechanism.",
        _CLAUSES,
        (Level.KINEMATICS,),
        mobility,
        versions=VERSIONS,
    ),
    family("planar-polygon", "A planar ring of n hinges has mobility n − 3.", planar.polygon, range(4, 9)),
    family(
        "planar-polygon-6d",
        "A planar ring of n hinges closed by a 6d closure has three redundant rows.",
        planar.spatial_polygon,
        range(4, 9),
    ),
    family("parallelograms", "n parallel cranks have mobility 1.", planar.parallelograms, range(1, 6)),
    family(
        "spherical-polygon",
        "A ring of n hinges through one point has mobility n − 3.",
        spherical.polygon,
        range(4, 9),
    ),
    family("ball-ring", "A ring of n balls has mobility 3 n − 6.", spherical.balls, range(3, 8)),
    family("ball-chain", "A chain of n balls has mobility 3 n.", spherical.ball_chain, range(1, 6)),
    family("platform-ups", "A platform on legs UPS has mobility 6.", platforms.with_universals, range(3, 8)),
    family("platform-sps", "A platform on n legs SPS has mobility 6 + n.", platforms.with_balls, range(3, 8)),
    family("sarrus", "A Sarrus linkage has one redundant row and moves.", paradoxical.sarrus, range(2, 5)),
    family("bennett", "A Bennett linkage has three redundant rows and moves.", paradoxical.bennett, range(6, 11)),
)
