"""The tab of the sliders, and of the motions that close the loops."""

from __future__ import annotations

from functools import partial
from typing import Any

from eurdf.kinematics.assembly import Assembly
from eurdf.viewing.gizmo import Gizmo
from eurdf.viewing.page import Page
from eurdf.viewing.scene import Placed
from eurdf.viewing.session import ASSEMBLED
from eurdf.writing.saved_configuration import CannotSave

# Steps of a slider over its range, and decimals of its number.
_STEPS = 1000
_DECIMALS = 4


class MoveTab:
    """Sliders of the actuators, and buttons that bring all joints elsewhere."""

    def __init__(self, page: Page) -> None:
        """Add the controls to the container that is open."""
        self._page = page
        gui, robot = page.server.gui, page.shown.robot
        self._sliders = [self._slider(index) for index in range(len(page.shown.session.sliders))]
        reset = gui.add_button("reset", hint="the configuration at the start")
        reset.on_click(lambda _: page.ask("go", lambda: page.shown.session.reset()))
        assemble = gui.add_button("assemble", hint="close the loops near this configuration")
        assemble.on_click(lambda _: page.ask("go", self._assemble))
        if robot.configurations:
            names = tuple(robot.configurations)
            choice = gui.add_dropdown("configuration", names, initial_value=names[0])
            go = gui.add_button("go to configuration")
            go.on_click(lambda _: page.ask("go", partial(self._go_to, choice)))
        if page.files is not None and page.files.can_save:
            name = gui.add_text("name", initial_value=ASSEMBLED)
            save = gui.add_button("save as configuration", hint="write the pose to the description")
            save.on_click(lambda _: page.ask("save", partial(self._save, name)))
        self._gizmo = Gizmo(page)

    def remove(self) -> None:
        """Remove what is not in the container."""
        self._gizmo.remove()

    def refresh(self, placed: Placed) -> None:
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

    def _save(self, name: Any) -> str:
        files, session = self._page.files, self._page.shown.session
        assert files is not None
        try:
            return files.save(str(name.value), session)
        except CannotSave as reason:
            return str(reason)

    def _go_to(self, choice: Any) -> None:
        self._page.shown.session.go_to(str(choice.value))
