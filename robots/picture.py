"""Draws the picture of a robot: ``python -m robots.picture NAME…|--all [-o FILE]``.

The picture shows the visual shapes of the loaded robot, in the colours of their materials, in its assembled pose. It
is rendered by VTK, which ``pip install -e ".[pictures]"`` brings; it needs no screen, but OpenGL or EGL.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import coal
import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from eurdf.collection import collection_names, find_robot

if TYPE_CHECKING:
    import pyvista as pv

Points = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

_MOST_WIDTH, _MOST_HEIGHT = 780, 860  # of the picture, pixels
_MARGIN = 12  # around each view, pixels
_OVERSAMPLING = 2  # pixels drawn for one of the picture, along each side: VTK smooths edges, and this does the rest
_COLORS = 255  # of the picture: enough for primitives, and it keeps the file small


@dataclass(frozen=True, slots=True)
class View:
    """A view without perspective.

    Attributes:
        toward_camera: From the robot to the camera, in the world; any length.
    """

    toward_camera: tuple[float, float, float]

    @property
    def axes(self) -> Points:
        """Unit vectors to the right, up and toward the camera, in the world, as rows (3, 3)."""
        toward = np.array(self.toward_camera) / np.linalg.norm(self.toward_camera)
        right = np.cross((0.0, 0.0, 1.0), toward)
        right /= np.linalg.norm(right)
        return np.array((right, np.cross(toward, right), toward))


#: From the right, from the front right above, from behind.
VIEWS = (View((0.0, -1.0, 0.0)), View((1.0, -0.75, 0.45)), View((-1.0, 0.3, 0.25)))


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A visual shape in the world.

    Attributes:
        mesh: Its surface, m.
        color: Red, green, blue, alpha from 0 to 1.
        round: Whether its faces approximate a curved surface.
    """

    mesh: pv.PolyData
    color: tuple[float, ...]
    round: bool


def picture(robot: eurdf.Robot, views: Sequence[View] = VIEWS) -> Image:
    """The views of a robot side by side, all at one scale, on white.

    Args:
        robot: The robot, with its visual geometry.
        views: From where it is seen.

    Returns:
        Pixels (height, width, 3).

    Raises:
        ValueError: It has no visual shapes.
    """
    solids = solids_of(robot)
    if not solids:
        raise ValueError("it has no visual shapes")
    points = np.concatenate([solid.mesh.points for solid in solids])
    boxes = []
    for view in views:
        seen = points @ view.axes.T
        boxes.append((seen.min(axis=0), seen.max(axis=0)))
    sizes = [(high - low)[:2] for low, high in boxes]
    width, height = sum(size[0] for size in sizes), max(size[1] for size in sizes)
    scale = min((_MOST_WIDTH - 2 * _MARGIN * len(views)) / width, (_MOST_HEIGHT - 2 * _MARGIN) / height)
    rows = round(scale * height) + 2 * _MARGIN
    images = []
    for view, (low, high), size in zip(views, boxes, sizes, strict=True):
        pixels = round(scale * size[0]) + 2 * _MARGIN, rows
        images.append(_seen(solids, view, (low + high) / 2.0, pixels, scale))
    return np.concatenate(images, axis=1)


def solids_of(robot: eurdf.Robot) -> list[Solid]:
    """The visual shapes of a robot in the world, at its assembled configuration; else at its neutral one."""
    if robot.visual_model is None:
        return []
    q = robot.configurations.get("assembled")
    visual_data = robot.visual_model.createData()
    q = pin.neutral(robot.model) if q is None else q
    pin.updateGeometryPlacements(robot.model, robot.data, robot.visual_model, visual_data, q)
    solids = []
    for shape, oMg in zip(robot.visual_model.geometryObjects, visual_data.oMg, strict=True):
        mesh = _surface(shape.geometry).transform(oMg.homogeneous, inplace=False)
        faceted = isinstance(shape.geometry, coal.Box | coal.BVHModelBase)
        solids.append(Solid(mesh, tuple(map(float, np.clip(shape.meshColor, 0.0, 1.0))), not faceted))
    return solids


