"""What kinematics asks of a spanning tree: its configurations, poses, Jacobians, mass matrix and bias.

`eurdf.pinocchio.tree.PinocchioTree` implements it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.closures.coupling import Coordinate
from eurdf.mechanism.body import Anchor


class MovingJoint(Protocol):
    """How a joint moves: where its coordinates are neutral, and by its velocities from there."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def parent(self) -> int:
        """Index of its parent."""

    @property
    def placement(self) -> Matrix:
        """Pose (4, 4) of its moving frame in its parent's, where its coordinates are neutral."""

    @property
    def subspace(self) -> Matrix:
        """Motion subspace (6, n) there: rows linear, then angular, in its moving frame."""

    @property
    def nq(self) -> int:
        """Number of its own coordinates: none of one that mimics another."""

    @property
    def idx_q(self) -> int:
        """Index in q of the first coordinate; its leader's if it mimics."""

    @property
    def idx_v(self) -> tuple[int, ...]:
        """Indices (n,) in v of the velocities that move it."""


class Springs(Protocol):
    """Springs, each on one coordinate: n of them."""

    @property
    def idx_v(self) -> Indices:
        """Index (n,) in v of the rate of the coordinate of each spring."""

    @property
    def stiffness(self) -> Vector:
        """Stiffness (n,), N·m/rad or N/m."""

    @property
    def ratio(self) -> Vector:
        """Derivative (n,) of the deflection of each spring by its coordinate."""

    def deflection(self, q: Vector) -> Vector:
        """Distance (n,) of each spring from rest at q (nq,), rad or m."""

    def __len__(self) -> int:
        """Number of springs."""

    def force(self, q: Vector, nv: int) -> Vector:
        """Generalized force (nv,) of the springs at q (nq,), N·m or N."""

    def energy(self, q: Vector) -> float:
        """Energy that the springs store at q (nq,), J."""


