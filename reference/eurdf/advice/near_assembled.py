"""Advice on a configuration whose name is nearly the one that the format gives a meaning to."""

from __future__ import annotations

from eurdf.diagnostics import Diagnostics
from eurdf.format.wording import near
from eurdf.linking.robot_files import ReadRobot

_NAME = "assembled"


def advise_on_near_assembled(read: ReadRobot, diagnostics: Diagnostics) -> None:
    """Report a configuration that is probably to be ``assembled``, where none is; not one named ``assembled_2``."""
    names = read.mechanism.configurations
    meant = next((name for name in names if _NAME not in name and near(name, [_NAME])), None)
    if meant is not None and _NAME not in names:
        diagnostics.report(
            "x-near-assembled",
            f"there is a configuration '{meant}', but none '{_NAME}', in which the loops are closed",
            read.description.document.place(("configurations", meant), True),
            f"did you mean '{_NAME}'?",
        )
