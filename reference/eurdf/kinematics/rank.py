"""The numerical rank of a matrix with rounded entries (of arithmetic and of numbers in files)."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector

#: Singular values below this, relative to the largest one, are rounding and do not affect the rank.
FLOOR = 1e-9

#: A matrix scaled to one unit has entries of about 1; if no singular value exceeds this, all of them are rounding.
NOTHING = 1e-12


def numerical_rank(singular_values: Vector, reference: float) -> int:
    """Number of singular values before the widest gap.

    A fixed threshold would have to separate the rounding of numbers in files (an angle given as 1.5708 turns an axis by
    4e-6) from the small singular values of short levers. Instead, the values relative to ``reference``, clipped to
    `FLOOR` from below, are placed between 1 and `FLOOR`, and those before the largest ratio of two consecutive values
    count. A single small value therefore counts if it is above about 3e-5 = √FLOOR.

    Args:
        singular_values: In descending order, of a matrix scaled to one unit.
        reference: The largest singular value of that matrix, or of the one it is a part of.
    """
    if not reference > NOTHING or not len(singular_values):
        return 0
    ladder = np.concatenate(([1.0], np.clip(singular_values / reference, FLOOR, 1.0), [FLOOR]))
    return int(np.argmax(ladder[:-1] / ladder[1:]))


def numerical_ranks(values: Matrix, reference: Vector | None = None) -> Indices:
    """`numerical_rank` of the singular values (B, k) of several matrices; by default relative to the first of each."""
    B, k = values.shape
    if k == 0:
        return np.zeros(B, dtype=np.intp)
    reference = values[:, :1] if reference is None else reference[:, None]
    nothing = ~(reference[:, 0] > NOTHING)
    relative = np.clip(values / np.where(reference > NOTHING, reference, 1.0), FLOOR, 1.0)
    ladder = np.concatenate((np.ones((B, 1)), relative, np.full((B, 1), FLOOR)), axis=1)
    return np.where(nothing, 0, np.argmax(ladder[:, :-1] / ladder[:, 1:], axis=1))
