"""What ``eurdf export`` and ``eurdf import`` show on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.convert.verification.verify import Verification
    from eurdf.diagnostics import Place
    from eurdf.diagnostics.text import Line

# Elements that are shown of each kind of loss.
_MOST_SHOWN = 4

_STYLES = {"exact": "green", "approximate": "yellow", "dropped": "red"}


def loss_lines(losses: Sequence[Loss], place_of: Callable[[Loss], Place | None]) -> Iterator[Line]:
    """The losses, by code."""
    from eurdf.diagnostics.wording import visible

    groups: dict[str, list[Loss]] = {}
    for loss in losses:
        groups.setdefault(loss.code, []).append(loss)
    for code, group in groups.items():
        first = group[0]
        count = f"{len(group)} x " if len(group) > 1 else ""
        effect = str(first.effect)
        yield [(f"{count}{first.concept}: ", "bold"), (effect, _STYLES[effect]), (f" [{code}]", "dim")]
        for loss in group[:_MOST_SHOWN]:
            place = place_of(loss)
            where = f"{visible(place.file)}:{place.line}: " if place is not None and place.line else ""
            yield [(f"    {where}'{visible(loss.name)}': {visible(loss.message)}", "")]
        if len(group) > _MOST_SHOWN:
            yield [(f"    and {len(group) - _MOST_SHOWN} more; --json lists all", "dim")]
        yield [("    = hint: ", "cyan"), (first.hint, "")]


def verification_lines(found: Verification) -> Iterator[Line]:
    """The comparison, then what is wrong, what differs as losses say, and what was not compared."""
    from eurdf.convert.verification.fall import amount
    from eurdf.diagnostics.wording import visible

    yield [(f"read back by {found.reader}", "bold")]
    if not found.refused:
        read, own = found.mass
        yield [(f"    mass: {read:.6g} kg, of the robot {own:.6g} kg", "")]
        yield [(f"    mass matrix: differs by {found.mass_matrix_error:.1g} of its largest entry", "")]
        if found.fall is not None:
            yield [(f"    simulated: {found.fall.seconds:.3g} s, without control", "")]
        for index, opening in enumerate(found.openings):
            line = f"    '{visible(opening.name)}': open by {amount(opening)} at the start"
            if found.fall is not None and found.fall.openings:
                most, time = found.fall.openings[index], found.fall.times[index]
                line += f", by up to {amount(most)} in the simulation, at {time:.3g} s"
            yield [(line, "")]
    for finding in found.findings:
        yield [("error: ", "bold red"), (visible(finding.message), "bold")]
        for cause in finding.causes:
            yield [(f"    {visible(cause)}", "")]
    for each in found.listed:
        yield [("listed loss: ", "cyan"), (each, "")]
    for each in found.unverified:
        yield [("not verified: ", "cyan"), (each, "")]
