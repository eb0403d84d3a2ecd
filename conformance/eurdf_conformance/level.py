"""What a parser can claim, for each version of the format."""

from __future__ import annotations

from enum import StrEnum
from typing import Literal

Version = Literal["1", "2"]

VERSIONS: tuple[Version, ...] = ("1", "2")


class Level(StrEnum):
    """A level of conformance, certified apart: chapter Conformance of the specification."""

    ACCEPT = "accept"
    STRUCTURE = "structure"
    KINEMATICS = "kinematics"
    DYNAMICS = "dynamics"
    DIAGNOSE = "diagnose"
