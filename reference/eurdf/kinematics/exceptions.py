"""What the kinematics and dynamics of a closed mechanism raise."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from eurdf.exceptions import EurdfError

if TYPE_CHECKING:
    from eurdf.kinematics.array import Vector
    from eurdf.kinematics.residual import Opening


class CannotLock(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A joint that cannot be locked.

    Attributes:
        joint: Its name, as the caller gave it.
        reason: Why not.
        leader: The joint to lock in its place, where it follows one; else None.
    """

    def __init__(self, joint: str, reason: str, leader: str | None = None) -> None:
        self.joint = joint
        self.reason = reason
        self.leader = leader
        super().__init__(f"joint '{joint}' cannot be locked: {reason}")


class LockedOpen(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """Closures that locked joints would hold open.

    Attributes:
        openings: How far each of them is open.
        tolerance: What each row of their residual may be, m or rad.
    """

    def __init__(self, openings: tuple[Opening, ...], tolerance: float) -> None:
        self.openings = openings
        self.tolerance = tolerance
        apart = ", ".join(map(str, openings))
        super().__init__(
            f"locked there, closures stay open: {apart}; each row of their residual may be {tolerance:g} m or rad"
        )


class NotClosable(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """Loops that were not closed as asked.

    Attributes:
        openings: How far each closure is open, at the least open configuration found.
        q: That configuration (nq,).
    """

    def __init__(self, reason: str, openings: tuple[Opening, ...], q: Vector) -> None:
        self.openings = openings
        self.q = q
        apart = ", ".join(str(found) for found in openings if found.is_open)
        super().__init__(f"{reason}: closures stay open, {apart}" if apart else reason)


class DependentActuators(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """Actuated joints that the closures do not let move independently of one another.

    Attributes:
        joints: Those of them that depend on others, or cannot move at all.
        actuated: Number of actuated velocities, nu.
        rank: Number of independent ones.
    """

    def __init__(self, joints: tuple[str, ...], actuated: int, rank: int) -> None:
        self.joints = joints
        self.actuated = actuated
        self.rank = rank
        names = ", ".join(f"'{name}'" for name in joints)
        super().__init__(
            f"of {actuated} actuated velocities only {rank} are independent in the closed mechanism; "
            f"the loops tie together or hold {names}"
        )


class InconsistentMotion(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A velocity or an acceleration that would open closures.

    Attributes:
        order: ``velocity`` or ``acceleration``.
        opening: For each closure that would open, the rows of K v or of K a + K̇ v, in m and rad over s or s².
    """

    def __init__(self, order: str, opening: Mapping[str, tuple[float, ...]]) -> None:
        self.order = order
        self.opening = opening
        closures = ", ".join(f"'{name}' by {math.hypot(*rows):.3g}" for name, rows in opening.items())
        unit = {"velocity": "m/s and rad/s", "acceleration": "m/s² and rad/s²"}[order]
        super().__init__(f"the {order} opens closures: {closures} ({unit}); it can be projected onto them")


class UnderactuatedMotion(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """A motion that the motors cannot make.

    Attributes:
        missing: For each joint that moves though every motor is held, the generalized force that would have to act on
            it as well, N·m and N.
        deviation: By how much the acceleration that the motors can make differs, in its largest component, rad/s² or
            characteristic lengths/s²; inf where what has no inertia would have to take a force.
    """

    def __init__(self, missing: Mapping[str, tuple[float, ...]], deviation: float) -> None:
        self.missing = missing
        self.deviation = deviation
        joints = ", ".join(f"'{name}' {math.hypot(*force):.3g}" for name, force in missing.items())
        super().__init__(f"the motors cannot make this motion: forces are missing at joints that none moves: {joints}")


class UndeterminedMotion(EurdfError, ValueError):  # noqa: N818 - part of the public interface
    """Something without inertia can move, so that no acceleration follows from the forces.

    Attributes:
        joints: Names of the joints that such a motion moves.
    """

    def __init__(self, joints: tuple[str, ...]) -> None:
        self.joints = joints
        named = ", ".join(f"'{name}'" for name in joints)
        super().__init__(f"no acceleration follows from the forces: what moves has no inertia at joints {named}")


class SimulationDiverged(EurdfError, ArithmeticError):  # noqa: N818 - part of the public interface
    """A simulation whose steps are too long for the motion.

    Attributes:
        t: Time at which it came to no number any more, s.
        step: Time of a step, s.
    """

    def __init__(self, t: float, step: float) -> None:
        self.t = t
        self.step = step
        super().__init__(f"the simulation diverges at {t:.6g} s: its steps of {step:g} s are too long for the motion")
