"""The published loader: ``--parser=eurdf_conformance.adapters.published_loader:Strict``, or ``:Lenient``.

It is the function `completeRobotLoader` of `example_parallel_robots`, which needs `toolbox_parallel_robots`. Nothing of
them is part of this package. Install both, or set the environment variable `EURDF_PUBLISHED_LOADER` to the folders of
their checkouts, separated as in `PATH`. The toolbox imports CasADi, Pinocchio's bindings of CasADi and qpsolvers, which
loading does not use: empty modules replace those that are not installed.

`Strict` gives the loader the files as they are, and rejects the robot if the loader has dropped a closure, a motor, a
changed joint or a type that the description names. `Lenient` helps it: keys that the description leaves out, without
which it fails, are empty lists, and what it drops is lost in silence. Both give the robot the name in the URDF, which
the loader drops.

The loader is of the time of Pinocchio 3. With Pinocchio 4.1 it crashes at random while it locks joints; with 3.4 it
does not. So give it an environment of its own, with this package, SciPy, ``pin==3.4.0``, ``cmeel-urdfdom==4.0.1`` and
``cmeel-tinyxml2==10.0.0``, and start it there: ``--parser="cmd:PYTHON -m eurdf_conformance.protocol.serve
eurdf_conformance.adapters.published_loader:Strict"``.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar
from unittest import mock

import pinocchio as pin
import yaml

from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Accepted, Rejected
from eurdf_conformance.protocol.reply import accepted, rejected

FOLDERS = "EURDF_PUBLISHED_LOADER"
#: Imported by the toolbox, but not used to load a robot.
UNUSED = ("casadi", "pinocchio.casadi", "qpsolvers")
_LIMITLESS = 1e300


class LoaderMissing(Exception):  # noqa: N818 - it says what is wrong
    """The published loader cannot be imported."""


class Strict:
    """The loader; what it drops without a message is an error."""

    name, version, language = "published loader (strict)", "1.2.0", "Python"
    claims: ClassVar[Mapping[str, Sequence[Level]]] = {"1": (Level.ACCEPT, Level.STRUCTURE)}

    def __init__(self) -> None:
        self._loader = published_loader()

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        """Read a robot."""
        try:
            with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                loaded = self.loaded(description, urdf)
        except Exception as error:  # it has no type of its own for wrong files
            return rejected(f"{type(error).__name__}: {error}")
        if dropped := list(self.dropped(description, *loaded[:3])):
            return rejected(*dropped)
        return accepted(_canonical(description.parent, *loaded) | {"name": _name(urdf)})

    def loaded(self, description: Path, urdf: Path) -> Sequence[Any]:
        """What the loader returns: the model, its closures, its motors, and its visual and collision shapes."""
        folder = description.parent
        found: Sequence[Any] = self._loader.completeRobotLoader(
            str(folder), os.path.relpath(urdf, folder), description.name
        )
        return found

    def dropped(self, description: Path, model: Any, closures: Any, actuation: Any) -> Iterator[str]:
        """Parts that the description names and the result does not have."""
        data = yaml.safe_load(description.read_text(encoding="utf-8"))
        if len(data.get("closed_loop", ())) != len(closures):
            yield f"{len(data['closed_loop'])} closures are described, {len(closures)} are read"
        if len(data.get("joint_name", ())) != len(data.get("joint_type", ())):
            yield "joint_name and joint_type differ in length"
        for kind in data.get("type", ()):
            if str(kind).lower() not in ("3d", "6d"):
                yield f"the closure type {kind!r} is read as 6d"
        frames = {frame.name for frame in model.frames}
        for name in data.get("joint_name", ()):
            if not any(frame == name or frame.startswith(f"{name}_") for frame in frames):
                yield f"there is no joint {name!r}"
        for name in data.get("name_mot", ()):
            if name not in model.names:
                yield f"there is no motor {name!r}"
        for name in {name for pair in data.get("closed_loop", ()) for name in pair} - frames:
            yield f"there is no frame {name!r}"


class Lenient(Strict):
    """The loader, helped where it needs or drops what a file may leave out or say."""

    name = "published loader (lenient)"

    def loaded(self, description: Path, urdf: Path) -> Sequence[Any]:
        """What the loader returns where no key is left out."""
        contents = self._loader.getYAMLcontents

        def filled(*place: str) -> Any:
            found = contents(*place)
            if isinstance(found, dict):
                found = {"closed_loop": [], "name_mot": [], **found}
                found.setdefault("type", ["6d"] * len(found["closed_loop"] or ()))
            return found

        with mock.patch.object(self._loader, "getYAMLcontents", filled):
            return super().loaded(description, urdf)

    def dropped(self, description: Path, model: Any, closures: Any, actuation: Any) -> Iterator[str]:
        """Nothing that matters here."""
        yield from ()


@cache
def published_loader() -> ModuleType:
    """The module of the loader.

    Raises:
        LoaderMissing: It is not installed, or a package that it needs is missing.
    """
    for folder in filter(None, os.environ.get(FOLDERS, "").split(os.pathsep)):
        if folder not in sys.path:
            sys.path.append(folder)
    for name in UNUSED:
        try:
            importlib.import_module(name)
        except ImportError:
            sys.modules[name] = ModuleType(name)
            parent, _, child = name.rpartition(".")
            if parent:
                setattr(sys.modules[parent], child, sys.modules[name])
    if not hasattr(sys.modules["qpsolvers"], "solve_qp"):
        vars(sys.modules["qpsolvers"])["solve_qp"] = None
    try:
        return importlib.import_module("example_parallel_robots.loader_tools")
    except ImportError as error:
        raise LoaderMissing(
            f"the published loader cannot be imported ({error}); install example_parallel_robots and "
            f"toolbox_parallel_robots, or set {FOLDERS} to the folders of their checkouts, separated by '{os.pathsep}'"
        ) from error


def _name(urdf: Path) -> str:
    """The robot's name, which the loader drops; none where it cannot be decoded."""
    try:
        return str(pin.buildModelFromUrdf(str(urdf)).name)
    except UnicodeDecodeError:
        return ""


