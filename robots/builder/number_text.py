"""Numbers as text: the shortest that reads back the same."""

from __future__ import annotations

from collections.abc import Iterable

#: Decimals kept of a length (m) or an angle (rad): far below what closes a loop, above the noise of the last bit.
DECIMALS = 14

#: Significant digits kept of a mass (kg) or a moment of inertia (kg·m²).
DIGITS = 12


def number_text(value: float) -> str:
    """The shortest decimal that reads back as ``value``; zero has no sign, an integer no point."""
    return repr(float(value) + 0.0).removesuffix(".0")


def length_text(values: Iterable[float]) -> str:
    """Lengths (m), angles (rad) or the components of a unit vector, separated by spaces."""
    return " ".join(number_text(round(float(value), DECIMALS)) for value in values)


def mass_text(value: float) -> str:
    """A mass (kg) or a moment of inertia (kg·m²)."""
    return number_text(float(f"{value:.{DIGITS}g}"))
