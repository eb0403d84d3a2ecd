"""The process that compiles an MJCF file: the request is JSON on standard input, the model is JSON on standard output.

Of this package, it imports only modules that need nothing but the standard library. It runs in a folder of its own, as
MuJoCo writes a log there.
"""

from __future__ import annotations

import json
import math
import os
from typing import Any

import mujoco
import numpy as np

from eurdf.mesh_files.folders import Folders
from eurdf.mesh_files.reader import BYTES_LIMIT, GIT_LFS
from eurdf.sandbox import bound_memory, bound_time, request_and_answers

#: Of each kind of element: its type, if it has names, and the arrays of the model that the importer needs. The first of
#: them is in every release of MuJoCo.
_ELEMENTS: dict[str, tuple[Any, str]] = {
    "body": (mujoco.mjtObj.mjOBJ_BODY, "parentid pos quat mass ipos iquat inertia mocapid gravcomp"),
    "jnt": (
        mujoco.mjtObj.mjOBJ_JOINT,
        "type bodyid pos axis limited range stiffness qposadr dofadr actfrclimited actfrcrange stiffnesspoly",
    ),
    "dof": (None, "armature damping frictionloss dampingpoly"),
    "geom": (mujoco.mjtObj.mjOBJ_GEOM, "type bodyid contype conaffinity group size pos quat rgba matid dataid"),
    "mat": (None, "rgba texid"),
    "mesh": (mujoco.mjtObj.mjOBJ_MESH, "pos quat"),
    "site": (mujoco.mjtObj.mjOBJ_SITE, "bodyid pos quat"),
    "eq": (mujoco.mjtObj.mjOBJ_EQUALITY, "type objtype obj1id obj2id active0 data"),
    "tendon": (mujoco.mjtObj.mjOBJ_TENDON, "adr num length0 limited stiffness damping frictionloss"),
    "wrap": (None, "type objid prm"),
    "actuator": (
        mujoco.mjtObj.mjOBJ_ACTUATOR,
        "trntype trnid gear ctrllimited ctrladr forcelimited forcerange gaintype gainprm biastype dyntype",
    ),
    "key": (mujoco.mjtObj.mjOBJ_KEY, "qpos"),
}

#: The arrays of names in a list of them.
_ENUMERATIONS = {
    "jnt_type": mujoco.mjtJoint,
    "geom_type": mujoco.mjtGeom,
    "eq_type": mujoco.mjtEq,
    "eq_objtype": mujoco.mjtObj,
    "wrap_type": mujoco.mjtWrap,
    "actuator_trntype": mujoco.mjtTrn,
    "actuator_gaintype": mujoco.mjtGain,
    "actuator_biastype": mujoco.mjtBias,
    "actuator_dyntype": mujoco.mjtDyn,
}

#: Numbers of what a mechanism does not have.
_COUNTS = ("nsensor", "ncam", "nlight", "npair", "nexclude", "nflex", "nskin", "nhfield", "nplugin")


class Refused(Exception):  # noqa: N818 - the answer to the request
    """The file cannot be compiled; the text says why."""


def main() -> None:
    """Answer the request."""
    request, answers = request_and_answers()
    bound_time(2 * request["seconds"], request["seconds"])
    bound_memory(request["memory"])
    try:
        answer = _compiled(request["path"], Folders(request["folders"]))
    except Refused as reason:
        answer = {"error": str(reason)}
    except MemoryError:
        answer = {"error": "it takes too much memory"}
    except Exception as error:
        answer = {"error": "MuJoCo says: " + " ".join(str(error).split())}
    answers.write(json.dumps(answer).encode())
    answers.flush()


def _compiled(path: str, folders: Folders) -> dict[str, Any]:
    spec, faults = _specification(path, folders)
    left_out = _without_assets(spec, faults)
    try:
        model = spec.compile()
    except ValueError:
        # MuJoCo names one mesh at a time.
        faults = {mesh.name: reason for mesh in spec.meshes if (reason := _compile_error(mesh))}
        if not faults:
            raise
        spec, more = _specification(path, folders)
        left_out = _without_assets(spec, faults | more)
        model = spec.compile()
    elements = {kind: _elements(model, kind) for kind in _ELEMENTS}
    for mesh in spec.meshes:
        elements["mesh"][mesh.id] |= _mesh(model, mesh)
    full = {body.id: np.asarray(body.fullinertia) for body in spec.bodies}
    for body in elements["body"]:
        inertia = full.get(body["index"], np.array(math.nan))
        body["fullinertia"] = inertia.tolist() if np.isfinite(inertia).all() else []
    for actuator in elements["actuator"]:
        at = actuator["index"] if actuator["ctrladr"] == [] else actuator["ctrladr"]
        actuator["ctrlrange"] = model.actuator_ctrlrange[at].tolist() if actuator["ctrllimited"] else []
    return {
        "name": spec.modelname,
        "elements": elements,
        "qpos0": model.qpos0.tolist(),
        "qpos_spring": model.qpos_spring.tolist(),
        "counts": {name: int(getattr(model, name, 0)) for name in _COUNTS},
        "left_out": left_out,
    }


def _elements(model: Any, kind: str) -> list[dict[str, Any]]:
    """The elements of a kind, with their values by name."""
    type_, ends = _ELEMENTS[kind]
    columns = {end: _column(model, f"{kind}_{end}") for end in ends.split()}
    return [
        {
            "index": index,
            "name": "" if type_ is None else mujoco.mj_id2name(model, type_, index) or "",
            **{end: column[index] if column else [] for end, column in columns.items()},
        }
        for index in range(len(next(iter(columns.values()))))
    ]


