"""Robots that are measured: the collection, and chains of four-bars."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import eurdf
from benchmarks.loops import four_bars
from eurdf.mechanism.body import Inertia
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import build_robot

ROBOTS = tuple(eurdf.collection_names())

#: Sizes of the chains. Peers that need a `pin.Data` of the whole robot are measured on the first one only: that of 100
#: four-bars takes 1.7 GB, and that of 1,000 a thousand times as much.
CHAINS = (10, 100, 1000)

_START = {"crank": 0.9, "coupler": -0.7, "rocker": 1.9}  # rad, near a closed configuration


def robot_called(name: str) -> eurdf.Robot:
    """A robot of the collection without geometry, or a chain such as ``10 four-bars``."""
    count, _, kind = name.partition(" ")
    return chain(int(count)) if kind == "four-bars" else eurdf.load(name, geometry=False)


def chain(count: int, in_series: bool = True) -> eurdf.Robot:
    """Four-bars with inertia: each on the rocker of the one before, or all side by side."""
    mechanism = four_bars(count, in_series).mechanism
    inertia = Inertia(1.0, Pose((0.5, 0.0, 0.0)), (0.1, 0.0, 0.0, 0.1, 0.0, 0.1))
    assembled = {f"{bar}{index}_pin": (angle,) for index in range(count) for bar, angle in _START.items()}
    return build_robot(
        replace(
            mechanism,
            bodies=tuple(replace(body, inertia=inertia) for body in mechanism.bodies),
            configurations=MappingProxyType({"assembled": assembled}),
        ),
        geometry=False,
    )


def chains() -> list[str]:
    """Names of the chains."""
    return [f"{count} four-bars" for count in CHAINS]
