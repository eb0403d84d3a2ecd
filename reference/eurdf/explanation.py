"""`eurdf.explain`: what `eurdf.check` finds, by subject and with its causes, and how the robot moves."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, get_args

from eurdf.diagnostics import REGISTRY, Diagnostic, Phase, enumerated, plural
from eurdf.errors import InvalidRobot
from eurdf.json_schema import HIDDEN
from eurdf.loading import SOURCES, check, load
from eurdf.reading.robot_source import RobotSource, display_name, is_stream

if TYPE_CHECKING:
    from eurdf.kinematics.analysis import Analysis
    from eurdf.pinocchio.robot import Robot

Subject = Literal["files", "loops", "motions", "actuators", "values", "sides"]

#: Motions of a kind that are listed, at most.
_LISTED = 8

#: The subject of codes that is not that of their phase: of inertias and advice it is values, of other phases files.
_SUBJECTS: dict[str, Subject] = {
    **dict.fromkeys(("assembled-open", "closure-cannot-close", "x-open-at-neutral", "x-closes-beyond-limits"), "loops"),
    **dict.fromkeys(("x-shaky-loops", "x-loops-not-checked"), "loops"),
    **dict.fromkeys(("x-uncontrolled-motion", "x-no-actuator", "x-mimic-ignored"), "motions"),
    **dict.fromkeys(("x-dependent-actuators", "x-actuator-several"), "actuators"),
    "x-asymmetric": "sides",
}


@dataclass(frozen=True, slots=True)
class Cause:
    """A diagnostic, with its cause or its fix."""

    code: str
    """Its code."""
    place: str
    """File, line and column."""
    message: str
    """What is wrong."""
    hint: str | None
    """What causes it, as a question, or the fix; None if unknown."""
    certain: bool
    """Whether the hint is a fix that a trial showed to be right, which 'eurdf check --fix' applies."""


@dataclass(frozen=True, slots=True)
class Topic:
    """What there is to say on one subject."""

    subject: Subject
    """The files; closed loops; motions without an actuator; dependent actuators; values; the sides, left and right."""
    facts: tuple[str, ...]
    """How the robot is, as sentences without a full stop; none where it cannot be built."""
    causes: tuple[Cause, ...]
    """What is wrong with it."""


@dataclass(frozen=True, slots=True, repr=False)
class Explanation:
    """Why a robot is as it is."""

    path: str
    """The robot as it was given; its name, if it was loaded before."""
    topics: tuple[Topic, ...]
    """The subjects on which there is something to say."""
    diagnostics: tuple[Diagnostic, ...] = field(metadata=HIDDEN)
    """Those of `eurdf.check`, with the fixes; of a loaded robot, those that it has."""

    def __repr__(self) -> str:
        found = plural(len(self.diagnostics), "diagnostic")
        return f"<Explanation of '{self.path}': {', '.join(each.subject for each in self.topics)}; {found}>"

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self) -> Iterator[str]:
        """The text, a subject after the other."""
        for topic in self.topics:
            yield topic.subject
            yield from (f"  {fact}" for fact in topic.facts)
            for cause in topic.causes:
                yield f"  {cause.message} [{cause.code}]"
                yield f"      at {cause.place}"
                if cause.hint:
                    yield f"      {'fix' if cause.certain else 'cause'}: {cause.hint}"


def explain(
    robot: Robot | RobotSource,
    urdf: RobotSource | None = None,
    *,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    xacro_args: Mapping[str, str] | None = None,
    confined: bool = False,
    allow_outside: bool = False,
) -> Explanation:
    """Explain why loops are open, motions uncontrolled and actuators dependent, and which values are implausible.

    These are the diagnostics of `eurdf.check`, by subject; and, of a robot that can be built, how it moves. Standard
    input and pipes can be read only once, so that how their robots move is left out. Of a robot that was loaded, the
    diagnostics are those that it has, without advice.

    The arguments are those of `eurdf.load`; all but the first have no effect on a robot that was loaded.

    Raises:
        RobotNotFound, CannotExpand, MissingExtra: See `eurdf.load`.
    """
    built: Robot | None = None
    if isinstance(robot, SOURCES):
        places = {"confined": confined, "allow_outside": allow_outside}
        options: Any = {"package_dirs": package_dirs, "xacro_args": xacro_args, **places}
        path, diagnostics = display_name(robot), check(robot, urdf, **options).diagnostics
        if not any(is_stream(given) for given in (robot, urdf) if given is not None):
            with suppress(InvalidRobot):
                built = load(robot, urdf, geometry=False, **options)
    else:
        path, diagnostics, built = robot.mechanism.name, robot.diagnostics, robot
    facts = {} if built is None else _facts(built)
    by_subject: dict[Subject, list[Cause]] = {}
    for found in diagnostics:
        cause = Cause(found.code, str(found.place), found.message, found.hint, found.fix is not None)
        by_subject.setdefault(_subject(found.code), []).append(cause)
    topics = (Topic(each, tuple(facts.get(each, ())), tuple(by_subject.get(each, ()))) for each in get_args(Subject))
    return Explanation(path, tuple(each for each in topics if each.facts or each.causes), diagnostics)


def _subject(code: str) -> Subject:
    of_values = REGISTRY[code].phase in (Phase.INERTIA, Phase.ADVICE)
    return _SUBJECTS.get(code, "values" if of_values else "files")


def _facts(robot: Robot) -> dict[Subject, list[str]]:
    """How a robot is, by subject."""
    from eurdf.kinematics.analysis import analyze  # only now: what cannot be built is explained without a simulator

    analysis = analyze(robot)
    if analysis.mobility is None:
        least = f"no configuration was found that closes them; the least residual is {analysis.residual:.3g} (m, rad)"
        return {"loops": [analysis.left_out or least]}
    kinds = {"closure": robot.mechanism.closures, "coupling": robot.mechanism.couplings}
    counted = " and ".join(plural(len(kind), noun) for noun, kind in kinds.items() if kind)
    groups = plural(len(analysis.loops), "independent group")
    of_all = f"{analysis.redundant} of {plural(analysis.nc, 'constraint row')} redundant"
    closed = f"{counted} in {groups} can be closed, to {analysis.residual:.1e} (m, rad); {of_all}"
    found: dict[Subject, list[str]] = {"loops": [closed if counted else "there is no loop: the robot is a tree"]}
    found["motions"] = [*_of_motions(robot, analysis)]
    if analysis.actuated:
        dependent = [f"{enumerated(names)} cannot move independently" for names in analysis.dependent_actuators]
        found["actuators"] = dependent or ["no actuator depends on the others"]
    return found


def _of_motions(robot: Robot, analysis: Analysis) -> Iterator[str]:
    from eurdf.advice.passive import PassiveMotions

    yield f"{plural(analysis.mobility or 0, 'motion')}, of which the actuators decide {analysis.controlled}"
    if not analysis.uncontrolled:
        return
    needing = [motion.joints for motion in PassiveMotions(robot).all_needing_actuators(analysis)]
    others = [motion.joints for motion in analysis.motions if motion.joints not in needing]
    yield f"{plural(analysis.uncontrolled, 'motion')} that no actuator decides, of which {len(needing)} would need one"
    for kind, what in ((needing, "needs an actuator, or a closure that stops it"), (others, "needs no actuator")):
        motions = list(dict.fromkeys(kind))
        yield from (f"the motion of {enumerated(joints)} {what}" for joints in motions[:_LISTED])
        if len(motions) > _LISTED:
            yield f"{len(motions) - _LISTED} more motions like it"
