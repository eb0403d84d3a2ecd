"""A case of the campaign: files, and for a call the arguments. The same seed and number always give the same case."""

from __future__ import annotations

import json
import random
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks.fuzz.calls import call_of
from benchmarks.fuzz.imports import FORMATS, import_of
from benchmarks.fuzz.mutators import mutate_mesh
from benchmarks.fuzz.parsers import BARE
from benchmarks.fuzz.robots import Seed, seeds
from benchmarks.fuzz.robots import case_of as robot_case

#: File of a finding that says what it is; the others are the files of the case.
FINDING = "finding.json"

#: File of a finding that says what became of it.
OUTCOME = "outcome.json"

_URDF = """<robot name="r"><link name="base"><visual><geometry><mesh filename="NAME"/></geometry></visual>
<collision><geometry><mesh filename="NAME"/></geometry></collision></link></robot>
"""

_CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))


@dataclass(frozen=True)
class Case:
    """What is tried.

    Attributes:
        kind: ``robot``, ``mesh``, ``call``, ``parsers``, or ``import-`` and the format of a file.
        title: What was damaged, and how.
        files: Contents by name.
        path: The file to check and load, or to import; empty for a call.
        call: Of a call, the robot, the function and its arguments as plain data.
    """

    kind: str
    title: str
    files: dict[str, bytes] = field(default_factory=dict)
    path: str = ""
    call: dict[str, Any] | None = None

    def write(self, folder: Path) -> None:
        """Write it into a folder: its files, and `FINDING`."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in self.files.items():
            (folder / name).write_bytes(content)
        said = {"kind": self.kind, "title": self.title, "path": self.path, "call": self.call}
        (folder / FINDING).write_text(json.dumps(said, indent=1) + "\n", encoding="utf-8")

    def with_file(self, name: str, content: bytes) -> Case:
        """The same case with another content of a file."""
        return replace(self, files={**self.files, name: content})


def read_case(folder: Path) -> Case:
    """The case that was written into a folder."""
    said = json.loads((folder / FINDING).read_text(encoding="utf-8"))
    names = sorted(path.name for path in folder.iterdir() if path.is_file() and path.name not in (FINDING, OUTCOME))
    files = {name: (folder / name).read_bytes() for name in names}
    return Case(said["kind"], said["title"], files, said["path"], said["call"])


#: Kinds of cases, each with its share of ten. The one without a share needs Node.js and runs only on request.
KINDS = {"robot": 5, "mesh": 2, "call": 2, "import": 1, "parsers": 0}


def case_of(seed: int, number: int, kind: str | None = None) -> Case:
    """A case of a seed, of one of `KINDS`; by default the case draws its kind."""
    chance = random.Random(f"{seed}:{number}")
    drawn = chance.choices(list(KINDS), list(KINDS.values()))[0]
    match kind or drawn:
        case "parsers":
            found = robot_case(seed, number, _robots())
            files = {"robot.yaml": BARE if found.description is None else found.description, "robot.urdf": found.urdf}
            return Case("parsers", found.title, files, "robot.yaml")
        case "robot":
            found = robot_case(seed, number, _robots())
            files = {"robot.urdf": found.urdf, "workbench.urdf": found.urdf}  # what the descriptions name
            if found.description is None:
                return Case("robot", found.title, files, "robot.urdf")
            return Case("robot", found.title, {**files, "robot.yaml": found.description}, "robot.yaml")
        case "mesh":
            name, content = chance.choice(list(_meshes().items()))
            urdf = _URDF.replace("NAME", name).encode()
            return Case("mesh", name, {"robot.urdf": urdf, name: mutate_mesh(content, chance)}, "robot.urdf")
        case "import":
            format_ = chance.choice(FORMATS)
            title, content = import_of(format_, chance)
            return Case(f"import-{format_}", title, {"robot.xml": content}, "robot.xml")
        case _:
            call = call_of(chance)
            return Case("call", f"{call['function']} of {call['robot']}", call=call)


@cache
def _robots() -> Sequence[Seed]:
    return seeds()


@cache
def _meshes() -> dict[str, bytes]:
    """A tetrahedron in each format that URDFs use, by file name."""
    points = [[_CORNERS[i] for i in face] for face in _FACES]
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*point) for point in face)
        + "endloop\nendfacet\n"
        for face in points
    )
    packed = b"".join(struct.pack("<12fH", 0, 0, 1, *(x for point in face for x in point), 0) for face in points)
    vertices = "".join("v {:g} {:g} {:g}\n".format(*corner) for corner in _CORNERS)
    faces = "".join("f {} {} {}\n".format(*(i + 1 for i in face)) for face in _FACES)
    corners = "".join("{:g} {:g} {:g}\n".format(*corner) for corner in _CORNERS)
    counted = "".join("3 {} {} {}\n".format(*face) for face in _FACES)
    ply = (
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face 4\nproperty list uchar int vertex_indices\nend_header\n{corners}{counted}"
    )
    return {
        "text.stl": f"solid t\n{facets}endsolid t\n".encode(),
        "binary.stl": b"\0" * 80 + struct.pack("<I", len(_FACES)) + packed,
        "mesh.obj": (vertices + faces).encode(),
        "mesh.off": f"OFF\n4 4 0\n{corners}{counted}".encode(),
        "mesh.ply": ply.encode(),
        "mesh.dae": _COLLADA.replace("POINTS", corners.replace("\n", " "))
        .replace("FACES", " ".join(f"{i}" for face in _FACES for i in face))
        .encode(),
    }


_COLLADA = """<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="a" count="12">POINTS</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>FACES</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""
