"""The tab of what plays."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Literal

from eurdf.viewing.playback import Trajectory, gravity_frames, read_trajectory, sweep_frames, trajectory_frames
from eurdf.viewing.shown import Page

#: What can be played.
Kind = Literal["sweep", "gravity", "trajectory"]


class PlayTab:
    """A range of motion, gravity, a trajectory, and a button that pauses each; made as `MoveTab` is."""

    def __init__(self, page: Page, before: PlayTab | None = None) -> None:
        self._page = page
        self._frames: Iterator[float] | None = None
        self._plays: Kind | None = None
        gui, session = page.server.gui, page.shown.session
        actuated = [slider.joint for slider in session.sliders if slider.actuated]
        # `sweep` moves joints with one velocity.
        joints = tuple(name for name in actuated if actuated.count(name) == 1)
        self._joint: Any = None
        if joints:
            kept = None if before is None or before._joint is None else str(before._joint.value)
            self._joint = gui.add_dropdown("actuator", joints, initial_value=kept if kept in joints else joints[0])
            sweep = gui.add_button("sweep", hint="its range of motion, with the other actuators held")
            sweep.on_click(lambda _: self._sweep())
        self._losses: Any = gui.add_checkbox("damping and friction", before is None or bool(before._losses.value))
        self._holds: Any = None
        if page.shown.robot.mechanism.root == "floating":
            holds = before is None or before._holds is None or bool(before._holds.value)
            self._holds = gui.add_checkbox("hold the base", holds, hint="under gravity, keep the base where it is")
        for box in (self._losses, self._holds):
            if box is not None:
                box.on_update(lambda _: page.worker.ask("play", self._changed))
        gravity = gui.add_button("gravity", hint="let it move, with motors that exert no torque")
        gravity.on_click(lambda _: self._fall())
        upload = gui.add_upload_button("trajectory (CSV)", mime_type="text/csv", hint="columns: time, joints")
        upload.on_upload(lambda event: self._read(event.target.value))
        self._pause = gui.add_button("pause", disabled=True)
        self._pause.on_click(lambda _: page.worker.ask("play", self._toggle))

    def go_on(self, plays: Kind | None) -> None:
        """Play what another version of the robot played; a trajectory begins at its own configuration, so it ends."""
        if plays == "gravity":
            self._fall()
        elif plays == "sweep" and self._joint is not None:
            self._sweep()

    @property
    def plays(self) -> Kind | None:
        """What is played now."""
        return self._plays if self._page.worker.is_playing else None

    def refresh(self) -> None:
        """Bring the button to whether something plays."""
        playing = self._page.worker.is_playing
        self._pause.label = "pause" if playing or self._frames is None else "continue"
        self._pause.disabled = self._frames is None

    def play(self, trajectory: Trajectory) -> None:
        """Replay a trajectory."""
        self._start("trajectory", lambda: trajectory_frames(self._page.shown.session, trajectory, self._page.say))

    def _sweep(self) -> None:
        session, joint = self._page.shown.session, str(self._joint.value)
        index = next(index for index, slider in enumerate(session.sliders) if slider.joint == joint)
        self._start("sweep", lambda: sweep_frames(session, index, self._page.say))

    def _fall(self) -> None:
        def frames() -> Iterator[float]:
            losses, holds = bool(self._losses.value), self._holds is not None and bool(self._holds.value)
            return gravity_frames(self._page.shown.session, self._page.say, dissipation=losses, held=holds)

        self._start("gravity", frames)

    def _changed(self) -> None:
        """Let the robot fall again, as is chosen now, if it does."""
        if self.plays == "gravity":
            self._fall()

    def _read(self, file: Any) -> None:
        def read() -> None:
            try:
                trajectory = read_trajectory(file.content.decode("utf-8"), self._page.shown.robot)
            except ValueError as error:  # also text that is not UTF-8
                self._page.say(f"'{file.name}': {error}")
            else:
                self.play(trajectory)

        self._page.worker.ask("play", read)

    def _start(self, kind: Kind, frames: Callable[[], Iterator[float]]) -> None:
        def begin() -> None:
            self._frames, self._plays = self._to_the_end(frames()), kind
            self._page.worker.play(self._frames)

        self._page.worker.ask("play", begin)

    def _to_the_end(self, frames: Iterator[float]) -> Iterator[float]:
        """The frames; after the last one, or an error, there is nothing to pause."""
        try:
            yield from frames
        except Exception:
            self._frames = None
            raise
        self._frames = None
        self._page.shown.place()

    def _toggle(self) -> None:
        self._page.worker.play(None if self._page.worker.is_playing else self._frames)
        self._page.shown.place()
