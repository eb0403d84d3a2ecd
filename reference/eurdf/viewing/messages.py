"""What the server and a page of the viewer say to each other: JSON objects, each with its ``type``.

The class of a message states its fields; its ``type`` is the name of the class in lower case. ``js/page/connection.js``
is the other side. A configuration is an object with the coordinates of each joint by its name, as files have them.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, get_args

#: A configuration: for each joint with coordinates of its own these, as files state them.
Coordinates = Mapping[str, tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class Model:
    """To a page: a robot, new or in place of its earlier version.

    Attributes:
        robot: Its number; number 0 has the controls.
        version: Which version of it this is, from 0.
        urdf: The text of its URDF.
        description: The text of its description; None of a bare URDF.
        meshes: The address of each mesh, by its name in the URDF.
        xyz: Where the origin of its world is, m.
        q: Where it is.
        configurations: The named configurations, with those saved since it was loaded.
        facts: What the analysis says of it; None of a robot without controls.
    """

    robot: int
    version: int
    urdf: str
    description: str | None
    meshes: Mapping[str, str]
    xyz: tuple[float, ...]
    q: Coordinates
    configurations: Mapping[str, Coordinates]
    facts: Facts | None


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of the robot with controls, whatever its configuration.

    Attributes:
        dimensions: Name, value and meaning of each figure of ``eurdf info``.
        dependent: Names of actuators that depend on one another, by group.
        note: What the analysis left out.
        graph: The graph of links and joints, as SVG.
        saves: Whether configurations can be saved to its description.
        diagnostics: As in `BadFiles`.
    """

    dimensions: tuple[tuple[str, int | None, str], ...]
    dependent: tuple[tuple[str, ...], ...]
    note: str
    graph: str
    saves: bool
    diagnostics: tuple[Mapping[str, Any], ...]


@dataclass(frozen=True, slots=True)
class Show:
    """To a page: where a robot is now."""

    robot: int
    q: Coordinates


@dataclass(frozen=True, slots=True)
class BadFiles:
    """To a page: the files changed and have errors; the robot is the one before.

    Attributes:
        text: In a sentence.
        diagnostics: Each with ``severity``, ``code``, ``place``, ``message`` and ``hint``.
    """

    text: str
    diagnostics: tuple[Mapping[str, Any], ...]


@dataclass(frozen=True, slots=True)
class Say:
    """To a page: what its user should know; ``error`` if something failed."""

    text: str
    error: bool = False


@dataclass(frozen=True, slots=True)
class Saved:
    """To a page: a configuration was saved."""

    name: str
    q: Coordinates
    text: str


@dataclass(frozen=True, slots=True)
class Exists:
    """To a page: there is a different configuration of this name; to replace it, save it with ``replace``."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Playing:
    """To a page: what the server plays.

    Attributes:
        what: ``gravity``, ``trajectory``, or None if nothing is played.
        paused: Whether it is paused.
        time: Since its begin, s.
        duration: Of a trajectory, s.
        speed: Of a trajectory, as a factor.
        pace: Of gravity, simulated time over real time, at most 1.
    """

    what: str | None = None
    paused: bool = False
    time: float = 0.0
    duration: float | None = None
    speed: float = 1.0
    pace: float = 1.0


@dataclass(frozen=True, slots=True)
class Analyzed:
    """To a page: the analysis of a configuration that is shown.

    Attributes:
        singularity: Distance to singularity; None without loops.
        held: The same with every actuator held; None if it is not defined.
        limits: Of each passive joint its name, unit, largest velocity, and least and greatest torque, or None where
            there is no limit.
        reason: Why there are no limits.
    """

    singularity: float | None
    held: float | None
    limits: tuple[Mapping[str, Any], ...]
    reason: str


@dataclass(frozen=True, slots=True)
class Moved:
    """From a page: its user moved this version of the robot, which pauses what is played."""

    version: int
    q: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Save:
    """From a page: save where the robot is under a name."""

    name: str
    replace: bool


@dataclass(frozen=True, slots=True)
class Gravity:
    """From a page: let the robot move under gravity, with or without damping and friction, its base held or not."""

    dissipation: bool
    held: bool


@dataclass(frozen=True, slots=True)
class Follow:
    """From a page: replay a trajectory, which is the text of a CSV file."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Pause:
    """From a page: pause what is played, or go on; with ``step``, for one frame."""

    paused: bool
    step: bool = False


@dataclass(frozen=True, slots=True)
class Seek:
    """From a page: go to a time of the trajectory, s; its speed is a factor from then on."""

    time: float
    speed: float


@dataclass(frozen=True, slots=True)
class End:
    """From a page: end what is played."""


Request = Moved | Save | Gravity | Follow | Pause | Seek | End
_REQUESTS: dict[str, type[Any]] = {each.__name__.lower(): each for each in get_args(Request)}
_TYPES: dict[str, type | tuple[type, ...]] = {
    "str": str, "bool": bool, "int": int, "float": (int, float), "Mapping[str, Any]": dict
}  # fmt: skip


def text_of(message: Any) -> str:
    """A message to a page as JSON."""
    return json.dumps({"type": type(message).__name__.lower(), **asdict(message)}, allow_nan=False)


def request_of(text: str | bytes) -> Request:
    """What a page says.

    Raises:
        ValueError: It is no such message; the text says why.
    """
    try:
        content = json.loads(text)
    except RecursionError:
        raise ValueError("the message is nested too deeply") from None
    kind = _REQUESTS.get(str(content.pop("type", "")) if isinstance(content, dict) else "")
    if kind is None:
        raise ValueError("the message has no type that is known")
    for each in fields(kind):
        value = content.get(each.name, each.default)
        if not isinstance(value, _TYPES[str(each.type)]) or (isinstance(value, float) and not math.isfinite(value)):
            raise ValueError(f"'{each.name}' of a message '{kind.__name__.lower()}' is not of type {each.type}")
    try:
        request: Request = kind(**content)
    except TypeError as error:
        raise ValueError(str(error)) from None
    return request
