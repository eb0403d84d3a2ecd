"""A basis of a space that shows which entries belong together."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix

#: Entries smaller than this beside the largest of their vector are taken for the rounding of numbers in files.
NEGLIGIBLE = 1e-4


def sparse_basis(vectors: Matrix) -> Matrix:
    """A basis of the same space whose vectors have few entries that are not zero.

    It is the reduced echelon form with complete pivoting: each vector is, but for a factor, the only one of the space
    that is zero wherever it is zero. Where the space is a sum of spaces with no entry in common, each vector is of one
    of them.

    Args:
        vectors: A basis (k, n), one vector a row.

    Returns:
        The basis (k, n), one vector a row, in the order of the first entries that are not zero. An entry of each is 1:
        the first of those that are the largest to within 0.1 %, so that rounding does not choose among equal ones.
    """
    basis = np.array(vectors, dtype=np.float64)
    for row in range(len(basis)):
        rest = np.abs(basis[row:])
        pivot, column = np.unravel_index(int(np.argmax(rest)), rest.shape)
        basis[[row, row + int(pivot)]] = basis[[row + int(pivot), row]]
        basis[row] /= basis[row, column]
        others = np.arange(len(basis)) != row
        basis[others] -= np.outer(basis[others, column], basis[row])
    for index, vector in enumerate(basis):
        largest = vector[np.argmax(np.abs(vector) > 0.999 * np.abs(vector).max(initial=0.0))] if len(vector) else 1.0
        basis[index] = vector / largest
    basis[np.abs(basis) < NEGLIGIBLE] = 0.0
    first = [int(np.argmax(vector != 0.0)) for vector in basis]
    return basis[np.argsort(np.array(first, dtype=np.intp), kind="stable")]
