"""Common real roots of quadratic forms."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from eurdf.array import Matrix, Vector

#: A form, or a value of it at a unit vector, counts as zero up to this: above the errors of differences and of
#: configurations that are closed to 1e-6.
ZERO = 1e-3

# A root of one form is one of another form that is at most this there.
_COMMON = 1e-2

_MOST_DIRECTIONS, _STARTS, _MOST_STEPS = 6, 24, 40

# Steps of the search for a definite combination, and from how many starts.
_ASCENTS, _RISES = 8, 100


@dataclass(frozen=True, slots=True, eq=False)
class Roots:
    """Unit vectors at which all of some forms are zero.

    Attributes:
        count: Number of independent forms.
        directions: Roots (k, m), up to sign: all of them, or a sample.
        complete: Whether the roots are all, or a sample in general position of all.
        none: Whether it is proven that there are none.
    """

    count: int
    directions: Matrix
    complete: bool
    none: bool = False


def common_roots(forms: Matrix) -> Roots:
    """The unit vectors z (m,) with zᵀ Q_k z = 0 for all of the symmetric matrices Q (κ, m, m).

    For m at most 2, and for one independent form, the answer is exact. Else a positive definite combination Σ λ_k Q_k
    proves that there are none, and roots are found by Newton steps from random starts.
    """
    m = forms.shape[1]
    forms = _independent(forms)
    random = np.random.default_rng(0)
    if not len(forms):
        direction = random.normal(size=(1, m))
        return Roots(0, direction / float(np.linalg.norm(direction)), complete=True)
    none = Roots(len(forms), np.empty((0, m)), complete=True, none=True)
    if m == 1:
        return none
    if m == 2:
        roots = np.array([z for z in _of_two(forms[0]) if np.abs(_values(forms, z)).max() <= _COMMON])
        return Roots(len(forms), roots, complete=True) if len(roots) else none
    if _has_definite_combination(forms, random):
        return none
    found: list[Vector] = []
    for start in random.normal(size=(_STARTS, m)):
        z = _root(forms, start / np.linalg.norm(start))
        if z is not None and all(abs(float(z @ other)) < 0.999 for other in found):
            found.append(z)
        if len(found) == _MOST_DIRECTIONS:
            break
    return Roots(len(forms), np.array(found).reshape(-1, m), complete=len(forms) == 1)


def _values(forms: Matrix, z: Vector) -> Vector:
    return np.asarray(np.einsum("kij,i,j->k", forms, z, z))


def _independent(forms: Matrix) -> Matrix:
    """Orthogonal combinations of the forms that span the same space, the largest first, without those of zero."""
    _, values, right = np.linalg.svd(forms.reshape(len(forms), -1), full_matrices=False)
    count = int((values > ZERO).sum())
    return np.asarray((values[:count, None] * right[:count]).reshape(count, *forms.shape[1:]))


def _of_two(form: Matrix) -> list[Vector]:
    """Roots of a form in two variables: with z = (cos t, sin t) it is mean + radius cos(2t - phase)."""
    mean = (form[0, 0] + form[1, 1]) / 2.0
    half = (form[0, 0] - form[1, 1]) / 2.0
    radius, phase = math.hypot(half, form[0, 1]), math.atan2(form[0, 1], half)
    if abs(mean) > radius + ZERO:
        return []
    turn = math.acos(min(max(-mean / radius, -1.0), 1.0)) if radius > 0.0 else 0.0
    angles = [(phase + turn) / 2.0] + ([(phase - turn) / 2.0] if math.sin(turn) > 1e-6 else [])
    return [np.array([math.cos(t), math.sin(t)]) for t in angles]


def _has_definite_combination(forms: Matrix, random: np.random.Generator) -> bool:
    """Whether ascent of the least eigenvalue of Σ λ_k Q_k over unit λ makes it positive."""
    starts = [np.array([1.0]), np.array([-1.0])] if len(forms) == 1 else random.normal(size=(_ASCENTS, len(forms)))
    for start in starts:
        weights = start / np.linalg.norm(start)
        for step in range(1 if len(forms) == 1 else _RISES):
            values, vectors = np.linalg.eigh(np.tensordot(weights, forms, 1))
            if values[0] > ZERO:
                return True
            slope = _values(forms, vectors[:, 0])
            weights = weights + slope / max(float(np.linalg.norm(slope)), 1e-300) / (1.0 + step) ** 0.75
            weights /= max(float(np.linalg.norm(weights)), 1e-300)
    return False


def _root(forms: Matrix, z: Vector) -> Vector | None:
    """A root near a unit vector z (m,), by Gauss-Newton steps on the sphere."""
    for _ in range(_MOST_STEPS):
        values = _values(forms, z)
        if np.abs(values).max() < 1e-12:
            break
        slope = 2.0 * np.einsum("kij,j->ki", forms, z)
        slope -= np.outer(slope @ z, z)
        step = -np.linalg.lstsq(slope, values, rcond=1e-9)[0]
        step *= min(1.0, 0.5 / max(float(np.linalg.norm(step)), 1e-300))
        z = z + step
        z = z / np.linalg.norm(z)
    return z if np.abs(_values(forms, z)).max() < 1e-6 else None
