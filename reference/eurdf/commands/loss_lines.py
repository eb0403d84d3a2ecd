"""The losses of an export or an import, for the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eurdf.convert.losses import Loss
    from eurdf.diagnostics import Place
    from eurdf.diagnostics.text import Line

# Elements that are shown of each kind of loss.
_MOST_SHOWN = 4

_STYLES = {"exact": "green", "approximate": "yellow", "dropped": "red"}


def loss_lines(losses: Sequence[Loss], place_of: Callable[[Loss], Place | None]) -> Iterator[Line]:
    """The losses, by code.

    Args:
        losses: In any order.
        place_of: Where the element of a loss is stated, if it is in a file.
    """
    from eurdf.diagnostics.visible import visible

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
            yield [(f"    and {len(group) - _MOST_SHOWN} more; --format json lists all", "dim")]
        yield [("    = hint: ", "cyan"), (first.hint, "")]
