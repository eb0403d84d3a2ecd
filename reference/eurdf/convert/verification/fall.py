"""A simulation of an exported robot that nothing drives: which loops open, when, and why."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.convert.verification.read_model import Diverged, Exported, Finding, Instant, ReadModel
from eurdf.diagnostics import enumerated
from eurdf.kinematics.dynamics import mass_matrix
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.robot import Robot

#: Loops that are named.
_MOST_NAMED = 4

#: An opening above this is reported, m or rad.
OPENS = 5e-3

_BOUND = f"{OPENS * 1e3:g} mm or {np.degrees(OPENS):.2g} degrees"

#: A joint that turns by more than this in a step is too fast for the step, rad or m.
_TOO_FAST = 0.1

#: Part of its value at the start to which a singular value or an eigenvalue falls near a singular pose, and the part of
#: the largest one that counts as zero.
_NEAR, _ZERO = 0.1, 1e-9

#: An overlap of bodies in contact that is reported, m: contacts are soft.
_OVERLAP = 1e-4

#: Steps before the worst one, at which its cause is looked for.
_BEFORE = 20

#: Coordinates of no robot, rad or m.
_BLOWN_UP = 1e6

#: A link of a robot has less, kg.
_HEAVY = 1e5

#: A joint that moves less has no mass to move, kg or kg·m².
_LIGHT = 1e-6


@dataclass(frozen=True, slots=True)
class Fall:
    """A simulation from rest at the start, with gravity and without actuation.

    Attributes:
        seconds: Simulated time, s; less than asked for if it diverges.
        diverged: Whether a number was not finite.
        openings: The largest opening of each closure, coupling and mimic joint of the file.
        times: When each of them was largest, s.
    """

    seconds: float
    diverged: bool
    openings: tuple[Opening, ...]
    times: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """A simulation, and its instants up to the one at which the loops are most open, or the last one if it diverges."""

    fall: Fall
    worst: tuple[Instant, ...]
    message: str

    @property
    def opening(self) -> float:
        return max(map(size, self.fall.openings), default=0.0)

    @property
    def result(self) -> str:
        if self.fall.diverged:
            return f"it diverges at {self.fall.seconds:.3g} s"
        distance, angle = (max((getattr(o, x) for o in self.fall.openings), default=0.0) for x in ("position", "angle"))
        return f"constraints open by up to {amount(Opening('', distance, angle))}"


def simulate(
    model: ReadModel, exported: Exported, seconds: float, progress: Callable[[float, float], None] | None
) -> tuple[Fall, Finding | None]:
    """Simulate a model, and say what is wrong with the motion, and why.

    Returns:
        The simulation, and what is wrong if a loop opens by more than `OPENS` or the simulation diverges.
    """
    run = _run(model.fall(exported.start, seconds), seconds, progress)
    if not (run.fall.diverged or run.opening > OPENS):
        return run.fall, None
    largest = sorted(
        zip(run.fall.openings, run.fall.times, strict=True), key=lambda found: size(found[0]), reverse=True
    )
    opened = [f"{each} at {time:.3g} s" for each, time in largest if size(each) > OPENS]
    said = f" ({run.message})" if run.message else ""
    what = [f"the simulation diverges at {run.fall.seconds:.3g} s{said}"] if run.fall.diverged else []
    if opened:
        what.append(f"constraints open by more than {_BOUND} in the fall: {listed(opened)}")
    halved = _run(model.fall(exported.start, seconds, slower=2), seconds, progress)
    helps = f"; {model.shorter}" if not halved.fall.diverged and halved.opening <= OPENS else ""
    again = [f"with half the time step, {model.step / 2:g} s, {halved.result}{helps}"]
    if any(each.contact for each in run.worst):
        free = _run(model.fall(exported.start, seconds, contacts=False), seconds, progress)
        closed = not free.fall.diverged and free.opening < run.opening / 2.0
        helps = "; leave out contacts of links that overlap, or simplify their collision shapes" if closed else ""
        again.append(f"without contacts, {free.result}{helps}")
    # Where a simulation has blown up, poses say nothing.
    worst = [each for each in run.worst if np.abs(each.positions).max(initial=0.0) < _BLOWN_UP]
    causes = _causes(model, exported, worst) if worst else ()
    return run.fall, Finding("; ".join(what), (*causes, *again))


def _run(instants: Iterator[Instant], seconds: float, progress: Callable[[float, float], None] | None) -> _Run:
    openings: list[Opening] = []
    times: list[float] = []
    recent: deque[Instant] = deque(maxlen=_BEFORE)
    worst: tuple[Instant, ...] = ()
    largest, diverged, message = -1.0, False, ""
    try:
        for instant in instants:
            recent.append(instant)
            if not openings:
                openings, times = list(instant.openings), [instant.time] * len(instant.openings)
            for index, each in enumerate(instant.openings):
                if size(each) > size(openings[index]):
                    openings[index], times[index] = each, instant.time
            now = max(map(size, instant.openings), default=0.0)
            if now > largest:
                largest, worst = now, tuple(recent)
            if progress is not None:
                progress(instant.time, seconds)
    except Diverged as found:
        diverged, message, worst = True, str(found), tuple(recent)
    last = recent[-1].time if recent else 0.0
    return _Run(Fall(last, diverged, tuple(openings), tuple(times)), worst, message)


def size(opening: Opening) -> float:
    """Of an opening, the larger of its distance and its angle, m or rad."""
    return max(opening.position, opening.angle)


def amount(opening: Opening) -> str:
    """Distance and angle of an opening, with two digits; the angle only if it is not 0."""
    # Through a number: format codes alone write 540 as 5.4e+02.
    text, angle = (f"{float(f'{each:.2g}'):g}" for each in (opening.position * 1e3, np.degrees(opening.angle)))
    return f"{text} mm and {angle} degrees" if opening.angle else f"{text} mm"


# -- why: only what the run shows -------------------------------------------------------------------------------------


def _causes(model: ReadModel, exported: Exported, worst: Sequence[Instant]) -> Iterator[str]:
    yield from _fast(model, worst)
    contact = max((each.contact for each in worst if each.contact), key=lambda contact: contact[2], default=None)
    if contact is not None and contact[2] > _OVERLAP:
        yield f"{enumerated(contact[:2])} collide, and overlap by {contact[2] * 1e3:.3g} mm"
    yield from _singular(exported, worst)
    yield from _massless(exported, worst)
    for body in exported.robot.mechanism.bodies:
        if body.inertia is not None and body.inertia.mass > _HEAVY:
            yield f"link '{body.name}' has a mass of {body.inertia.mass:.3g} kg; correct it in the URDF"


def _fast(model: ReadModel, worst: Sequence[Instant]) -> Iterator[str]:
    instant = max(worst, key=lambda each: float(np.abs(each.velocities).max(initial=0.0)))
    speeds = np.abs(instant.velocities)
    at = int(speeds.argmax())
    if speeds[at] * model.step > _TOO_FAST:
        name, unit = model.velocities[at]
        yield (
            f"at {instant.time:.4g} s, '{name}' moves at {speeds[at]:.3g} {unit}/s, {speeds[at] * model.step:.2g} "
            f"{unit} in one time step"
        )


def _singular(exported: Exported, worst: Sequence[Instant]) -> Iterator[str]:
    """Whether the passive joints pass a pose at which the actuated ones do not hold them."""
    robot = exported.robot
    columns = {
        at: name for at, name in joint_of_velocity(robot).items() if name not in (ROOT_JOINT, *robot.actuation.joints)
    }
    if not columns or not robot.constraints:
        return

    def decomposed(q: Vector) -> tuple[Vector, Matrix]:
        _, K = residual_and_jacobian(robot, q)
        return np.linalg.svd(K[:, list(columns)])[1:]

    values, _ = decomposed(exported.start)
    rank = int((values > _ZERO * values[0]).sum())
    if not rank:
        return
    found = [(*decomposed(exported.coordinates.from_q(each.positions)), each.time) for each in worst]
    least, directions, time = min(found, key=lambda each: float(each[0][rank - 1]))
    if least[rank - 1] < _NEAR * values[rank - 1]:
        joints = _most(directions[rank - 1], list(columns.values()))
        named = enumerated(joints, len(joints))
        yield (
            f"at {time:.4g} s, the loops are close to a singular pose, at which {named} can move without the "
            "actuated joints: the smallest singular value of the constraint Jacobian of the passive joints is "
            f"{least[rank - 1]:.1e}, {values[rank - 1]:.1e} at the start"
        )
        unlimited = [name for name in joints if not _has_limits(robot, name)]
        without = (
            f"{enumerated(unlimited, len(unlimited))} {'have' if len(unlimited) > 1 else 'has'} no limits; "
            if unlimited
            else ""
        )
        yield without + "limit the joints so that the loops do not get there, or control the actuated joints"


def _massless(exported: Exported, worst: Sequence[Instant]) -> Iterator[str]:
    """Whether joints pass a pose at which they move no mass, as three hinges in gimbal lock."""
    robot = exported.robot
    before = float(np.linalg.eigvalsh(mass_matrix(robot, exported.start))[0])
    found = [
        (*np.linalg.eigh(mass_matrix(robot, exported.coordinates.from_q(each.positions))), each.time) for each in worst
    ]
    values, directions, time = min(found, key=lambda each: float(each[0][0]))
    if values[0] < min(_NEAR * before, _LIGHT):
        joints = _most(directions[:, 0], list(joint_of_velocity(robot).values()))
        named = enumerated(joints, len(joints))
        yield (
            f"at {time:.4g} s, {named} {'move' if len(joints) > 1 else 'moves'} almost no mass: the smallest "
            f"eigenvalue of the mass matrix is {values[0]:.1e}, {before:.1e} at the start; if they are one ball joint, "
            "describe it as 'spherical', else give the links between them their mass"
        )


def joint_of_velocity(robot: Robot) -> dict[int, str]:
    """The joint that has each velocity of a robot, in their order."""
    found = dict.fromkeys(range(robot.model.nv), ROOT_JOINT)
    for name, slot in robot.slots.items():
        found.update(dict.fromkeys(range(slot.idx_v, slot.idx_v + slot.nv), name))
    return found


def _most(direction: Vector, names: Sequence[str]) -> list[str]:
    """The joints that move most in a direction, the fastest first."""
    shares = np.abs(direction)
    return list(dict.fromkeys(names[at] for at in np.argsort(-shares) if shares[at] > 0.5 * shares.max()))


def _has_limits(robot: Robot, name: str) -> bool:
    (joint,) = (joint for joint in robot.mechanism.joints if joint.name == name)
    return bool(np.isfinite(joint.ranges).any())


def listed(found: Sequence[str]) -> str:
    """The first of them, and how many more there are."""
    more = len(found) - _MOST_NAMED
    return ", ".join(found[:_MOST_NAMED]) + (f", and {more} more" if more > 0 else "")
