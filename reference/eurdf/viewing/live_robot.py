"""A robot on a page that moves it without a server: its two files, its meshes, and the script that reads them."""

from __future__ import annotations

import base64
import html
import json
import posixpath
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from eurdf.array import Vector
from eurdf.convert.export import files_of_meshes
from eurdf.linking.mesh_files import find_meshes
from eurdf.linking.robot_files import read_valid
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mesh_files.folders import folders_of_files
from eurdf.mesh_files.kinds import suffix_of
from eurdf.mesh_files.reader import MeshReader, RefusedFile
from eurdf.reading.robot_source import RobotSource
from eurdf.viewing.page_files import page_file
from eurdf.writing.description import describe_mechanism

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_HELP = (
    "Drag a part: it follows, and the loops stay closed. Drag beside it to turn the view, with the right button to "
    "shift it; scroll or pinch to zoom. Space plays, R resets, Ctrl+Z undoes."
)


class PageRobot(NamedTuple):
    """What a page shows a robot from.

    Attributes:
        name: Name of the robot.
        urdf: The text of its URDF.
        description: That of its YAML file; None for a bare URDF.
        meshes: The content of the mesh files, by the name in the URDF.
        left_out: Why a mesh is not among them, by the name in the URDF.
        q: The coordinates of the joints to start at, as configurations in files have them; None for ``assembled``, or
            a closed configuration that the page finds.
    """

    name: str
    urdf: str
    description: str | None
    meshes: Mapping[str, bytes]
    left_out: Mapping[str, str]
    q: Mapping[str, Sequence[float]] | None = None


def page_robot(path: RobotSource, root: Any = None, **options: Any) -> PageRobot:
    """The files of a robot; for the arguments see `eurdf.load`.

    They are the texts as they were read, unless the arguments say something else than they do, or a xacro was expanded.

    Raises:
        InvalidRobot: The robot has errors.
        RobotNotFound: There are no such files.
    """
    read = read_valid(path, root=root, **options)
    urdf = read.urdf.document.source.text
    description = None if read.yaml is None else read.yaml.document.source.text
    stated = "fixed" if read.yaml is None else read.yaml.root
    if read.mechanism.root != stated or not options.get("mimic", True):
        urdf, description = _texts(read.mechanism)
    folders = {key: options[key] for key in ("package_dirs", "confined", "allow_outside") if key in options}
    found = find_meshes(read.urdf, **folders)
    names = [shape.filename for shape in read.urdf.shapes if shape.filename]
    meshes, left_out = _meshes(MeshReader(found.folders), {name: found.paths.get(name) for name in names})
    return PageRobot(read.mechanism.name, urdf, description, meshes, left_out)


def page_robot_of(robot: Robot, q: Vector | None = None) -> PageRobot:
    """A robot in memory, at a configuration q (nq,); its files are written anew.

    Raises:
        NotWritable: They cannot say what the mechanism says.
    """
    urdf, description = _texts(robot.mechanism)
    paths = {name: str(path) for name, path in files_of_meshes(robot).items()}
    folders = folders_of_files(paths.values(), allow_outside=True)
    meshes, left_out = _meshes(MeshReader(folders), paths)
    start = None if q is None else robot.joint_positions(q)
    return PageRobot(robot.mechanism.name, urdf, description, meshes, left_out, start)


def _texts(mechanism: Mechanism) -> tuple[str, str]:
    files = describe_mechanism(mechanism)
    return files.urdf.decode(), files.yaml


def _meshes(reader: MeshReader, paths: Mapping[str, str | None]) -> tuple[dict[str, bytes], dict[str, str]]:
    """The content of mesh files and of the buffers that those of glTF name, by name in the URDF; why others are not."""
    meshes: dict[str, bytes] = {}
    left_out: dict[str, str] = {}
    for name, path in paths.items():
        try:
            if path is None:
                raise RefusedFile("it was not found, or is outside the robot's folder")
            file = reader.read(path)
        except RefusedFile as reason:
            left_out[name] = str(reason)
            continue
        meshes[name] = file.content
        if suffix_of(path) in (".gltf", ".glb"):
            meshes |= {posixpath.join(posixpath.dirname(name), other): data for other, data in file.others.items()}
    return meshes, left_out


def live_page(robot: PageRobot) -> str:
    """A page that moves a robot without a server and without a network: one file.

    Raises:
        FileNotFoundError: The script of the page is not built.
    """
    name = html.escape(robot.name)
    return (
        f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>{name}</title>'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<style>{page_file("page.css")}</style></head><body class="eu-alone">'
        f"<main><h1>{name}</h1>{live_view(robot)}</main><footer>{_HELP}</footer>"
        f"<script>{page_file('page.js')}</script></body></html>\n"
    )


def live_view(robot: PageRobot) -> str:
    """HTML for a page that loads ``page.js`` and ``page.css``: the robot, and a slider for each actuator.

    No text in it can be taken for markup.
    """
    content = {
        "urdf": {"name": "robot.urdf", "text": robot.urdf},
        "description": robot.description and {"name": "robot.yaml", "text": robot.description},
        "meshes": {name: base64.b64encode(data).decode() for name, data in robot.meshes.items()},
        "q": robot.q,
    }
    data = json.dumps(content, separators=(",", ":")).replace("<", "\\u003c")
    return f'<div class="eu-live"><script type="application/json">{data}</script></div>'
