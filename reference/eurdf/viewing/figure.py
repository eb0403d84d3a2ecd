"""A robot in the scene of the page: its nodes there, and which of them are shown."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.viewing.scene import PlacedRobot, Scene, wxyz

if TYPE_CHECKING:
    import viser

#: What can be shown, by the label of its checkbox; and whether it is at first.
LAYERS = {
    "visual shapes": True,
    "collision shapes": False,
    "skeleton": False,
    "closures": True,
    "joint axes": False,
    "frames": False,
    "link frames": False,
    "inertia ellipsoids": False,
    "link names": False,
}

_LAYER_OF = {"visual": "visual shapes", "collision": "collision shapes", "inertia": "inertia ellipsoids"}

_Color = tuple[int, int, int]  # red, green, blue, 0 to 255
_SKELETON = (90, 90, 90)
_CLOSURE, _OPEN = (140, 60, 200), (230, 30, 30)
_PASSIVE, _ACTUATED, _DEPENDENT = (60, 130, 230), (20, 160, 60), (240, 140, 0)


class Figure:
    """One robot in the scene.

    Attributes:
        scene: What there is to draw.
        shown: Whether each layer is shown.
    """

    def __init__(self, server: viser.ViserServer, scene: Scene, placed: PlacedRobot, root: str, origin: Vector) -> None:
        """Add the nodes where they are, since pages show what is sent bit by bit: below a node of their own.

        Its name is ``root``, and the world of the robot has its origin (3,), m, there.
        """
        self.scene = scene
        self._api = server.scene
        self._root = self._api.add_frame(root, show_axes=False, position=origin)
        self._placed = placed
        self.shown = {**LAYERS, "skeleton": not scene.has_visuals}
        self._bodies = [
            # Names of links can be anything; those of nodes are paths.
            self._api.add_frame(f"{root}/body{number}", show_axes=False)
            for number in range(len(scene.bodies))
        ]
        self._place_bodies(np.arange(len(self._bodies)))  # before they have anything to show
        self._nodes: dict[str, list[Any]] = {layer: [] for layer in LAYERS}
        self._lines: dict[str, tuple[Any, Callable[[PlacedRobot], Matrix]]] = {}
        for number, part in enumerate(scene.parts):
            self._add(
                _LAYER_OF[part.kind],
                self._api.add_mesh_simple(
                    f"{root}/body{part.body}/{part.kind}{number}",
                    part.surface.vertices,
                    part.surface.triangles,
                    color=part.color[:3],
                    opacity=None if part.color[3] == 1.0 else part.color[3],
                    flat_shading=not part.surface.smooth,
                    side="double" if not part.surface.smooth else "front",
                    position=part.pose.translation,
                    wxyz=wxyz(part.pose),
                ),
            )
        for number, name in enumerate(scene.bodies):
            self._add("link names", self._api.add_label(f"{root}/body{number}/name", name))
        length = 0.05 * scene.size
        for number, (name, body, pose) in enumerate(scene.frames):
            place = {"position": pose.translation, "wxyz": wxyz(pose)}
            node = f"{root}/body{body}/frame{number}"
            self._add("frames", self._api.add_frame(node, axes_length=length, axes_radius=0.03 * length, **place))
            self._add("frames", self._api.add_label(f"{node}/name", name))
        self._axes = self._api.add_batched_axes(
            f"{root}/link_frames", placed.wxyzs, placed.origins, axes_length=length, axes_radius=0.03 * length
        )
        self._add("link frames", self._axes)
        self._add_lines(f"{root}/skeleton", "skeleton", [_SKELETON] * (len(scene.parents) - 1), 3.0, scene.skeleton)
        colors = [_ACTUATED if axis.actuated else _PASSIVE for axis in scene.axes]
        self._add_lines(f"{root}/axes", "joint axes", colors, 3.0, scene.axis_lines)
        self._are_open = np.zeros(len(scene.links), dtype=bool)
        colors = [_CLOSURE] * (3 * len(scene.links))
        self._add_lines(f"{root}/closures", "closures", colors, 2.0, self._closure_lines)
        self._dots: Any = None
        if scene.links:
            self._dots = self._api.add_point_cloud(
                f"{root}/closure_frames",
                self._closure_lines(placed)[1::3].reshape(-1, 3),
                colors=_CLOSURE,
                point_size=0.012 * scene.size,
                point_shape="circle",
                precision="float32",
            )
            self._add("closures", self._dots)
        self._labels = [
            self._api.add_label(f"{root}/closure{number}", link.name) for number, link in enumerate(scene.links)
        ]
        for label in self._labels:
            label.visible = False
        for layer, visible in self.shown.items():
            self.toggle(layer, visible)

    def has(self, layer: str) -> bool:
        """Whether there is anything in a layer."""
        return bool(self._nodes[layer])

    def place(self, placed: PlacedRobot) -> None:
        """Move everything to where it is now."""
        moved = (self._placed.poses != placed.poses).any(axis=1)
        self._placed = placed
        self._place_bodies(np.flatnonzero(moved))
        self._place_shared()
        self._place_labels()

    def toggle(self, layer: str, visible: bool) -> None:
        """Show or hide a layer."""
        self.shown[layer] = visible
        if visible:
            self._place_shared()
        for node in self._nodes[layer]:
            node.visible = visible
        if layer == "closures":
            self._place_labels()

    def highlight(self, joints: frozenset[str]) -> None:
        """Show the axes of dependent actuators in their own colour."""
        if "joint axes" not in self._lines:
            return
        colors = [
            _DEPENDENT if axis.joint in joints else _ACTUATED if axis.actuated else _PASSIVE for axis in self.scene.axes
        ]
        self._lines["joint axes"][0].colors = _line_colors(colors)

    def remove(self) -> None:
        """Remove all of its nodes."""
        self._root.remove()

    def _add(self, layer: str, node: Any) -> None:
        self._nodes[layer].append(node)

    def _add_lines(
        self, name: str, layer: str, colors: list[_Color], pixels: float, at: Callable[[PlacedRobot], Matrix]
    ) -> None:
        if not colors:
            return
        node = self._api.add_line_segments(
            name,
            at(self._placed),
            colors=_line_colors(colors),
            thickness=pixels,
            thickness_units="screen",
        )
        self._add(layer, node)
        self._lines[layer] = node, at

    def _place_bodies(self, bodies: Indices) -> None:
        origins, wxyzs = self._placed.origins, self._placed.wxyzs
        for number in bodies:
            node = self._bodies[number]
            # viser sends no change of less than 1e-5 of a value; nothing is that close to what is no number.
            node.position[:], node.wxyz[:] = np.nan, np.nan
            node.position, node.wxyz = origins[number], wxyzs[number]

    def _closure_lines(self, placed: PlacedRobot) -> Matrix:
        return self.scene.closure_lines(placed).reshape(-1, 2, 3)

    def _place_shared(self) -> None:
        """Move what is one node for the whole robot, as far as it is shown."""
        placed = self._placed
        for layer, (node, at) in self._lines.items():
            if self.shown[layer]:
                node.points = at(placed)
        if self._dots is not None and self.shown["closures"]:
            self._dots.points = self._closure_lines(placed)[1::3].reshape(-1, 3)
            self._color_closures(placed)
        if self.shown["link frames"]:
            self._axes.batched_positions, self._axes.batched_wxyzs = placed.origins, placed.wxyzs

    def _color_closures(self, placed: PlacedRobot) -> None:
        """Show the line from A to B of an open closure in its own colour; a closed distance closure has a line too."""
        of = {opening.name: opening.is_open for opening in placed.openings}
        are_open = np.array([of[link.name] for link in self.scene.links], dtype=bool)
        if (are_open == self._are_open).all():
            return
        self._are_open = are_open
        colors = [color for is_open in are_open for color in (_CLOSURE, _OPEN if is_open else _CLOSURE, _CLOSURE)]
        self._lines["closures"][0].colors = _line_colors(colors)

    def _place_labels(self) -> None:
        """Label each open closure with how far it is open."""
        placed = self._placed
        if not self._labels:
            return
        openings = {opening.name: opening for opening in placed.openings}
        for label, link in zip(self._labels, self.scene.links, strict=True):
            opening = openings[link.name]
            visible = self.shown["closures"] and opening.is_open
            if visible:
                label.text = str(opening)
                body, pose = link.bodies[0], link.poses[0]
                label.position = placed.pose(body).act(pose.translation)
            if label.visible != visible:
                label.visible = visible


def _line_colors(colors: list[_Color]) -> Any:
    return np.repeat(np.array(colors, dtype=np.uint8)[:, None], 2, axis=1)
