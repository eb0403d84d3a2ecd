"""Whether a robot is at least as good after a fix, by the checks of this package; otherwise it is no fix."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eurdf.diagnostics import REGISTRY, Phase, Severity

if TYPE_CHECKING:
    from eurdf.kinematics.analysis import Analysis
    from eurdf.kinematics.loop_analysis import LoopAnalysis


#: Codes of what a value says by itself, whatever the rest of the robot is: an error hides them, but no fix causes them.
_LOCAL = frozenset(
    {
        *("x-angle-in-degrees", "x-length-in-millimetres", "x-tiny-robot", "x-quaternion-order"),
        *("x-massless-link", "x-mimic-ignored", "x-no-actuator", "x-no-closure", "closure-type-unknown"),
        *("x-implausible-inertia", "x-implausible-mimic", "urdf-no-range"),
    }
)


#: Codes whose fixes do not change how a robot moves, and what else an error hides then: no fix of them causes it.
_STILL = frozenset({"coupling-joint", "joint-not-mimic"})
_OF_MOTION = _LOCAL | {"x-dependent-actuators", "x-uncontrolled-motion", "x-actuator-several"}

#: Codes of elements and attributes of a URDF, which the other elements say nothing of.
_OF_ELEMENTS = frozenset(
    {"xml-syntax", "urdf-joint-type", "urdf-geometry", "urdf-missing-attribute", "urdf-missing-element"}
)

#: Phases that look at one file.
_FILES = (Phase.YAML, Phase.SCHEMA, Phase.URDF)


def is_of_the_text(code: str) -> bool:
    """Whether it is an error that the text of one file alone decides: what it hides says nothing of it."""
    rule = REGISTRY[code]
    return rule.severity is Severity.ERROR and (rule.phase in (Phase.YAML, Phase.SCHEMA) or code in _OF_ELEMENTS)


@dataclass(frozen=True)
class Evidence:
    """What a check finds out about a robot, to compare it with the same robot after a fix.

    Attributes:
        counts: The number of diagnostics of each code.
        is_whole: Whether it has no error, which would hide others.
        analysis: How it moves; None if that is not known, as of one with errors.
    """

    counts: Counter[str]
    is_whole: bool = False
    analysis: Analysis | None = None

    def is_enough_for(self, code: str) -> bool:
        """Whether it can show that a fix of a diagnostic is right."""
        return self.is_whole or is_of_the_text(code)

    def is_as_good_as(self, before: Evidence, code: str) -> bool:
        """Whether after a fix of one diagnostic, whose code is given, the robot is at least as good as before.

        That diagnostic is gone, and there is no new one, except what an error hid before; no actuator has lost its
        independence, no loop has become rigid, and none has fewer motions than actuated velocities.
        """
        new = {each for each in self.counts if self.counts[each] > before.counts[each]}
        if is_of_the_text(code):
            return self.counts[code] < before.counts[code] and not any(REGISTRY[each].phase in _FILES for each in new)
        hidden = set() if before.is_whole else _OF_MOTION if code in _STILL else _LOCAL
        if self.counts[code] >= before.counts[code] or not new <= hidden:
            return False
        if code in _STILL and before.analysis is None:
            return True
        if self.analysis is None:
            return before.analysis is None
        rigid = self._closures(lambda loop: not loop.mobility) & before._closures(lambda loop: bool(loop.mobility))
        short = self._closures(_is_short) <= before._closures(_is_short)
        return self._bound <= before._bound and short and not rigid

    def _closures(self, which: Callable[[LoopAnalysis], bool]) -> set[str]:
        """The closures and couplings of some groups of loops."""
        loops = () if self.analysis is None else self.analysis.loops
        return {name for loop in loops if which(loop) for name in loop.closures}

    @property
    def _bound(self) -> set[str]:
        """The actuators that cannot move independently."""
        loops = () if self.analysis is None else self.analysis.loops
        return {name for loop in loops for together in loop.dependent_actuators for name in together}


def _is_short(loop: LoopAnalysis) -> bool:
    return loop.mobility < loop.actuated
