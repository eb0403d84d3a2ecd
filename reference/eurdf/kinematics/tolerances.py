"""Thresholds of the solvers: what each bounds, and in which unit.

Scaled residuals, steps and motions are dimensionless: angles in rad, lengths in characteristic lengths of the loops.
"""

from __future__ import annotations

from eurdf.closures import CLOSED as CLOSED

# How far loops are open: rows of the residual, m or rad.

# `CLOSED`: A closure that is open by no more than this counts as closed (EU-CLO-005).
#: A residual of this norm, in m and rad and dimensionless, is of closed loops for certain: how far a closure is open
#: differs from its rows by a factor below 10.
WELL_CLOSED = 0.1 * CLOSED
#: In robots with a smaller characteristic length, m, what counts as closed is less in proportion. In larger ones it is
#: not: rounded numbers in files keep loops of ordinary robots open by 1e-7 m and more.
SMALL = 0.01
#: Bound that solvers bring the loops to.
SOLVED = 1e-10
#: The same on a path whose last correction leaves rounding.
FOLLOWED = 1e-11
#: The same of poses that paths start from, or lead to.
START = 1e-12
#: The same of steps on a branch, where the Jacobian is that from before the step.
BRANCH = 1e-13
#: A step on a branch is too long if it leaves a larger row of the residual, m or rad, unless it was as large before.
KEPT = 1e-9
#: A correction below this, dimensionless, is rounding, though redundant rows that contradict each other stay open.
ROUNDED_CORRECTION = 1e-14
#: A motion continues if it keeps this residual, dimensionless, or ten times that at its start.
CONTINUED = 1e-11
#: Loops with a larger residual, dimensionless, are not open by the rounding of numbers in files: three decimals.
FILE_ROUNDING = 1e-3

# Descents.

#: Bound of the steps of one descent.
MOST_STEPS = 60
#: A descent gives up after this many consecutive idle steps: steps that each reduce the squared residual, or error, by
#: less than a fraction.
MOST_IDLE_STEPS = 6
IDLE = 0.02
#: A descent ends where the expected reduction of the next step is below this fraction of the square.
LEAST_GAIN = 1e-12
#: Damping at the start and at least, relative to the square.
FIRST_DAMPING = 1e-3
LEAST_DAMPING = 1e-8
#: A step that is not accepted makes the damping this many times as large.
MORE_DAMPING = 8.0
#: A step is accepted if it reduces the square by more than this fraction of what was expected; ...
LEAST_SHARE = 0.01
#: ... the damping becomes a tenth above the first and four times as large below the second fraction.
GOOD_SHARE = 0.75
POOR_SHARE = 0.25

#: Restarts of a group of loops that stays open, unless a caller gives their number.
RESTARTS = 20
#: Bound of the multiplications in the steps of one assembly, about five seconds. Groups with hundreds of shared joints
#: end before all restarts; a group with a single step above this bound is not tried.
MOST_WORK = 1e10
#: Above this many velocities, all loops with one damping take longer than each group of loops with its own.
MOST_VELOCITIES_AT_ONCE = 60
#: From so many groups of loops on that are alike, computing them together takes less time than each alone.
MANY_ALIKE = 3

# Steps along a path.

#: A step is accepted if closing the loops after it moves the joints by this fraction of it at most, ...
MOST_CORRECTION = 0.25
#: ... or by this much, dimensionless.
LEAST_CORRECTION = 1e-6
#: If not, the step is halved, down to this fraction of the path.
SHORTEST_STEP = 2.0**-10
#: Bound of the motion of each joint in one step, dimensionless.
LONGEST_MOTION = 0.5
#: A direction counts as blocked if the other joints would have to move this many times faster than the given ones.
FASTEST = 1e6
#: A mechanism is at a dead point if the smallest singular value of K_p is below this fraction of the largest one met:
#: forces are multiplied by a hundred there, and play and rounding decide which branch it takes.
DEAD = 0.01
#: Largest difference, dimensionless, of configurations that count as the same.
SAME = 1e-6
#: A unit motion moves a joint if it does so by more than this.
MOVES = 1e-6

# Dynamics.

#: Residuals (m, rad), and the norm of their rates relative to 1 plus that of v, up to which closures count as closed
#: for forces. Such a residual changes the acceleration as much as what Pinocchio's solver leaves out.
CLOSED_FOR_FORCES = 1e-9
#: Accepted error of Pinocchio's solver in either equation, relative to the largest term.
FORCES_SOLVED = 1e-9
#: An inertia below this, relative to the largest one of a free motion, counts as zero.
MASSLESS = 1e-14
#: Velocities above this, rad/s or m/s, count as divergence of a simulation.
DIVERGED = 1e9

# Ranks, relative to the largest singular value or to the norm of a dimensionless matrix.

#: Singular values below this are rounding and do not affect the rank.
FLOOR = 1e-9
#: A matrix scaled to one unit has entries of about 1; if no singular value exceeds this, all of them are rounding.
NOTHING = 1e-12
#: A singular value above this fraction of the norm counts for certain: `numerical_rank` counts all above 3.2e-5. The
#: normal equations then lose half of the digits, and one refinement regains them.
CERTAIN = 1e-4
#: A singular value below this is zero for certain, as that of a redundant row.
ZERO = 1e-12
#: Largest part of b, relative to it, that A x may miss, if the rows of A are redundant.
MISSED = 1e-10
