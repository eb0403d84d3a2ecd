"""3d or 6d: the type of closures whose names do not state it, chosen by the motion that it leaves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from eurdf.closures import REGISTRY
from eurdf.diagnostics import enumerated, plural
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.writing.naming_conventions import ClosureType

# Groups of loops that share no joint are judged one by one, but for a robot of so many that it would take long.
_MOST_GROUPS = 32

# In one group, closures that are tried one by one.
_MOST_CLOSURES = 12


@dataclass(frozen=True, slots=True)
class ChosenTypes:
    """The types that were chosen, by the name of the closure.

    The notes say why, one sentence for each group of loops that share joints.
    """

    types: Mapping[str, ClosureType]
    notes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Candidate:
    """Types of some closures, and the motion that they leave.

    Attributes:
        types: By the name of the closure.
        closes: Whether the loops can be closed; False where that was not computed.
        mobility: Motions that the loops leave.
        uncontrolled: Of these, motions left with every actuator held.
        dependent: Actuators whose velocities depend on one another, set by set; one alone in its set cannot move.
        locked: Loops without an actuator that cannot move at all.
        left_out: Why the motion was not computed; else empty.
    """

    types: Mapping[str, ClosureType]
    closes: bool
    mobility: int = 0
    uncontrolled: int = 0
    dependent: tuple[tuple[str, ...], ...] = ()
    locked: int = 0
    left_out: str = ""

    @property
    def overconstrained(self) -> int:
        """How much motion the closures take that the actuators, or the loops themselves, ought to have."""
        return sum(map(len, self.dependent)) + self.locked


def choose_types(mechanism: Mechanism, undecided: Iterable[str], called: Sequence[str]) -> ChosenTypes:
    """Choose between 3d and 6d for the closures whose names state neither.

    A closure is 6d, as where version 1 does not state its type, unless the loops then cannot close, or are locked, or
    have actuators whose velocities depend on one another, and with 3d they do not. Of loops that need 3d, each closure
    becomes 6d again that is closed as well, and that leaves fewer motions without an actuator.

    Returns:
        Their types, and why.
    """
    open_names = set(undecided)
    words = {closure.name: word for closure, word in zip(mechanism.closures, called, strict=True)}
    types: dict[str, ClosureType] = {}
    notes = []
    for group in _groups(mechanism):
        names = [name for name in group if name in open_names]
        if names:
            part = replace(
                mechanism, closures=tuple(closure for closure in mechanism.closures if closure.name in group)
            )
            chosen, note = _choose(part, names, words)
            types.update(chosen.types)
            notes.append(note)
    return ChosenTypes(types, tuple(notes))


def _groups(mechanism: Mechanism) -> list[list[str]]:
    """Names of closures, by groups of loops that share no joint."""
    from eurdf.kinematics.loop import independent_groups
    from eurdf.pinocchio.robot import build_robot

    names = [closure.name for closure in mechanism.closures]
    if len(names) > 1:
        groups = independent_groups(build_robot(mechanism, geometry=False))
        if len(groups) <= _MOST_GROUPS:
            return [[names[index] for index in group.closures] for group in groups]
    return [names]


def _choose(mechanism: Mechanism, names: Sequence[str], words: Mapping[str, str]) -> tuple[_Candidate, str]:
    def are(names: Sequence[str], kind: str) -> str:
        return _are([words[name] for name in names], kind)

    with_6d = _candidate(mechanism, dict.fromkeys(names, "6d"))
    if with_6d.left_out or (with_6d.closes and not with_6d.overconstrained):
        return with_6d, f"{are(names, '6d')}: {_effect(with_6d)}"
    with_3d = _candidate(mechanism, dict.fromkeys(names, "3d"))
    if not with_3d.closes or (with_6d.closes and with_3d.overconstrained >= with_6d.overconstrained):
        return with_6d, f"{are(names, '6d')}, though {_effect(with_6d)}: with 3d {_effect(with_3d)}"
    chosen = with_3d
    for name in names if 1 < len(names) <= _MOST_CLOSURES else ():
        stiffer = _candidate(mechanism, {**chosen.types, name: "6d"})
        if (
            stiffer.closes
            and stiffer.overconstrained <= chosen.overconstrained
            and stiffer.uncontrolled < chosen.uncontrolled
        ):
            chosen = stiffer
    by_type = {kind: [name for name in names if chosen.types[name] == kind] for kind in ("3d", "6d")}
    said = " and ".join(are(those, kind) for kind, those in by_type.items() if those)
    return chosen, f"{said}: {_effect(chosen)}; with 6d {_effect(with_6d)}"


def _candidate(mechanism: Mechanism, types: Mapping[str, ClosureType]) -> _Candidate:
    from eurdf.kinematics.analysis import analyze
    from eurdf.pinocchio.robot import build_robot

    closures = tuple(_with_type(closure, types.get(closure.name)) for closure in mechanism.closures)
    analysis = analyze(build_robot(replace(mechanism, closures=closures), geometry=False))
    if analysis.left_out or not analysis.closes:
        return _Candidate(types, False, left_out=analysis.left_out)
    return _Candidate(
        types,
        True,
        sum(loop.mobility for loop in analysis.loops),
        sum(loop.uncontrolled for loop in analysis.loops),
        analysis.dependent_actuators,
        sum(loop.mobility == 0 and not loop.actuated for loop in analysis.loops),
    )


def _with_type(closure: Closure, type_: ClosureType | None) -> Closure:
    return REGISTRY[type_](closure.name, closure.a, closure.b) if type_ else closure


def _dependent(together: Sequence[str]) -> str:
    return f"{enumerated(together)} {'cannot move' if len(together) == 1 else 'depend on one another'}"


def _are(names: Sequence[str], kind: str) -> str:
    return f"{enumerated(names)} {'is' if len(names) == 1 else 'are'} {kind}"


def _effect(candidate: _Candidate) -> str:
    """What a candidate does to its loops, as a clause of a sentence."""
    if candidate.left_out:
        return candidate.left_out
    if not candidate.closes:
        return "no configuration closes the loops"
    if not candidate.mobility:
        return "the loops close, but nothing in them can move"
    many = plural(candidate.mobility, "motion")
    if candidate.dependent:
        return f"the loops close and keep {many}, but {'; '.join(map(_dependent, candidate.dependent[:3]))}"
    if candidate.locked:
        return f"the loops close and keep {many}, but {candidate.locked} of them cannot move"
    left = f", {candidate.uncontrolled} of them without a motor" if candidate.uncontrolled else ""
    return f"the loops close and keep {many}{left}"