def _surface(geometry: Any) -> pv.PolyData:
    """The surface of a shape in its own frame, m."""
    import pyvista as pv

    if isinstance(geometry, coal.Box):
        x, y, z = geometry.halfSide
        return pv.Box((-x, x, -y, y, -z, z))
    if isinstance(geometry, coal.Sphere):
        return pv.Sphere(radius=geometry.radius, theta_resolution=48, phi_resolution=48)
    if isinstance(geometry, coal.Cylinder | coal.Capsule):
        draw = pv.Cylinder if isinstance(geometry, coal.Cylinder) else pv.Capsule
        height = {"height" if draw is pv.Cylinder else "cylinder_length": 2.0 * geometry.halfLength}
        return draw(direction=(0.0, 0.0, 1.0), radius=geometry.radius, resolution=48, **height)
    triangles = [geometry.tri_indices(index) for index in range(geometry.num_tris)]
    faces = np.array([(3, triangle[0], triangle[1], triangle[2]) for triangle in triangles])
    return pv.PolyData(np.asarray(geometry.vertices()), faces)


def _seen(solids: Sequence[Solid], view: View, center: Points, pixels: tuple[int, int], scale: float) -> Image:
    """One view of the shapes: pixels (height, width, 3).

    Args:
        solids: The shapes.
        view: From where they are seen.
        center: Of the view, seen along its axes, m.
        pixels: Width and height.
        scale: Pixels a metre.
    """
    import pyvista as pv
    from PIL import Image as Pillow

    plotter = pv.Plotter(off_screen=True, window_size=[_OVERSAMPLING * side for side in pixels], lighting="none")
    plotter.set_background("white")
    for solid in solids:
        plotter.add_mesh(
            solid.mesh,
            color=solid.color[:3],
            opacity=solid.color[3],
            smooth_shading=solid.round,
            split_sharp_edges=solid.round,
            ambient=0.32,
            diffuse=0.8,
            specular=0.1,
            specular_power=20.0,
        )
    right, up, toward = view.axes
    focus = center @ view.axes
    reach = float(np.linalg.norm(np.ptp(np.concatenate([solid.mesh.points for solid in solids]), axis=0)))
    # Over the viewer's left shoulder, and a weak one from the other side, so that no side is black.
    for direction, intensity in ((-0.4 * right + 0.4 * up + toward, 0.75), (right - 0.3 * up + 0.6 * toward, 0.35)):
        light = pv.Light(light_type="scene light", intensity=intensity)
        light.position, light.focal_point = focus + reach * direction, focus
        plotter.add_light(light)
    camera = plotter.camera
    camera.parallel_projection = True
    camera.focal_point, camera.position, camera.up = focus, focus + 2.0 * reach * toward, up
    camera.parallel_scale = pixels[1] / scale / 2.0
    camera.clipping_range = (0.5 * reach, 3.5 * reach)
    plotter.enable_anti_aliasing("ssaa")
    drawn = plotter.screenshot(return_img=True)
    plotter.close()
    return np.asarray(Pillow.fromarray(drawn).resize(pixels, Pillow.Resampling.LANCZOS))


def save(image: Image, file: Path) -> None:
    """Writes pixels (height, width, 3) as a PNG."""
    from PIL import Image as Pillow

    palette = Pillow.fromarray(image).quantize(_COLORS, kmeans=1, dither=Pillow.Dither.NONE)
    palette.save(file, optimize=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Draws the pictures; 0 if all are drawn, 1 if a robot cannot be, 2 if nothing can."""
    parser = argparse.ArgumentParser("python -m robots.picture", description="Draw pictures of robots.")
    parser.add_argument("robots", nargs="*", metavar="ROBOT", help="name of one of the collection, or a folder")
    parser.add_argument("--all", action="store_true", help="every robot of the collection")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="in place of picture.png in its folder")
    options = parser.parse_args(arguments)
    robots = collection_names() if options.all else options.robots
    if not robots:
        parser.error("name a robot, or say --all")
    if options.output and len(robots) > 1:
        parser.error("-o takes one robot")
    if not os.environ.get("DISPLAY"):
        # Else VTK looks for a screen first, and says so.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        import pyvista  # noqa: F401
    except ImportError as missing:
        print(f'{missing}: pictures need pyvista; pip install -e ".[pictures]"', file=sys.stderr)
        return 2
    failed = False
    for robot in robots:
        try:
            files = find_robot(robot)
            found = files.description or files.urdf
            folder = found.parent if isinstance(found, Path) else Path()
            file = options.output or folder / "picture.png"
            save(picture(eurdf.load(robot)), file)
        except (eurdf.EurdfError, ValueError, OSError) as error:
            failed = True
            print(f"{robot}: {error}", file=sys.stderr)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
