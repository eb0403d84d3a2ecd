"""The state of a robot that is looked at: its configuration, what moves it, and why a motion stops.

Knows no viewer, so that what happens on a page can be tested without one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eurdf.array import Vector
from eurdf.kinematics.analysis import Analysis, analyze
from eurdf.kinematics.assembly import Assembly, assemble
from eurdf.kinematics.branch import Branch, BranchPoint
from eurdf.kinematics.closing import start
from eurdf.kinematics.inverse import inverse_kinematics
from eurdf.kinematics.named import Named, configuration_of
from eurdf.kinematics.path import Elements, follow
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.rank import Numbers
from eurdf.kinematics.residual import residual
from eurdf.kinematics.sweep import sweep
from eurdf.kinematics.tolerances import CLOSED, DEAD, START
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.transmissions.selection import selection
from eurdf.viewing.sliders import LONGEST, NAMES, ROTATION, Slider, motions, sliders_of, values_at
from eurdf.viewing.spring_rest import SpringRest

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: The configuration to start at, if the description has it.
ASSEMBLED = "assembled"

# Steps are halved down to this fraction of the range of a slider.
_SHORTEST_STEP = 2.0**-22
# Corrections of a last step to the limit of a passive joint.
_TO_LIMIT = 8
# Steps of a slider over its range, for a robot with springs; they are halved down to this fraction of one.
_REST_STEPS = 40
_SHORTEST_REST_STEP = 2.0**-12
# Longest step of a coordinate of a pose, as a part of the range of its slider.
_POSE_STEP = 1.0 / 40.0


@dataclass(frozen=True, slots=True)
class MotionStop:
    """Why a motion did not reach where it was to go.

    Attributes:
        reason: The limit of the joint that was moved; half a turn, which a rotation vector does not exceed; the limit
            of a passive joint; a dead point (singular configuration); no motion that keeps the loops closed.
        joint: The joint at its limit; else the one that was moved.
        value: Its coordinate, rad or m.
    """

    reason: Literal["limit", "half turn", "passive limit", "dead point", "blocked"]
    joint: str
    value: float

    def __str__(self) -> str:
        sentences = {
            "limit": f"'{self.joint}' is at its position limit {self.value:.6g}",
            "half turn": f"'{self.joint}' is half a turn from its neutral configuration, at {self.value:.6g}",
            "passive limit": f"passive joint '{self.joint}' is at its position limit {self.value:.6g}",
            "dead point": f"dead point: at {self.value:.6g}, '{self.joint}' no longer determines the passive joints",
            "blocked": f"the loops block '{self.joint}': it cannot move with the other actuators held",
        }
        return sentences[self.reason]


class Session:
    """A robot at a configuration.

    Attributes:
        robot: The robot.
        q: The configuration (nq,).
        first: The configuration (nq,) that `reset` returns to.
        configurations: The named configurations (nq,): those of the description, and those saved since.
        analysis: Its dimensions, at the first configuration.
        sliders: What the user can move: the coordinates of the actuators; of all joints if there are no actuators.
    """

    def __init__(self, robot: Robot, q: Named | None = None) -> None:
        """Start at q; by default at ``assembled``, or at a closed configuration that is found.

        Raises:
            ValueError: ``q`` is not a configuration.
        """
        self.robot = robot
        assembly = assemble(robot, start(robot, q, "q"), tolerance=START)
        self.q: Vector = assembly.q
        self.first: Vector = assembly.q
        self.configurations: dict[str, Vector] = dict(robot.configurations)
        self.analysis: Analysis = analyze(robot, assembly.q)
        self._limits = position_limits(robot)
        self.sliders = tuple(sliders_of(robot, self.first, self.analysis))
        self._branches: dict[int, Branch] = {}
        self._largest: dict[int, float] = {}

    @property
    def residual(self) -> float:
        """Largest row of the residual of the constraints, m or rad."""
        return float(np.abs(residual(self.robot, self.q)).max(initial=0.0))

    @property
    def is_closed(self) -> bool:
        """Whether the loops are closed."""
        return self.residual <= CLOSED

    def value(self, index: int) -> float:
        """The coordinate of a slider, rad or m; the angle of a joint without limits is from -pi to pi."""
        slider = self.sliders[index]
        values = (
            self._pose(slider, self.q) if slider.velocity is None else selection(self.robot, slider.joint).read(self.q)
        )
        return float(values[slider.number])

    def move(self, index: int, value: float) -> MotionStop | None:
        """Move a coordinate; the passive joints follow on the same branch.

        If the loops are open, the coordinate moves alone.

        Args:
            index: Of the slider.
            value: Where to move it, rad or m.

        Returns:
            Why it stopped before, or None.

        Raises:
            ValueError: The value is not finite.
        """
        slider = self.sliders[index]
        if not math.isfinite(value):
            raise ValueError(f"'{slider.joint}' cannot move to {value}")
        at, stop = self.value(index), None
        goal = min(max(value, slider.lower), slider.upper)
        if goal != value:
            stop = MotionStop("limit", slider.joint, goal)
        if slider.velocity is not None:
            self.q, stopped = self._moved(self.q, slider, slider.velocity, at, goal - at)
            return stopped or stop
        longest = self._longest(slider)
        if abs(goal) > longest:
            goal = math.copysign(longest, goal)
            stop = MotionStop("half turn", slider.joint, goal)
        stopped = self._move_pose(slider, at, goal)
        if stopped and stopped.joint == slider.joint:
            stopped = replace(stopped, value=self.value(index))
        return stopped or stop

    def show(self, q: Named) -> None:
        """Go to a configuration, closed or not.

        Raises:
            ValueError: ``q`` does not have the shape (nq,), or is not finite.
        """
        self.q = np.array(configuration_of(self.robot, q))

    def reset(self) -> None:
        """Go to the first configuration."""
        self.q = self.first

    def assemble(self) -> Assembly:
        """Close the loops near the configuration, within the position limits of all joints if possible."""
        within = assemble(self.robot, self._limits.clip(self.q), tolerance=START, limits=True)
        found = within if within.closes else assemble(self.robot, self.q, tolerance=START)
        self.q = found.q
        return found

    def drag(self, frame: str, target: Any) -> str | None:
        """Bring a frame as near to a target as the closed loops and the position limits allow.

        Args:
            frame: Name of a link, joint or frame.
            target: A pose in the world (`pin.SE3`), or a position (3,), m.

        Returns:
            Why it is not at the target, or None.
        """
        found = inverse_kinematics(self.robot, {frame: target}, self.q, restarts=0, tolerance=1e-6)
        if found.reason != "closures open":
            self.q = found.q
        if found.converged:
            return None
        limits = f" ({', '.join(map(str, found.at_limits))})" if found.at_limits else ""
        return f"{found.reason}{limits}: {', '.join(map(str, found.errors))} off target"

    def carried_to(self, robot: Robot) -> Vector:
        """The configuration of another version of the robot in which its joints are where they are here."""
        names = {joint.name: len(joint.type.coordinates) for joint in robot.mechanism.joints if joint.mimic is None}
        here = self.robot.joint_positions(self.q)
        kept = {name: values for name, values in here.items() if names.get(name) == len(values)}
        root = {name: here[name] for name in (ROOT_JOINT,) if name in here and robot.mechanism.root == "floating"}
        return robot.configuration({**kept, **root})

    def sweep(self, index: int, steps: int = 60) -> tuple[list[Vector], str]:
        """The range of motion of an actuator: from the configuration to one end, to the other and back.

        Returns:
            The configurations, and what ends the two paths.

        Raises:
            NotClosable: The loops do not close.
            ValueError: It is not an actuator with one coordinate.
        """
        found = sweep(self.robot, self.sliders[index].joint, self.q, steps=steps)
        lower, upper = (list(path.configurations) for path in (found.lower, found.upper))
        ends = " and ".join(
            path.end + (f" of '{path.joint}'" if path.joint else "") + f" at {path.reached:.4g}"
            for path in (found.lower, found.upper)
        )
        return [*lower, *reversed(lower), *upper, *reversed(upper)], ends

    def _pose(self, slider: Slider, q: Vector) -> Vector:
        """The coordinates of the pose of a slider's joint."""
        slot = self.robot.slots[slider.joint]
        return values_at(slot.joint.type, q[slot.idx_q : slot.idx_q + slot.nq])

    def _longest(self, slider: Slider) -> float:
        """How far from zero a coordinate of a pose can be."""
        names = NAMES[self.robot.slots[slider.joint].joint.type]
        if names[slider.number] not in ROTATION:
            return math.inf
        pose = self._pose(slider, self.q)
        others = [pose[number] for number, name in enumerate(names) if name in ROTATION and number != slider.number]
        return math.sqrt(max(0.0, LONGEST**2 - sum(value**2 for value in others)))

    def _move_pose(self, slider: Slider, at: float, goal: float) -> MotionStop | None:
        """Move a coordinate of a pose, the others held, in steps of several velocities one after the other."""
        slot = self.robot.slots[slider.joint]
        longest, pose = _POSE_STEP * (slider.upper - slider.lower), self._pose(slider, self.q)
        shortest, stop = _SHORTEST_STEP * (slider.upper - slider.lower), None
        while at != goal:
            part = math.copysign(min(abs(goal - at), longest), goal - at)
            there = goal if part == goal - at else at + part
            q, pose[slider.number] = self.q, there
            for number, amount in motions(slot.joint.type, self._pose(slider, q), pose):
                q, stopped = self._moved(q, slider, slot.idx_v + number, at, amount)
                if stopped:
                    break
            else:
                self.q, at = q, there
                continue
            stop = stopped
            longest = 0.5 * abs(part)  # toward the end, and no longer again
            if longest < shortest:
                break
        return stop

    def _moved(
        self, q: Vector, slider: Slider, velocity: int, begin: float, distance: float
    ) -> tuple[Vector, MotionStop | None]:
        """Move one velocity by a distance, rad or m; where it ends, and why.

        Args:
            q: Where it begins (nq,).
            slider: The slider that moves it.
            velocity: Index in v.
            begin: Where the slider begins.
            distance: How far.
        """
        if not self.is_closed:
            v = np.zeros(self.robot.tree.nv)
            v[velocity] = distance
            return self.robot.tree.integrate(q, v), None
        sprung = len(self.robot.tree.springs) and len(self.robot.actuation.idx_q)
        return (self._follow_at_rest if sprung else self._follow)(q, slider, velocity, begin, distance)

    def _follow(
        self, q: Vector, slider: Slider, velocity: int, begin: float, distance: float
    ) -> tuple[Vector, MotionStop | None]:
        """As `_moved`, from a closed configuration."""
        branch = self._branch(slider, velocity)
        here = branch.at(q)
        largest, stop = max(self._largest.get(velocity, 0.0), here.smallest), None

        def advance(_: Elements, done: Numbers, h: Numbers) -> tuple[Numbers, Numbers]:
            nonlocal here, largest, stop
            part = h * distance
            there = branch.step(here, part)
            if there is None:
                return h, False
            if branch.passive_limit(here, there) is not None:
                here, stop = self._to_limit(branch, here, part)
            elif there.rank != here.rank or (there.smallest < here.smallest and there.smallest < DEAD * largest):
                stop = self._dead_point(slider, begin + done * distance, done == 0.0)
            if stop is not None:
                return 0.0, False
            here, largest = there, max(largest, there.smallest)
            return h, True

        done = 1.0
        if distance:
            shortest = 0.5 * _SHORTEST_STEP * (slider.upper - slider.lower) / abs(distance)
            done = follow(advance, shortest=min(shortest, 1.0))[0]
        if done < 1.0 and stop is None:
            stop = self._dead_point(slider, begin + done * distance, done == 0.0)
        self._largest[velocity] = largest if math.isfinite(largest) else 0.0
        return here.q, stop

    def _dead_point(self, slider: Slider, at: float, at_once: bool) -> MotionStop:
        blocked = at_once and any(slider.joint in each for each in self.analysis.dependent_actuators)
        return MotionStop("blocked" if blocked else "dead point", slider.joint, at)

    def _to_limit(self, branch: Branch, here: BranchPoint, part: float) -> tuple[BranchPoint, MotionStop]:
        """The last point before a passive joint exceeds its limit, on a step that does."""
        joint = ""
        for _ in range(_TO_LIMIT):
            there = branch.step(here, part) if part else None  # it is at its limit already
            met = branch.passive_limit(here, there) if there else None
            if met is None:
                break
            joint, until = met
            nearer = branch.step(here, part * until) if part * until else None
            if nearer is not None and branch.passive_limit(here, nearer) is None:
                here, part = nearer, part * (1.0 - until)
            else:
                part *= until
        return here, self._at_limit(self._limits.joints.index(joint), here.q)

    def _at_limit(self, index: int, q: Vector) -> MotionStop:
        """The stop at the limit of the joint with this velocity."""
        at = float(q[self._limits.coordinates[index]])
        lower, upper = float(self._limits.lower[index]), float(self._limits.upper[index])
        return MotionStop(
            "passive limit", self._limits.joints[index], lower if abs(at - lower) < abs(at - upper) else upper
        )

    def _follow_at_rest(
        self, q: Vector, slider: Slider, velocity: int, begin: float, distance: float
    ) -> tuple[Vector, MotionStop | None]:
        """As `_follow`, for a robot whose springs decide what the actuators do not: it is at rest after each step."""
        tree = self.robot.tree
        rest = SpringRest(self.robot, self._branch(slider, velocity).passive)
        longest = (slider.upper - slider.lower) / _REST_STEPS / abs(distance) if distance else 1.0
        pressed: tuple[int, ...] = ()
        met: list[int] = []

        def advance(_: Elements, done: Numbers, h: Numbers) -> tuple[Numbers, Numbers]:
            nonlocal q, pressed, met
            h = min(h, longest)
            v = np.zeros(tree.nv)
            v[velocity] = h * distance
            there = rest.near(tree.integrate(q, v))
            met = [each for each in there.pressed if each not in pressed]
            if there.q is not None:
                q, pressed = there.q, there.pressed
            return h, there.q is not None

        done = follow(advance, shortest=min(_SHORTEST_REST_STEP * longest, 1.0))[0] if distance else 1.0
        if done == 1.0:
            return q, None
        return q, self._at_limit(met[0], q) if met else MotionStop("dead point", slider.joint, begin + done * distance)

    def _branch(self, slider: Slider, velocity: int) -> Branch:
        if velocity not in self._branches:
            follow = {each for joint in slider.follow for each in self.robot.tree.velocities_of(joint)}
            self._branches[velocity] = Branch(self.robot, velocity, self._limits, follow)
        return self._branches[velocity]
