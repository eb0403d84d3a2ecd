"""Still pictures of a robot, rendered without a window by VTK (pyvista, extra ``pictures``; it needs OpenGL or EGL)."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from eurdf.array import Vector
from eurdf.convert.export import ASSEMBLED
from eurdf.diagnostics.extras import install_command
from eurdf.errors import MissingExtra
from eurdf.kinematics.residual import openings_once
from eurdf.pinocchio.robot import Robot
from eurdf.viewing.opened import opened
from eurdf.viewing.scene import Scene
from eurdf.viewing.surface import Surface
from eurdf.writing.atomic_file import write_atomically

Points = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
#: Red, green, blue, alpha from 0 to 1.
Color = tuple[float, ...]

_MOST_WIDTH, _MOST_HEIGHT = 780, 860  # of the picture, pixels
_MARGIN = 12  # around each view, pixels
# Pixels drawn for one of the picture, along each side: this smooths edges. SSAA of VTK makes lines and dots thinner.
_OVERSAMPLING = 4

_LINE = 2.5  # width of a line, pixels
_DOT = 12  # diameter of a dot, pixels
_TRANSLUCENT = 0.4  # opacity of shapes behind which closures are shown
_DARK = 0.15  # luminance below which colours are lightened: a picture is also seen on a dark page
_ROUNDS = 8  # of averaging the colours of a palette; later ones change no colour that is seen
_GAMMA = 2.2  # of colours; near enough to that of sRGB
_SKELETON: Color = (0.5, 0.5, 0.5)
_CLOSURE: Color = (0.55, 0.2, 0.8)
_OPEN: Color = (0.9, 0.1, 0.1)
_GAP = 0.08  # between the frames of a closure that is shown open, as a part of the size of the robot


#: A view without perspective: from the robot to the camera, in the world; any length.
View = tuple[float, float, float]

#: From the right, from the front right above, from behind.
VIEWS: tuple[View, ...] = ((0.0, -1.0, 0.0), (1.0, -0.75, 0.45), (-1.0, 0.3, 0.25))


def axes_of(view: View) -> Points:
    """Unit vectors to the right, up and toward the camera, in the world, as rows (3, 3)."""
    toward = np.array(view) / np.linalg.norm(view)
    right = np.cross((0.0, 0.0, 1.0), toward)
    right /= np.linalg.norm(right)
    return np.array((right, np.cross(toward, right), toward))


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """What a picture shows, in the world, m.

    Attributes:
        solids: Surfaces and their colours.
        lines: Lines (n, 2, 3) and their colours.
        dots: Points (n, 3) that are marked: the frames of the closures.
        points: All points (n, 3) that the picture has to contain.
    """

    solids: list[tuple[Surface, Color]]
    lines: list[tuple[Points, Color]]
    dots: Points
    points: Points


def picture(
    robot: Robot,
    views: Sequence[View] = VIEWS,
    *,
    q: Vector | None = None,
    loops: bool = False,
    apart: bool = False,
) -> Image:
    """Views of a robot side by side, all at one scale, on a transparent background.

    It shows the visual shapes, or lines from link to link if there are none.

    Args:
        robot: The robot, with its visual geometry.
        views: From where it is seen.
        q: Its configuration (nq,); by default ``assembled``, or the neutral one.
        loops: Whether to show the closures: dots at their frames, lines to them from the origins of their links, and,
            if a closure is open, a red line between its frames. The shapes are then translucent.
        apart: Whether to show the closures open, where the loops of the robot are cut: the frames of each are apart,
            and a line leads from one to the other.

    Returns:
        Pixels (height, width, 4): red, green, blue, alpha.

    Raises:
        MissingExtra: The extra ``pictures`` is not installed.
        InvalidRobot: A mesh is missing.
        ValueError: There is nothing to draw, or no closure to show open.
    """
    _renderer()
    shown = drawn(robot, q, loops or apart, apart)
    boxes = []
    for view in views:
        points = shown.points @ axes_of(view).T
        boxes.append((points.min(axis=0), points.max(axis=0)))
    sizes = [(high - low)[:2] for low, high in boxes]
    width, height = sum(size[0] for size in sizes), max(size[1] for size in sizes)
    scale = min(
        (_MOST_WIDTH - 2 * _MARGIN * len(views)) / max(width, 1e-3 * height),
        (_MOST_HEIGHT - 2 * _MARGIN) / max(height, 1e-3 * width),
    )
    rows = round(scale * height) + 2 * _MARGIN
    images = []
    for view, (low, high), size in zip(views, boxes, sizes, strict=True):
        pixels = round(scale * size[0]) + 2 * _MARGIN, rows
        images.append(seen(shown, view, (low + high) / 2.0, pixels, scale))
    return np.concatenate(images, axis=1)


def save_picture(image: Image, file: str | os.PathLike[str]) -> None:
    """Write pixels (height, width, 4) to a PNG file; an existing one is replaced.

    The file has a palette, which makes it small; each pixel gets the nearest of its colours.

    Raises:
        OSError: It cannot be written.
    """
    from PIL import Image as Pillow

    colors, indices = with_palette(image)
    indexed = Pillow.fromarray(indices)
    indexed.putpalette(colors.tobytes(), "RGBA")
    content = io.BytesIO()
    indexed.save(content, format="PNG", optimize=True)
    write_atomically(file, content.getvalue())


def with_palette(image: Image, most: int = 256) -> tuple[Image, Image]:
    """The palette of a picture, and the number of each pixel in it.

    Pillow's fast octree gives the first palette; each colour then becomes the average of the pixels nearest to it
    (Lloyd's algorithm). Distances are those of colours multiplied by alpha, so that transparent ones are alike.

    Args:
        image: Pixels (height, width, 4): red, green, blue, alpha.
        most: How many colours the palette has at most, at most 256.

    Returns:
        The colours (n, 4), and the indices (height, width).
    """
    from PIL import Image as Pillow

    picture = Pillow.fromarray(image)
    first = picture.quantize(most, method=Pillow.Quantize.FASTOCTREE, dither=Pillow.Dither.NONE)
    palette = _colors(np.unique(_premultiplied(first.convert("RGBA")))).astype(float)
    found, where, counts = np.unique(_premultiplied(picture), return_inverse=True, return_counts=True)
    colors = _colors(found)
    nearest = _nearest(colors, palette)
    for _ in range(_ROUNDS):
        weight = np.bincount(nearest, counts)
        sums = [np.bincount(nearest, counts * channel) for channel in colors.T]
        palette = (np.array(sums) / np.maximum(weight, 1)).T[weight > 0]
        nearest = _nearest(colors, palette)
    rounded = np.rint(palette).astype(np.uint8)
    straight = Pillow.frombuffer("RGBa", (len(rounded), 1), rounded).convert("RGBA")
    return np.asarray(straight)[0], nearest[where].reshape(image.shape[:2]).astype(np.uint8)


def _premultiplied(picture: Any) -> npt.NDArray[np.uint32]:
    """The colours (n,) of the pixels times alpha, each as one number."""
    return np.asarray(picture.convert("RGBa")).view(np.uint32).ravel()


def _colors(numbers: npt.NDArray[np.uint32]) -> Image:
    """The colours (n, 4) of such numbers."""
    return numbers.view(np.uint8).reshape(-1, 4)


def _nearest(colors: Image, palette: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
    """For each colour the number of the nearest one of the palette."""
    nearest: npt.NDArray[np.intp] = ((palette**2).sum(axis=1) - 2.0 * colors @ palette.T).argmin(axis=1)
    return nearest


def drawn(robot: Robot, q: Vector | None, loops: bool, apart: bool = False) -> Drawn:
    """What is shown of a robot; see `picture`, also for the errors."""
    visual_model = robot.visual_model  # raises if a mesh is missing
    if q is None:
        q = robot.configurations.get(ASSEMBLED)
    q = pin.neutral(robot.model) if q is None else q
    scene = Scene(robot, q)
    if apart:
        if not scene.links:
            raise ValueError("it has no closure to show open")
        q = opened(robot, q, _GAP * scene.size)
    placed = scene.at(q)
    solids: list[tuple[Surface, Color]] = []
    lines: list[tuple[Points, Color]] = []
    for part in scene.parts:
        if part.kind == "visual":
            vertices = part.vertices_at(placed)
            alpha = part.color[3] * (_TRANSLUCENT if loops else 1.0)
            solids.append((replace(part.surface, vertices=vertices), (*_lightened(part.color[:3]), alpha)))
    if visual_model is None or not solids:
        lines.append((scene.skeleton(placed), _SKELETON))
    dots = np.empty((0, 3))
    if loops:
        closures = scene.closure_lines(placed)
        dots = closures[:, 1].reshape(-1, 3)
        lines.append((closures[:, [0, 2]].reshape(-1, 2, 3), _CLOSURE))
        of = {opening.name: opening.is_open for opening in openings_once(robot, q)}
        is_open = np.array([of[link.name] for link in scene.links], dtype=bool)
        lines.append((closures[~is_open, 1], _CLOSURE))  # of a distance; those of other closures have no length
        lines.append((closures[is_open, 1], _CLOSURE if apart else _OPEN))
    points = [*(surface.vertices for surface, _ in solids), *(each.reshape(-1, 3) for each, _ in lines)]
    together = np.concatenate(points)
    if not (len(together) and np.ptp(together, axis=0).any()):
        raise ValueError("there is nothing to draw: it has no visual shapes, and all links are at one point")
    return Drawn(solids, lines, dots, together)


def _lightened(color: Color) -> Color:
    """A colour (3,) that is visible on black: a luminance y below `_DARK` becomes (y + `_DARK`) / 2."""
    light = np.array(color) ** _GAMMA
    luminance = float(light @ (0.2126, 0.7152, 0.0722))
    if luminance >= _DARK:
        return color
    toward_white = 0.5 * (_DARK - luminance) / (1.0 - luminance)
    return tuple(((light + toward_white * (1.0 - light)) ** (1.0 / _GAMMA)).tolist())


def _renderer() -> Any:
    """The renderer, pyvista, or `MissingExtra`."""
    if not os.environ.get("DISPLAY"):
        # Else VTK looks for a screen first, and says so.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    try:
        import pyvista
    except ImportError:
        command = install_command("pictures")
        raise MissingExtra(f"pictures need pyvista; install it with: {command}", "pictures") from None
    return pyvista


def seen(shown: Drawn, view: View, center: Points, pixels: tuple[int, int], scale: float) -> Image:
    """One view: pixels (height, width, 4).

    Args:
        shown: What is shown.
        view: From where it is seen.
        center: Of the view, seen along its axes, m.
        pixels: Width and height.
        scale: Pixels a metre.
    """
    from PIL import Image as Pillow

    pv = _renderer()
    plotter = pv.Plotter(off_screen=True, window_size=[_OVERSAMPLING * side for side in pixels], lighting="none")
    plotter.set_background("black")  # then the pixels of a transparent picture are colours times alpha
    for surface, color in shown.solids:
        faces = np.column_stack((np.full(len(surface.triangles), 3), surface.triangles))
        plotter.add_mesh(
            pv.PolyData(surface.vertices, faces),
            color=color[:3],
            opacity=color[3],
            smooth_shading=surface.smooth,
            ambient=0.32,
            diffuse=0.8,
            specular=0.1,
            specular_power=20.0,
        )
    for lines, color in shown.lines:
        long = lines[np.ptp(lines, axis=1).any(axis=1)]
        if len(long):
            plotter.add_lines(long.reshape(-1, 3), color=color, width=_LINE * _OVERSAMPLING)
    if len(shown.dots):
        plotter.add_points(
            shown.dots, color=_CLOSURE, point_size=_DOT * _OVERSAMPLING, render_points_as_spheres=True, lighting=False
        )
    axes = right, up, toward = axes_of(view)
    focus = center @ axes
    reach = float(np.linalg.norm(np.ptp(shown.points, axis=0)))
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
    plotter.disable_anti_aliasing()
    drawn_pixels = np.ascontiguousarray(plotter.screenshot(return_img=True, transparent_background=True))
    plotter.close()
    large = Pillow.frombuffer("RGBa", drawn_pixels.shape[1::-1], drawn_pixels)
    return np.asarray(large.resize(pixels, Pillow.Resampling.LANCZOS).convert("RGBA"))