def _column(model: Any, name: str) -> list[Any]:
    values = np.asarray(getattr(model, name, ())).tolist()
    kind = _ENUMERATIONS.get(name)
    return values if kind is None else [kind(value).name.rpartition("_")[2].lower() for value in values]


def _specification(path: str, folders: Folders) -> tuple[Any, dict[str, str]]:
    """What the file says; and by name of a mesh, why its file is not read.

    Each mesh names its file by an absolute path afterwards, so that MuJoCo opens the file that was looked at here.
    """
    spec = mujoco.MjSpec.from_file(path)
    # Both would drop bodies and shapes.
    spec.compiler.fusestatic = False
    spec.compiler.discardvisual = False
    faults = {}
    for mesh in spec.meshes:
        if mesh.file:
            file = _path(spec, mesh)
            if reason := _fault(mesh.file, file, folders):
                faults[mesh.name] = reason
            mesh.file = file
    spec.strippath = False
    return spec, faults


def _without_assets(spec: Any, faults: dict[str, str]) -> list[dict[str, str]]:
    """Remove the meshes with errors, textures that are files, skins and height fields, and what uses them."""
    left_out = []
    for texture in spec.textures:
        if texture.file or any(texture.cubefiles):
            texture.file, texture.cubefiles = "", [""] * len(texture.cubefiles)
            texture.builtin = mujoco.mjtBuiltin.mjBUILTIN_FLAT
            texture.width = texture.height = 1
            if texture.type != mujoco.mjtTexture.mjTEXTURE_2D:
                texture.height = 6
    for skin in list(spec.skins):
        left_out.append({"kind": "skin", "name": skin.name, "reason": "it is left out"})
        spec.delete(skin)
    gone = set()
    for geom in list(spec.geoms):
        field = geom.type == mujoco.mjtGeom.mjGEOM_HFIELD
        if not field and geom.meshname not in faults:
            continue
        if geom.meshname in faults and not geom.parent.explicitinertial and geom.parent.id != 0 and _weighs(spec, geom):
            reason = faults[geom.meshname]
            raise Refused(f"mesh '{geom.meshname}', of which body '{geom.parent.name}' gets its inertia: {reason}")
        if geom.name:
            gone.add(geom.name)
        kind = "height field" if field else "mesh"
        name = geom.hfieldname if field else geom.meshname
        left_out.append({"kind": kind, "name": name, "reason": faults.get(name, "it is left out")})
        spec.delete(geom)
    for pair in list(spec.pairs):
        if pair.geomname1 in gone or pair.geomname2 in gone:
            spec.delete(pair)
    for field in list(spec.hfields):
        spec.delete(field)
    for mesh in list(spec.meshes):
        if mesh.name in faults:
            spec.delete(mesh)
    return left_out


def _weighs(spec: Any, geom: Any) -> bool:
    """Whether the compiler takes the inertia of a body from a shape."""
    low, high = spec.compiler.inertiagrouprange
    return bool(low <= geom.group <= high) and geom.mass != 0.0 and not (math.isnan(geom.mass) and geom.density == 0.0)


def _path(spec: Any, mesh: Any) -> str:
    compiler = getattr(mesh, "compiler", spec.compiler)
    name = os.path.basename(mesh.file) if spec.strippath else mesh.file
    return os.path.abspath(os.path.join(spec.modelfiledir, compiler.meshdir or "", name))


def _fault(name: str, path: str, folders: Folders) -> str:
    """Why the file of a mesh is not read; empty if it is, as far as can be seen.

    Args:
        name: As the MJCF file writes it.
        path: Its absolute path.
        folders: Where it may be.
    """
    if not os.path.isfile(path):
        return f"its file '{name}' was not found"
    if not folders.contains(path):
        return f"its file '{name}' is outside the folder of the robot"
    size = os.path.getsize(path)
    if size > BYTES_LIMIT:
        return f"its file '{name}' has {size:,} bytes, and at most {BYTES_LIMIT:,} are read"
    with open(path, "rb") as stream:
        head = stream.read(84)
    if head.startswith(GIT_LFS):
        return f"its file '{name}' is a pointer of Git LFS; fetch the file with `git lfs pull`"
    if path.lower().endswith(".stl") and (len(head) < 84 or size != 84 + 50 * int.from_bytes(head[80:84], "little")):
        return f"its file '{name}' is not a binary STL"
    return ""


def _compile_error(mesh: Any) -> str:
    """Why MuJoCo refuses a mesh that is a file; empty if it does not."""
    if not mesh.file:
        return ""
    alone = mujoco.MjSpec()
    alone.add_mesh(name="m", file=mesh.file, scale=mesh.scale, inertia=mesh.inertia)
    alone.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="m")
    try:
        alone.compile()
    except ValueError as error:
        return f"MuJoCo cannot read its file '{os.path.basename(mesh.file)}': {' '.join(str(error).split())}"
    return ""


def _mesh(model: Any, mesh: Any) -> dict[str, Any]:
    """The file of a mesh, if a URDF can name it; else its content as OBJ, as it is in the model."""
    path = mesh.file
    moved = bool(np.any(mesh.refpos)) or not np.allclose(mesh.refquat, (1.0, 0.0, 0.0, 0.0), atol=0.0)
    if path.lower().endswith((".stl", ".obj")) and not moved:
        return {"path": path, "scale": np.asarray(mesh.scale).tolist(), "obj": ""}
    at, count = model.mesh_vertadr[mesh.id], model.mesh_vertnum[mesh.id]
    vertices = model.mesh_vert[at : at + count].tolist()
    at, count = model.mesh_faceadr[mesh.id], model.mesh_facenum[mesh.id]
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in model.mesh_face[at : at + count].tolist()]
    return {"path": path, "scale": [1.0, 1.0, 1.0], "obj": "\n".join(lines) + "\n"}


if __name__ == "__main__":
    main()