class TreeKinematics(Protocol):
    """Kinematics and dynamics of a spanning tree, whose joints are numbered from the root, number 0, to the leaves."""

    @property
    def nq(self) -> int:
        """Number of coordinates."""

    @property
    def nv(self) -> int:
        """Number of velocities."""

    @property
    def parents(self) -> Sequence[int]:
        """Of each joint its parent, which has a lower number."""

    @property
    def own_coordinates(self) -> Sequence[range]:
        """Of each joint the indices in q of its own coordinates."""

    @property
    def own_velocities(self) -> Sequence[range]:
        """Of each joint the indices in v of its own velocities: none of one that mimics another."""

    @property
    def moving_velocities(self) -> Sequence[range]:
        """Of each joint the indices in v of the velocities that move it: its leader's if it mimics."""

    @property
    def reach(self) -> Sequence[float]:
        """Of each joint the distance of its origin from that of its parent at zero, m."""

    @property
    def springs(self) -> Springs:
        """The springs of its joints."""

    def joint_of(self, anchor: Anchor) -> int:
        """The joint that carries an anchor; 0 if nothing moves it."""

    def distance_of(self, anchor: Anchor) -> float:
        """Distance of an anchor from the joint that carries it, m."""

    def translates(self, joint: int) -> Mask:
        """Which of the velocities of a joint only translate, m/s; the others turn, rad/s."""

    def coordinate(self, joint: str) -> Coordinate:
        """The coordinate of a joint that has one of its own.

        Raises:
            ValueError: The joint has none, or several.
        """

    @property
    def velocity_names(self) -> Sequence[str]:
        """For each velocity (nv) the name of its joint."""

    @property
    def position_limits(self) -> tuple[Vector, Vector]:
        """The lower and the upper position limits (nq,) as in the files, both zero where there is no range."""

    @property
    def damping(self) -> Vector:
        """The viscous damping (nv,) of the joints, N·m·s/rad and N·s/m."""

    @property
    def dry_friction(self) -> Vector:
        """The dry friction (nv,) of the joints, N·m and N."""

    @property
    def whole_turns(self) -> Mask:
        """Which velocities (nv,) drive an angle whose whole turns change nothing."""

    def velocities_of(self, joint: str) -> range:
        """The indices in v of the velocities that move a joint: its leader's if it mimics.

        Raises:
            ValueError: The tree has no such joint.
        """

    @property
    def moving_joints(self) -> Sequence[MovingJoint]:
        """The joints but number 0, in order."""

    @property
    def model(self) -> Any:
        """Its `pin.Model`."""

    @property
    def world(self) -> Any:
        """The frame of the world, as `eurdf.pinocchio.tree_few.Site`."""

    @property
    def derived(self) -> dict[Any, Any]:
        """What is computed from the tree and kept with it."""

    def site(self, anchor: Anchor) -> Any:
        """Where an anchor is, as `eurdf.pinocchio.tree_few.Site`."""

    def frame_sites(self, names: Sequence[str]) -> Sequence[Any]:
        """Where frames are. A frame is named by a link, a joint (its frame on the child side), or in the description.

        Raises:
            ValueError: A frame is unknown, or two different frames have this name.
        """

    def memory(self, given: Any = None) -> Any:
        """Memory of the whole tree, which takes some 8 nv³ numbers, and saves time for small trees.

        Args:
            given: Memory that a caller of the package passed; without it, new memory is made.

        Raises:
            ValueError: What was passed is no memory of this tree.
        """

    def neutral(self) -> Vector:
        """The neutral configuration (nq,)."""

    def integrate(self, q: Vector, v: Vector) -> Vector:
        """The configuration (nq,) that v (nv,) leads to from q in unit time, q ⊕ v."""

    def integrate_derivative(self, q: Vector, v: Vector) -> Matrix:
        """Derivative (nv, nv) of q ⊕ v by v."""

    def difference(self, q: Vector, other: Vector) -> Vector:
        """The velocity (nv,) that leads from q to the other configuration in unit time."""

    def difference_derivative(self, q: Vector, other: Vector) -> Matrix:
        """Derivative (nv, nv) of `difference` by the motion of the other configuration."""

    def normalized(self, q: Vector) -> Vector:
        """The configuration with its quaternions, and cosines and sines, of unit length."""

    def is_normalized(self, q: Vector, tolerance: float = 1e-9) -> bool:
        """Whether they are of unit length, to the tolerance."""

    def inverse_dynamics(self, q: Vector, v: Vector, a: Vector, data: Any) -> Vector:
        """The generalized force (nv,) M a + h that the acceleration a (nv,) takes; with a = 0 the bias h."""

    def mass_times(self, q: Vector, motions: Matrix, data: Any) -> Matrix:
        """The mass matrix at q (nq,), the armature included, times the columns (nv, n) of accelerations."""

    def inverse_mass_diagonal(self, q: Vector, data: Any) -> Vector:
        """The diagonal (nv,) of the inverse of the mass matrix at q (nq,), of a tree without mimic joints."""

    def kinetic_energy(self, q: Vector, v: Vector, data: Any) -> float:
        """The kinetic energy at q (nq,) and v (nv,), J, that of the armature included."""

    def potential_energy(self, q: Vector, data: Any) -> float:
        """The potential energy of gravity and springs at q (nq,), J."""


class ConstrainedMotion(Protocol):
    """What a solver of constrained dynamics found, with the terms that it used.

    They are those of M a + h = τ + Jᵀ f and J a = target if the constraints hold and J v = 0. J and f are of bodies A:
    they are -K and -λ.
    """

    @property
    def a(self) -> Vector:
        """Acceleration (nv,)."""

    @property
    def on_a(self) -> Vector:
        """The f (nc,): forces on the bodies A."""

    @property
    def J(self) -> Matrix:  # noqa: N802 - the field's own symbol
        """Minus the derivative of the residual (nc, nv)."""

    @property
    def target(self) -> Vector:
        """What J a has to be (nc,)."""

    @property
    def bias(self) -> Vector:
        """The h (nv,) of the equation."""

    def closed_to(self, position: float) -> bool:
        """Whether each row of the residual is at most ``position``, m or rad."""


class ConstrainedDynamics(Protocol):
    """A solver of the dynamics of a tree with closed constraints, with memory of its own.

    It can be wrong where rows are redundant or joints have no inertia: the caller has to judge its solution.
    """

    def solve(
        self, q: Vector, v: Vector, force: Vector, gains: list[tuple[float, float]], data: Any, is_own: bool
    ) -> ConstrainedMotion:
        """The solution at q (nq,) and v (nv,), which may be not finite.

        Args:
            q: Configuration (nq,).
            v: Velocity (nv,).
            force: Generalized force τ (nv,).
            gains: Baumgarte gains of each constraint: kp, 1/s², and kd, 1/s.
            data: Memory of the whole tree.
            is_own: Whether no other solver of constrained dynamics uses this memory.
        """

    def closures(self, q: Vector, data: Any) -> tuple[Vector, Matrix]:
        """The residual (nc,) at q (nq,), and K (nc, nv), which is its derivative where the closures are closed."""
