"""The published loader: ``--parser=eurdf_conformance.adapters.published_loader:Strict``, or ``:Lenient``.

It is the function `completeRobotLoader` of `example_parallel_robots`, which needs `toolbox_parallel_robots`. Nothing of
them is part of this package. Install both, or set the environment variable `EURDF_PUBLISHED_LOADER` to the folders of
their checkouts, separated as in `PATH`. The toolbox imports CasADi, Pinocchio's bindings of CasADi and qpsolvers, which
loading does not use: empty modules replace those that are not installed.

`Lenient` answers with what the loader returns. `Strict` rejects the robot if the loader has dropped a closure, a motor,
a changed joint or a type that the description names.
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


class Lenient:
    """The loader as it answers."""

    name, version, language = "published loader (lenient)", "1.2.0", "Python"
    claims: ClassVar[Mapping[str, Sequence[Level]]] = {"1": (Level.ACCEPT, Level.STRUCTURE)}

    def __init__(self) -> None:
        self._loader = published_loader()

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        """Read a robot."""
        folder = description.parent
        name = os.path.relpath(urdf, folder)
        try:
            with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                loaded = self._loader.completeRobotLoader(str(folder), name, description.name)
        except Exception as error:  # it has no type of its own for wrong files
            return rejected(f"{type(error).__name__}: {error}")
        if dropped := list(self.dropped(description, *loaded[:3])):
            return rejected(*dropped)
        return accepted(_canonical(folder, *loaded))

    def dropped(self, description: Path, model: Any, closures: Any, actuation: Any) -> Iterator[str]:
        """What the loader has dropped without a message."""
        yield from ()


class Strict(Lenient):
    """The loader; what it drops without a message is an error."""

    name = "published loader (strict)"

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


def _canonical(folder: Path, model: Any, closures: Any, actuation: Any, visual: Any, collision: Any) -> dict[str, Any]:
    links = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    link_of = dict(enumerate(model.names))
    link_of |= {frame.parentJoint: frame.name for frame in reversed(links)}
    return {
        "name": model.name,
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
        "velocity": _limits(model.upperVelocityLimit[v]),
        "effort": _limits(model.upperEffortLimit[v]),
        "damping": model.damping[v].tolist(),
        "friction": model.upperDryFrictionLimit[v].tolist(),
        "armature": model.armature[v].tolist(),
    }


def _limits(values: Any) -> list[float | None]:
    return [float(value) if abs(value) < _LIMITLESS else None for value in values]


def _shapes(folder: Path, model: Any, geometry: Any, use: str, link_of: Mapping[int, str]) -> Iterator[dict[str, Any]]:
    """Shapes in the frame of their link, or, if the model moves them by another joint, in the frame of that joint."""
    for shape in geometry.geometryObjects:
        link = shape.name.rpartition("_")[0]  # Pinocchio names shapes by link and number
        frame = model.frames[model.getFrameId(link)]
        fMg = frame.placement.actInv(shape.placement)
        if frame.parentJoint != shape.parentJoint:
            link, fMg = link_of[shape.parentJoint], shape.placement
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
