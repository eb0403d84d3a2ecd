"""The rank of a matrix whose entries carry rounding, of arithmetic and of files."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Vector

#: Relative to the largest singular value, what is below this is rounding and never tells ranks apart.
FLOOR = 1e-9

#: A matrix scaled to one unit has entries about 1; where none of its singular values exceeds this, all are rounding.
NOTHING = 1e-12


def numerical_rank(singular_values: Vector, reference: float) -> int:
    """Number of singular values before the widest gap.

    A fixed threshold would have to lie between the rounding of the numbers in files (an angle given as 1.5708 turns
    an axis by 4e-6) and the honest small values of short levers. Instead the values, relative to ``reference`` and
    not below `FLOOR`, are put between 1 and `FLOOR`, and those before the largest ratio of two neighbours count. A
    value that stands alone so counts above about 3e-5 = √FLOOR.

    Args:
        singular_values: In descending order, of a matrix scaled to one unit.
        reference: The largest singular value of that matrix, or of the one it is a part of.
    """
    if not reference > NOTHING or not len(singular_values):
        return 0
    ladder = np.concatenate(([1.0], np.clip(singular_values / reference, FLOOR, 1.0), [FLOOR]))
    return int(np.argmax(ladder[:-1] / ladder[1:]))
