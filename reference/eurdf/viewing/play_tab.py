"""The tab of what plays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from eurdf.viewing.page import Page
from eurdf.viewing.playback import gravity_frames, sweep_frames, trajectory_frames
from eurdf.viewing.trajectory import Trajectory, read_trajectory


class PlayTab:
    """A range of motion, gravity, a trajectory; and a button that pauses each."""

    def __init__(self, page: Page) -> None:
        """Add the controls to the container that is open."""
        self._page = page
        self._frames: Iterator[float] | None = None
        gui, session = page.server.gui, page.shown.session
        actuated = [slider.joint for slider in session.sliders if slider.actuated]
        # `sweep` moves joints with one velocity.
        joints = tuple(name for name in actuated if actuated.count(name) == 1)
        if joints:
            choice = gui.add_dropdown("actuator", joints, initial_value=joints[0])
            gui.add_button("sweep", hint="its range of motion, with the other actuators held").on_click(
                lambda _: self._sweep(str(choice.value))
            )
        losses = gui.add_checkbox("damping and friction", True)
        gui.add_button("gravity", hint="let it move, with motors that exert no torque").on_click(
            lambda _: self._start(lambda: gravity_frames(session, page.say, dissipation=bool(losses.value)))
        )
        upload = gui.add_upload_button("trajectory (CSV)", mime_type="text/csv", hint="columns: time, joints")
        upload.on_upload(lambda event: self._read(event.target.value))
        self._pause = gui.add_button("pause", disabled=True)
        self._pause.on_click(lambda _: page.worker.ask("play", self._toggle))

    def refresh(self) -> None:
        """Bring the button to whether something plays."""
        playing = self._page.worker.is_playing
        self._pause.label = "pause" if playing or self._frames is None else "continue"
        self._pause.disabled = self._frames is None

    def play(self, trajectory: Trajectory) -> None:
        """Replay a trajectory."""
        self._start(lambda: trajectory_frames(self._page.shown.session, trajectory, self._page.say))

    def _sweep(self, joint: str) -> None:
        session = self._page.shown.session
        index = next(index for index, slider in enumerate(session.sliders) if slider.joint == joint)
        self._start(lambda: sweep_frames(session, index, self._page.say))

    def _read(self, file: Any) -> None:
        def read() -> None:
            try:
                trajectory = read_trajectory(file.content.decode("utf-8"), self._page.shown.robot)
            except ValueError as error:  # also text that is not UTF-8
                self._page.say(f"'{file.name}': {error}")
            else:
                self.play(trajectory)

        self._page.worker.ask("play", read)

    def _start(self, frames: Callable[[], Iterator[float]]) -> None:
        def begin() -> None:
            self._frames = frames()
            self._page.worker.play(self._frames)

        self._page.worker.ask("play", begin)

    def _toggle(self) -> None:
        self._page.worker.play(None if self._page.worker.is_playing else self._frames)
        self._page.shown.place()
