"""Claims about Pinocchio."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import pinocchio as pin

from benchmarks.claims.captured import captured
from benchmarks.claims.expectation import expect
from benchmarks.claims.four_bar import BALL_JOINT, LOOPS, MASS, mjcf, with_elements, with_two_parents


def equalities_of_mjcf() -> str:
    """Which equalities of an MJCF become constraints."""
    found = {}
    with TemporaryDirectory() as folder:
        for name in ("connect", "weld", "joint"):
            file = Path(folder, f"{name}.xml")
            file.write_text(mjcf([name]), encoding="utf-8")
            _, points, frames = pin.buildModelAndConstraintsFromMJCF(str(file))
            found[name] = len(points), len(frames)
    shown = (f"{name}: {points} of points, {frames} of frames" for name, (points, frames) in found.items())
    right = {"connect": (1, 0), "weld": (0, 1), "joint": (0, 0)}
    return expect(found == right, f"constraints of {'; '.join(shown)}")


def loops_in_urdf() -> str:
    """The elements of each dialect in a URDF."""
    for dialect, elements in LOOPS.items():
        with captured() as printed:
            model = pin.buildModelFromXML(with_elements(elements))
        expect((model.nv, printed.text) == (3, ""), f"{dialect}: {model.nv} velocities; {printed.text!r}")
    with captured():
        error = _error(BALL_JOINT)
    return expect(bool(error), f"three open bars, nothing printed; a ball joint: {error or 'accepted'}")


def two_parents() -> str:
    """The loop as a second joint to the rocker, written in twelve ways."""
    seen: Counter[str] = Counter()
    for text in with_two_parents():
        with captured():
            error = _error(text)
            names = [] if error else list(pin.buildModelFromXML(text).names)
            mass = 0.0 if error else sum(inertia.mass for inertia in pin.buildModelFromXML(text).inertias)
        seen[error or f"{max(Counter(names).values())} joints of one name, {mass:.2f} kg"] += 1
    shown = f"of {MASS:.2f} kg: " + "; ".join(f"{number} × {what}" for what, number in sorted(seen.items()))
    models = {what: number for what, number in seen.items() if what.endswith("kg")}
    twice = {f"2 joints of one name, {mass:.2f} kg" for mass in (MASS + 0.25, MASS + 0.37)}
    return expect(sum(models.values()) == 8 and models.keys() == twice and sum(seen.values()) == 12, shown)


def _error(urdf: str) -> str:
    try:
        pin.buildModelFromXML(urdf)
    except ValueError as error:
        return str(error)
    return ""
