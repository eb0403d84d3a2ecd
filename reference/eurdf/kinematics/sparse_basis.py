"""A sparse basis of a space, which shows which entries belong together."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix

#: Entries below this, relative to the largest of their vector, count as rounding of numbers in files.
NEGLIGIBLE = 1e-4


def sparse_basis(vectors: Matrix) -> Matrix:
    """A basis of the same space whose vectors have few nonzero entries.

    It is the reduced echelon form with complete pivoting: up to a factor, each vector is the only one of the space with
    its pattern of zeros. If the space is a sum of spaces without common entries, each vector lies in one of them.

    Args:
        vectors: A basis (k, n), one vector a row.

    Returns:
        The basis (k, n), one vector a row, in the order of their first nonzero entries. The first of the largest
        entries of each vector, to within 0.1 %, is 1, so the choice does not depend on rounding.
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
