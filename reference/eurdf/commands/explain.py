"""``eurdf explain``: what is wrong with a robot, by subject and with its causes, and how it moves."""

from __future__ import annotations

from typing import Any

from eurdf.commands.command import JSON, ROBOT, command
from eurdf.commands.output import write_result
from eurdf.commands.terminal import write_lines

_DESCRIPTION = """\
Explain a robot: why a loop is open, which motions no actuator decides, which actuators depend on one another, what is
implausible, and what differs between left and right. These are the diagnostics of `eurdf check`, by subject; a cause is
a question, and a fix is certain: `eurdf check --fix` applies it. Of a valid robot, it says how it moves.
"""


@command(
    summary="explain what is wrong with a robot, and how it moves",
    description=_DESCRIPTION,
    exit_codes="0 explained, 1 the robot has errors, 2 the command cannot run.",
    examples=("eurdf explain digit_leg",),
    has_output=False,
)
def explain(options: dict[str, Any], path: str = ROBOT, json: bool = JSON) -> int:
    """Explain, and write it."""
    import sys

    import eurdf
    from eurdf.diagnostics import Severity
    from eurdf.diagnostics.wording import visible

    found = eurdf.explain(path, **options)
    if json:
        write_result(found)
    else:
        lines = ((visible(line), "" if line.startswith(" ") else "bold") for line in found.lines())
        write_lines([[line] for line in lines], sys.stdout)
    return 1 if any(each.severity is Severity.ERROR for each in found.diagnostics) else 0
