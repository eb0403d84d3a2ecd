"""The command line that runs one item alone, as shown in failures and certificates."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, replace
from itertools import product

from eurdf_conformance.fresh.case import FRESH

#: Default time limits, s: for an answer, and for a start.
TIMEOUT, START_TIMEOUT = 10.0, 30.0

#: What pytest runs: in a checkout a folder, elsewhere a package, with its plug-in.
FOLDER = ("conformance/",)
PACKAGE = ("--pyargs", "eurdf_conformance.suite", "-p", "eurdf_conformance.suite.plugin")

_TIMES = re.compile(r" --parser-(start-)?timeout=([0-9.e+-]+)")


@dataclass(frozen=True)
class Setting:
    """The settings of a run that affect the result of an item.

    Attributes:
        parser: ``package.module:object`` or ``cmd:…``.
        suite: What pytest runs.
        timeout: Time allowed for an answer, s.
        start_timeout: Time allowed for a start, s.
        explore: Further random mechanisms to try for each property.
        seed: The seed of the fresh cases and of further mechanisms.
    """

    parser: str
    suite: tuple[str, ...] = FOLDER
    timeout: float = TIMEOUT
    start_timeout: float = START_TIMEOUT
    explore: int = 0
    seed: int = 0


def command_line(setting: Setting, item_id: str, level: str) -> str:
    """The command line that runs one item alone.

    Args:
        setting: The settings of the run.
        item_id: Id of the item.
        level: Its level.
    """
    settings = [f"--parser={setting.parser}"]
    settings += [f"--parser-timeout={setting.timeout:g}"] * (setting.timeout != TIMEOUT)
    settings += [f"--parser-start-timeout={setting.start_timeout:g}"] * (setting.start_timeout != START_TIMEOUT)
    of_property = item_id.startswith("properties/")
    settings += [f"--explore={setting.explore}"] if setting.explore and of_property else []
    settings += [f"--seed={setting.seed}"] if of_property or item_id.startswith(f"{FRESH}/") else []
    # One process: to start several takes longer than one item does.
    return shlex.join(["pytest", *setting.suite, *settings, "-n0", "-k", f"{item_id}/{level}"])


def is_command_line(text: str, setting: Setting, item_id: str, level: str) -> bool:
    """Whether a text is such a command line, with any time limits, from a checkout or an installed package.

    Args:
        text: The text.
        setting: The settings of the run; `suite` and the time limits are ignored.
        item_id: Id of the item.
        level: Its level.
    """
    # The parser may have options of the same names, so only the options of the suite, which come first, are compared.
    times: dict[str, float | None] = {start: _seconds(value) for start, value in _TIMES.findall(text)}
    choices = product((FOLDER, PACKAGE), {TIMEOUT, times.get("")}, {START_TIMEOUT, times.get("start-")})
    return any(
        text == command_line(replace(setting, suite=suite, timeout=one, start_timeout=other), item_id, level)
        for suite, one, other in choices
        if one is not None and other is not None
    )


def _seconds(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