def _canonical(folder: Path, model: Any, closures: Any, actuation: Any, visual: Any, collision: Any) -> dict[str, Any]:
    links = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    link_of = dict(enumerate(model.names))
    link_of |= {frame.parentJoint: frame.name for frame in reversed(links)}
    return {
        "version": "1",
        "root": "fixed",
        "links": [frame.name for frame in links],
        "frames": [],
        "joints": [_joint(model, index, link_of) for index in range(1, model.njoints)],
        "closures": [
            {
                "name": f"closure_{number}",
                "type": "3d" if closure.type == pin.ContactType.CONTACT_3D else "6d",
                "a": link_of[closure.joint1_id],
                "b": link_of[closure.joint2_id],
            }
            for number, closure in enumerate(closures, 1)
        ],
        "actuators": [{"joint": model.names[joint]} for joint in actuation.mot_joints_ids],
        "configurations": {},
        "shapes": [
            *_shapes(folder, model, visual, "visual", link_of),
            *_shapes(folder, model, collision, "collision", link_of),
        ],
        "own": {},
    }


_TYPES = {"RX": "revolute", "RY": "revolute", "RZ": "revolute", "RevoluteUnaligned": "revolute"}
_TYPES |= {"RUBX": "continuous", "RUBY": "continuous", "RUBZ": "continuous", "RevoluteUnboundedUnaligned": "continuous"}
_TYPES |= {"PX": "prismatic", "PY": "prismatic", "PZ": "prismatic", "PrismaticUnaligned": "prismatic"}
_TYPES |= {"Planar": "planar", "FreeFlyer": "floating", "Spherical": "spherical"}


def _joint(model: Any, index: int, link_of: Mapping[int, str]) -> dict[str, Any]:
    joint = model.joints[index]
    kind = _TYPES[joint.shortname().removeprefix("JointModel")]
    q, v = slice(joint.idx_q, joint.idx_q + joint.nq), slice(joint.idx_v, joint.idx_v + joint.nv)
    bounded = kind in ("revolute", "prismatic")
    unbounded: list[None] = [None] if kind == "continuous" else []
    return {
        "name": model.names[index],
        "type": kind,
        "parent": link_of[model.parents[index]],
        "child": link_of[index],
        "lower": _limits(model.lowerPositionLimit[q]) if bounded else unbounded,
        "upper": _limits(model.upperPositionLimit[q]) if bounded else unbounded,
        "velocity": _limits(_one_of(model, "velocityLimit", "upperVelocityLimit")[v]),
        "effort": _limits(_one_of(model, "effortLimit", "upperEffortLimit")[v]),
        "damping": model.damping[v].tolist(),
        "friction": _one_of(model, "friction", "upperDryFrictionLimit")[v].tolist(),
        "armature": model.armature[v].tolist(),
    }


def _one_of(model: Any, before: str, now: str) -> Any:
    """What has another name since Pinocchio 4."""
    return getattr(model, now if hasattr(model, now) else before)


def _limits(values: Any) -> list[float | None]:
    return [float(value) if abs(value) < _LIMITLESS else None for value in values]


def _shapes(folder: Path, model: Any, geometry: Any, use: str, link_of: Mapping[int, str]) -> Iterator[dict[str, Any]]:
    """Shapes in the frame of their link, or, if the model moves them by another joint, in the frame of that joint."""
    for shape in geometry.geometryObjects:
        link = shape.name.rpartition("_")[0]  # Pinocchio names shapes by link and number
        # A root link is lost if a joint is locked.
        frame = model.frames[model.getFrameId(link)] if model.existFrame(link) else None
        if frame is None or frame.parentJoint != shape.parentJoint:
            link, fMg = link_of[shape.parentJoint], shape.placement
        else:
            fMg = frame.placement.actInv(shape.placement)
        type_, size = _size(shape)
        yield {
            "link": link,
            "use": use,
            "type": type_,
            "size": size,
            "file": os.path.relpath(shape.meshPath, folder) if type_ == "mesh" else None,
            "pose": {"rotation": fMg.rotation.tolist(), "translation": fMg.translation.tolist()},
        }


def _size(shape: Any) -> tuple[str, list[float]]:
    solid = shape.geometry
    kind = type(solid).__name__
    if kind == "Box":
        return "box", [2 * float(half) for half in solid.halfSide]
    if kind == "Sphere":
        return "sphere", [float(solid.radius)]
    if kind in ("Cylinder", "Capsule"):
        return kind.lower(), [float(solid.radius), 2 * float(solid.halfLength)]
    return "mesh", [float(scale) for scale in shape.meshScale]
