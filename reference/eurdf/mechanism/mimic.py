"""Mimic joints, and the leader of each chain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Mimic:
    """q = multiplier · q_joint + offset, in rad or m."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


def drivers(mimics: Mapping[str, Mimic]) -> dict[str, Mimic]:
    """For each mimic joint, the joint at the end of its chain, and the relation between the two.

    A chain q₂ = m₂ q₁ + o₂, q₁ = m₁ q + o₁ becomes q₂ = m₂ m₁ q + (m₂ o₁ + o₂). A joint whose chain ends in a cycle is
    skipped.

    Args:
        mimics: For each mimic joint, the joint that it names and the relation between the two, in rad or m.
    """
    resolved: dict[str, Mimic] = {}
    endless: set[str] = set()
    for name in mimics:
        chain: dict[str, None] = {}
        while name in mimics and not (name in resolved or name in chain or name in endless):
            chain[name] = None
            name = mimics[name].joint
        if name in chain or name in endless:
            endless.update(chain)
            continue
        for joint in reversed(chain):
            mimic = mimics[joint]
            step = resolved.get(mimic.joint)
            if step is not None:
                offset = mimic.multiplier * step.offset + mimic.offset
                mimic = Mimic(step.joint, mimic.multiplier * step.multiplier, offset)
            resolved[joint] = mimic
    return resolved
