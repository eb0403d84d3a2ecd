"""A handle on a frame that the user drags: inverse kinematics moves the robot with it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.viewing.page import Page
from eurdf.viewing.scene import Placed

_NONE = "(none)"


class Gizmo:
    """The choice of a frame, and the handle on it."""

    def __init__(self, page: Page, before: Gizmo | None = None) -> None:
        """Add the choice to the container that is open.

        Args:
            page: The page.
            before: The one whose choice to keep, removed already.
        """
        self._page = page
        self._handle: Any = None
        self._held = False
        gui, scene = page.server.gui, page.shown.figure.scene
        self._places = {name: (body, pin.SE3.Identity()) for body, name in enumerate(scene.bodies)}
        self._places |= {name: (body, pose) for name, body, pose in scene.frames}
        kept = None if before is None else before.choice
        chosen = kept if kept in self._places else _NONE
        self._choice = gui.add_dropdown("drag frame", (_NONE, *self._places), initial_value=chosen)
        self._choice.on_update(lambda _: page.worker.ask("gizmo", self._put))
        self._turn = gui.add_checkbox("drag its orientation too", before is not None and before.turns)
        self._turn.on_update(lambda _: page.worker.ask("gizmo", self._put))
        if chosen != _NONE:
            self._put()

    @property
    def choice(self) -> str:
        """The chosen frame."""
        return str(self._choice.value)

    @property
    def turns(self) -> bool:
        """Whether the orientation is dragged too."""
        return bool(self._turn.value)

    def refresh(self, placed: Placed) -> None:
        """Bring the handle to its frame, unless the user holds it."""
        if self._handle is None or self._held:
            return
        body, in_body = self._places[str(self._choice.value)]
        pose = placed.pose(body) * in_body
        x, y, z, w = pin.SE3ToXYZQUAT(pose)[3:]
        self._handle.position, self._handle.wxyz = pose.translation, np.array((w, x, y, z))

    def remove(self) -> None:
        """Remove the handle."""
        if self._handle is not None:
            self._handle.remove()
            self._handle = None

    def _put(self) -> None:
        """Put a handle on the chosen frame."""
        self.remove()
        self._held = False
        if self._choice.value == _NONE:
            return
        scene = self._page.shown.figure.scene
        self._handle = self._page.server.scene.add_transform_controls(
            "/gizmo", scale=0.12 * scene.size, disable_rotations=not self._turn.value, depth_test=False
        )
        self._handle.on_update(self._dragged)
        self.refresh(scene.at(self._page.shown.session.q))

    def _dragged(self, event: Any) -> None:
        frame = str(self._choice.value)
        position = np.array(event.target.position, dtype=float)
        w, x, y, z = np.array(event.target.wxyz, dtype=float)
        target = pin.XYZQUATToSE3([*position, x, y, z, w]) if self._turn.value else position

        def drag() -> str | None:
            self._held = event.phase != "end"
            return self._page.shown.session.drag(frame, target)

        self._page.ask("drag", drag)
