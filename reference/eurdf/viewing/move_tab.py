"""The tab of what moves the robot: sliders, motions that close the loops, and a handle on a frame."""

from __future__ import annotations

from functools import partial
from itertools import count
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.diagnostics.wording import visible
from eurdf.kinematics.assembly import Assembly
from eurdf.viewing.scene import PlacedRobot, wxyz
from eurdf.viewing.shown import Page
from eurdf.writing.saved_configuration import CannotSave, ConfigurationExists

# Steps of a slider over its range, and decimals of its number.
_STEPS = 1000
_DECIMALS = 4

# The frame that is dragged if none is.
_NONE = "(none)"


class MoveTab:
    """Sliders of the actuators, and buttons that bring all joints elsewhere, in the container that is open.

    The choices of the tab before, which is removed already, are kept.
    """

    def __init__(self, page: Page, before: MoveTab | None = None) -> None:
        self._page = page
        gui, session = page.server.gui, page.shown.session
        self._sliders = [self._slider(index) for index in range(len(session.sliders))]
        reset = gui.add_button("reset", hint="the configuration at the start")
        reset.on_click(lambda _: page.ask("go", lambda: page.shown.session.reset()))
        assemble = gui.add_button("assemble", hint="close the loops near this configuration")
        assemble.on_click(lambda _: page.ask("go", self._assemble))
        self._choice = gui.add_dropdown("configuration", ("",))
        self._go = gui.add_button("go to configuration")
        self._go.on_click(lambda _: page.ask("go", self._go_to))
        self._list_configurations(None if before is None else str(before._choice.value))
        self._name: Any = None
        if page.files is not None and page.files.can_save:
            name = self._new_name() if before is None or before._name is None else str(before._name.value)
            self._name = gui.add_text("name", initial_value=name)
            self._name.on_update(lambda _: self._offer_to_replace(False))
            save = gui.add_button("save as configuration", hint="write the pose to the description")
            save.on_click(lambda _: page.ask("save", partial(self._save, replace=False)))
            self._replace = gui.add_button("replace", color="red", visible=False)
            self._replace.on_click(lambda _: page.ask("save", partial(self._save, replace=True)))
        self._gizmo: _Gizmo = _Gizmo(page, None if before is None else before._gizmo)

    def remove(self) -> None:
        """Remove what is not in the container."""
        self._gizmo.remove()

    def refresh(self, placed: PlacedRobot) -> None:
        """Bring the sliders and the handle to the state of the session."""
        self._gizmo.refresh(placed)
        session = self._page.shown.session
        for index, handle in enumerate(self._sliders):
            slider = session.sliders[index]
            value = min(max(session.value(index), slider.lower), slider.upper)
            if index != self._page.in_hand and abs(value - handle.value) > 0.5 * 10.0**-_DECIMALS:
                handle.value = value

    def _slider(self, index: int) -> Any:
        session = self._page.shown.session
        slider = session.sliders[index]
        follow = f"; {', '.join(slider.follow)} follows" if slider.follow else ""
        handle = self._page.server.gui.add_slider(
            f"{slider.label} ({slider.unit})",
            min=slider.lower,
            max=slider.upper,
            step=(slider.upper - slider.lower) / _STEPS,
            initial_value=min(max(session.value(index), slider.lower), slider.upper),
            disabled=slider.lower == slider.upper,
            hint=f"{slider.lower:.4g} to {slider.upper:.4g} {slider.unit}{follow}",
        )
        handle.precision = _DECIMALS

        def moved(event: Any) -> None:
            if event.client is not None:  # else it was set here
                value = float(event.target.value)
                self._page.ask(("slider", index), lambda: session.move(index, value), in_hand=index)

        handle.on_update(moved)
        return handle

    def _assemble(self) -> str | None:
        found: Assembly = self._page.shown.session.assemble()
        return None if found.closes else "no configuration was found that closes the loops; this is the least open one"

    def _save(self, *, replace: bool) -> str:
        files, session, name = self._page.files, self._page.shown.session, str(self._name.value)
        assert files is not None
        self._offer_to_replace(False)
        try:
            said = files.save(name, session, replace=replace)
        except ConfigurationExists as reason:
            self._offer_to_replace(True)
            return f"{reason}; 'replace' replaces it, or choose another name"
        except CannotSave as reason:
            return str(reason)
        self._list_configurations(name)
        self._name.value = self._new_name()
        return said

    def _offer_to_replace(self, offered: bool) -> None:
        self._replace.label = f"replace '{visible(str(self._name.value))}'"
        self._replace.visible = offered

    def _new_name(self) -> str:
        """A name that no configuration has."""
        return next(
            name for name in map("pose_{}".format, count(1)) if name not in self._page.shown.session.configurations
        )

    def _list_configurations(self, chosen: str | None) -> None:
        """List the named configurations, with one chosen if it is among them."""
        names = tuple(self._page.shown.session.configurations)
        self._choice.visible = self._go.visible = bool(names)
        if names:
            self._choice.options = names
            self._choice.value = chosen if chosen in names else names[0]

    def _go_to(self) -> None:
        session = self._page.shown.session
        session.show(session.configurations[str(self._choice.value)])


class _Gizmo:
    """The choice of a frame, and the handle on it."""

    def __init__(self, page: Page, before: _Gizmo | None = None) -> None:
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

    def refresh(self, placed: PlacedRobot) -> None:
        """Bring the handle to its frame, unless the user holds it."""
        if self._handle is None or self._held:
            return
        body, in_body = self._places[str(self._choice.value)]
        pose = placed.pose(body) * in_body
        self._handle.position, self._handle.wxyz = pose.translation, wxyz(pose)

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
