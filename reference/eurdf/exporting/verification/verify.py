"""Whether an exported file is the robot: what a program reads of it, against what it was written from."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec

import numpy as np

from eurdf.dataclass import dataclass
from eurdf.diagnostics.extras import install_command
from eurdf.exceptions import MissingExtra
from eurdf.exporting.coordinates import Coordinates, Vector
from eurdf.exporting.verification.fall import Fall, Motion, joint_of_velocity, listed, simulate, size
from eurdf.exporting.verification.finding import Finding
from eurdf.exporting.verification.read_model import CannotRead, Exported, Range, ReadModel, without_armature
from eurdf.kinematics.mass_matrix import mass_matrix
from eurdf.kinematics.opening import Opening
from eurdf.loss import Effect, Loss
from eurdf.pinocchio.robot import Robot
from eurdf.writing.output_folder import write_files

#: The packages and extras that read each format; what is empty needs none.
_NEEDS = {
    "mjcf": ("mujoco", "mujoco"),
    "usd": ("pxr", "usd"),
    "drake": ("pydrake", "drake"),
    "sdf": ("pydrake", "drake"),
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
        mass_matrix_error: Largest difference of M at the start, relative to its largest entry. Armature that is listed
            as a loss is left out of the robot's.
        openings: How far each closure, coupling and mimic joint of the file is open at the start.
        beyond_limits: Coordinates that are beyond their limits at the start.
        fall: The simulation; None if the program simulates nothing.
        findings: What is wrong; empty if nothing is.
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
    unverified: tuple[str, ...] = ()


def require_reader(to: str) -> None:
    """Check that what reads a format is installed.

    Args:
        to: Name of the format.

    Raises:
        MissingExtra: It is not.
    """
    package, extra = _NEEDS.get(to, ("", ""))
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
        exported = Exported(write_files(folder, files)[0], robot, coordinates)
        try:
            model = _reads(to)(exported)
        except CannotRead as refusal:
            finding = Finding(f"{refusal.reader} refuses the file: {refusal}")
            return Verification(refusal.reader, str(refusal), findings=(finding,))
        return _compare(model, exported, losses, start, seconds, progress)


def _reads(to: str) -> Callable[[Exported], ReadModel]:
    """What reads a format."""
    if to == "mjcf":
        from eurdf.exporting.verification.mujoco_model import MuJoCoModel

        return MuJoCoModel
    if to in ("drake", "sdf"):
        from eurdf.exporting.verification.drake_model import DrakeModel, SdfTree

        return DrakeModel if to == "drake" else SdfTree
    if to == "usd":
        from eurdf.exporting.verification.usd_model import UsdModel

        return UsdModel
    from eurdf.exporting.verification.pinocchio_model import PinocchioModel

    return PinocchioModel


def _compare(
    model: ReadModel,
    exported: Exported,
    losses: Sequence[Loss],
    start: Vector,
    seconds: float,
    progress: Callable[[float, float], None] | None,
) -> Verification:
    robot = exported.robot
    findings: list[Finding] = []
    masses = [body.inertia.mass for body in robot.mechanism.bodies if body.inertia is not None]
    mass = model.mass, sum(masses)
    if abs(mass[0] - mass[1]) > model.mass_tolerance * (mass[1] or 1.0):
        findings.append(Finding(f"the mass is {mass[0]:g} kg, not {mass[1]:g} kg"))
    error, wrong = _mass_matrix(model, robot, losses, start)
    findings += wrong
    openings = model.openings(start)
    opened = sorted((each for each in openings if size(each) > model.tolerance), key=size, reverse=True)
    if opened:
        message = f"constraints are open at the start: {listed([str(each) for each in opened])}"
        hint = "find a closed configuration with `eurdf assemble`, and state it as 'assembled'"
        findings.append(Finding(message, (hint,)))
    beyond = tuple(
        each for each in model.ranges(start) if not each.lower - _AT_LIMIT <= each.value <= each.upper + _AT_LIMIT
    )
    for each in beyond:
        limits = f"{each.lower:.6g} to {each.upper:.6g}"
        where = f"at the start, '{each.joint}' is at {each.value:.6g}, outside its limits, {limits}"
        findings.append(Finding(where, ("a simulator pushes it back",)))
    fall, unverified = None, model.unverified
    if model.step and opened:
        unverified += ("the fall is not simulated, since constraints are open at the start",)
    elif model.step and seconds:
        fall, moved = simulate(model, Motion(robot, exported.coordinates, start), seconds, progress)
        findings += [moved] if moved else []
    return Verification(model.reader, "", mass, error, openings, beyond, fall, tuple(findings), unverified)


def _mass_matrix(model: ReadModel, robot: Robot, losses: Sequence[Loss], q: Vector) -> tuple[float, list[Finding]]:
    """The largest relative difference of M, and whether it is too large."""
    lost = [loss.name for loss in losses if loss.code == "export-armature" and loss.effect is Effect.DROPPED]
    expected = mass_matrix(without_armature(robot, lost) if lost else robot, q)
    if not expected.size:
        return 0.0, []
    found = model.mass_matrix(q)
    difference = np.abs(found - expected)
    error = float(difference.max() / (np.abs(expected).max() or 1.0))
    if error <= model.mass_tolerance:
        return error, []
    at = int(np.diag(difference).argmax())
    name = joint_of_velocity(robot)[at]
    causes = [f"on its diagonal, '{name}' differs most: {found[at, at]:.6g}, not {expected[at, at]:.6g}"]
    changed = [loss for loss in losses if loss.code == "export-inertia"]
    if changed:
        links = f"{len(changed)} link{'s' * (len(changed) > 1)}"
        causes.append(f"the format changes the inertia of {links}: see the losses [export-inertia]; {changed[0].hint}")
    return error, [Finding(f"the mass matrix differs by {error:.1e} of its largest entry", tuple(causes))]
