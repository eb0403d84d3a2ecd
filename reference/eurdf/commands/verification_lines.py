"""What ``eurdf export --verify`` shows on a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eurdf.convert.verification.verify import Verification
    from eurdf.diagnostics.text import Line


def verification_lines(found: Verification) -> Iterator[Line]:
    """The comparison, then what is wrong, what differs as losses say, and what was not compared.

    Args:
        found: The result of `Export.verify`.
    """
    from eurdf.convert.verification.fall import amount
    from eurdf.diagnostics.visible import visible

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
