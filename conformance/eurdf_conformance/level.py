"""What a parser can claim, for each version of the format."""

from __future__ import annotations

from typing import Literal

from eurdf_conformance.text_enum import TextEnum

#: "2" is version 2.0.
Version = Literal["1", "2", "2.1"]

VERSIONS: tuple[Version, ...] = ("1", "2", "2.1")


class Level(TextEnum):
    """A level of conformance, certified apart: chapter Conformance of the specification."""

    ACCEPT = "accept"
    STRUCTURE = "structure"
    KINEMATICS = "kinematics"
    DYNAMICS = "dynamics"
    DIAGNOSE = "diagnose"
