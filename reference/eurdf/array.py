"""Types of arrays, and their numbers in the text of a result."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Indices = NDArray[np.intp]
Mask = NDArray[np.bool_]


def numbers(values: Vector, most: int = 6) -> str:
    """The numbers of a vector in few digits, at most so many; of what has more dimensions, its shape."""
    if values.ndim != 1:
        return f"{values.shape}"
    shown = [f"{value + 0.0:.4g}" for value in values[:most].tolist()]
    return f"[{', '.join(shown)}{f', … {len(values)} in all' if len(values) > most else ''}]"
