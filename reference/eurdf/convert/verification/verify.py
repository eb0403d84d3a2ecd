"""Whether an exported file is the robot: what a program reads of it, against what it was written from."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.util import find_spec

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.convert.common_losses import BEYOND_LIMITS
from eurdf.convert.coordinates import Coordinates
from eurdf.convert.inertia import physical
from eurdf.convert.losses import Effect, Loss
from eurdf.convert.verification.fall import Fall, joint_of_velocity, listed, simulate, size
from eurdf.convert.verification.read_model import CannotRead, Exported, Finding, Range, ReadModel, without_armature
from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra
from eurdf.kinematics.dynamics import mass_matrix
from eurdf.kinematics.opening import Opening
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.writing.output_folder import write_files

#: What reads each format: module here and class; the package that it needs, and the extra that has it, if any.
_READERS = {
    "mjcf": ("mujoco_model", "MuJoCoModel", "mujoco", "mujoco"),
    "usd": ("usd_model", "UsdModel", "pxr", "usd"),
    "drake": ("drake_model", "DrakeModel", "pydrake", "drake"),
    "sdf": ("drake_model", "SdfTree", "pydrake", "drake"),
    "urdf": ("pinocchio_model", "PinocchioModel", "", ""),
    "loop-joint": ("pinocchio_model", "PinocchioModel", "", ""),
}

#: How far a coordinate may be beyond its limits, rad or m: what rounding leaves.
_AT_LIMIT = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """An exported file, read back.

    Attributes:
        reader: The program that read it, and its version.
        refused: What the program says where it refuses the file; then there is nothing below.
        mass: Mass of all bodies as read, and of the robot, kg.
        mass_matrix_error: Largest difference of M at the start, relative to its largest entry. Armature that is dropped
            is left out of the robot's.
        openings: How far each closure, coupling and mimic joint of the file is open at the start.
        beyond_limits: Coordinates that are beyond their limits at the start.
        fall: The simulation; None if the program simulates nothing.
        findings: What is wrong; empty if nothing is.
        listed: What differs as losses say, each a sentence.
        unverified: What this program cannot compare.
    """

    reader: str
    refused: str = ""
    mass: tuple[float, float] = (0.0, 0.0)
    mass_matrix_error: float = 0.0
    openings: tuple[Opening, ...] = ()
    beyond_limits: tuple[Range, ...] = ()
    fall: Fall | None = None
    findings: tuple[Finding, ...] = ()
    listed: tuple[str, ...] = ()
    unverified: tuple[str, ...] = ()


def require_reader(to: str) -> None:
    """Check that what reads a format is installed.

    Args:
        to: Name of the format.

    Raises:
        MissingExtra: It is not.
    """
    _, _, package, extra = _READERS[to]
    if package and find_spec(package) is None:
        raise MissingExtra(f"verifying {to} needs {package}; install it with: {install_command(extra)}", extra)


def verify(
    to: str,
    files: Mapping[str, bytes],
    losses: Sequence[Loss],
    coordinates: Coordinates,
    robot: Robot,
    start: Vector,
    seconds: float,
    progress: Callable[[float, float], None] | None,
) -> Verification:
    """Read an export back, and simulate it; see `Export.verify`."""
    require_reader(to)
    with tempfile.TemporaryDirectory() as folder:
        exported = Exported(write_files(folder, files)[0], robot, coordinates, start)
        module, name, *_ = _READERS[to]
        try:
            model: ReadModel = getattr(import_module(f"eurdf.convert.verification.{module}"), name)(exported)
        except CannotRead as refusal:
            finding = Finding(f"{refusal.reader} refuses the file: {refusal}")
            return Verification(refusal.reader, str(refusal), findings=(finding,))
        return _compare(model, exported, losses, seconds, progress)


def _compare(
    model: ReadModel,
    exported: Exported,
    losses: Sequence[Loss],
    seconds: float,
    progress: Callable[[float, float], None] | None,
) -> Verification:
    robot, start = exported.robot, exported.start
    findings: list[Finding] = []
    masses = [body.inertia.mass for body in robot.mechanism.bodies if body.inertia is not None]
    mass = model.mass, sum(masses)
    if abs(mass[0] - mass[1]) > model.mass_tolerance * (mass[1] or 1.0):
        findings.append(Finding(f"the mass is {mass[0]:g} kg, not {mass[1]:g} kg"))
    error, wrong, as_listed = _mass_matrix(model, exported, losses)
    findings += wrong
    openings = model.openings(start)
    opened = sorted((each for each in openings if size(each) > model.tolerance), key=size, reverse=True)
    if opened:
        message = f"constraints are open at the start: {listed([str(each) for each in opened])}"
        hint = (
            "`eurdf check` shows whether the loops can be closed; if so, find a configuration with `eurdf assemble`, "
            "and state it as 'assembled'"
        )
        findings.append(Finding(message, (hint,)))
    beyond = tuple(
        each for each in model.ranges(start) if not each.lower - _AT_LIMIT <= each.value <= each.upper + _AT_LIMIT
    )
    for each in beyond:
        limits = f"{each.lower:.6g} to {each.upper:.6g}"
        where = f"at the start, '{each.joint}' is at {each.value:.6g}, outside its limits, {limits}"
        findings.append(Finding(where, (f"{BEYOND_LIMITS.error}; {BEYOND_LIMITS.hint}",)))
    fall, unverified = None, model.unverified
    if model.step and opened:
        unverified += ("the fall is not simulated, since constraints are open at the start",)
    elif model.step and seconds:
        fall, moved = simulate(model, exported, seconds, progress)
        findings += [moved] if moved else []
    return Verification(model.reader, "", mass, error, openings, beyond, fall, tuple(findings), as_listed, unverified)


def _mass_matrix(
    model: ReadModel, exported: Exported, losses: Sequence[Loss]
) -> tuple[float, list[Finding], tuple[str, ...]]:
    """The largest relative difference of M; whether it is too large; and which losses it has, each a sentence."""
    reported: list[str] = []
    robot, q = exported.robot, exported.start
    dropped = [loss for loss in losses if loss.code == "export-armature" and loss.effect is Effect.DROPPED]
    if dropped:
        robot = without_armature(robot, [loss.name for loss in dropped])
        without = f"the mass matrices are compared without the armature of {_count(dropped, 'joint')}"
        reported.append(f"{without} [{dropped[0].code}]; {dropped[0].hint}")
    added = np.zeros((robot.model.nv, robot.model.nv))
    if hinged := [loss for loss in losses if loss.code == "export-hinge-armature"]:
        names = [loss.name for loss in hinged]
        added = _of_hinges(exported, names)
        robot = without_armature(robot, names)
        reported.append(
            f"the armature of {_count(hinged, 'joint')} acts on hinges [{hinged[0].code}]; {hinged[0].hint}"
        )
    expected = mass_matrix(robot, q) + added
    if not expected.size:
        return 0.0, [], ()
    found = model.mass_matrix(q)
    error = _difference(found, expected)
    changed = [loss for loss in losses if loss.code == "export-inertia"]
    if error > model.mass_tolerance and changed:
        # What the losses say is no error, and hides no other one.
        expected = mass_matrix(_with_real_inertias(robot, [loss.name for loss in changed]), q) + added
        because = f"the mass matrix differs since the inertia of {_count(changed, 'link')} is changed"
        reported.append(f"{because} [{changed[0].code}]; {changed[0].hint}")
    unexpected = _difference(found, expected)
    if unexpected <= model.mass_tolerance:
        return error, [], tuple(reported)
    at = int(np.diag(np.abs(found - expected)).argmax())
    cause = (
        f"on its diagonal, '{joint_of_velocity(robot)[at]}' differs most: {found[at, at]:.6g}, not "
        f"{expected[at, at]:.6g}"
    )
    message = f"the mass matrix differs by {unexpected:.1e} of its largest entry"
    return error, [Finding(message, (cause,))], tuple(reported)


def _of_hinges(exported: Exported, names: Sequence[str]) -> Matrix:
    """What the armatures of joints whose balls are hinges in the model add to M (nv, nv) at the start."""
    armatures = {joint.name: joint.properties.armature for joint in exported.robot.mechanism.joints}
    T, row = exported.coordinates.rates(exported.start), 0
    found = np.zeros((T.shape[1], T.shape[1]))
    for part in exported.coordinates.parts:
        if part.joint in names:
            rates = T[row : row + part.nv]
            found += rates.T @ np.diag(armatures[part.joint]) @ rates
        row += part.nv
    return found


def _difference(found: Matrix, expected: Matrix) -> float:
    """The largest one, relative to the largest expected entry."""
    return float(np.abs(found - expected).max() / (np.abs(expected).max() or 1.0))


def _with_real_inertias(robot: Robot, names: Sequence[str]) -> Robot:
    """The robot with inertias of some links that a body with volume has, nearest to theirs."""
    bodies = tuple(
        replace(body, inertia=physical(body.inertia, 0.0)[0]) if body.inertia and body.name in names else body
        for body in robot.mechanism.bodies
    )
    return build_robot(replace(robot.mechanism, bodies=bodies), geometry=False)


def _count(losses: Sequence[Loss], what: str) -> str:
    return f"{len(losses)} {what}{'s' * (len(losses) > 1)}"
