"""What the server of a viewer plays: one motion at a time, which can be paused."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from eurdf.viewing.messages import Playing
from eurdf.viewing.playback import GravityPlayback, TrajectoryPlayback
from eurdf.viewing.worker import Worker

Playback = GravityPlayback | TrajectoryPlayback


class Player:
    """Plays a motion between the tasks of a worker; all but the properties is for the worker's thread."""

    def __init__(self, worker: Worker, tell: Callable[[Playing], None]) -> None:
        """Play nothing; ``tell`` is called with each change."""
        self._worker, self._tell = worker, tell
        self._playback: Playback | None = None
        self._frames: Iterator[float] | None = None
        self._paused = self._steps = False

    @property
    def playing(self) -> Playing:
        """What is played."""
        each = self._playback
        if each is None:
            return Playing()
        return Playing(each.what, self._paused, each.time, each.duration, each.speed, each.pace)

    @property
    def gravity(self) -> GravityPlayback | None:
        """The fall, if it is played."""
        return self._playback if isinstance(self._playback, GravityPlayback) and not self._paused else None

    def play(self, playback: Playback | None) -> None:
        """Play a motion from its begin, in place of another; None plays nothing."""
        self._playback, self._frames = playback, None
        self.pause(playback is None)

    def pause(self, paused: bool = True, *, step: bool = False) -> None:
        """Pause, or go on; for one frame only, if ``step``."""
        self._paused, self._steps = paused, step
        each = self._playback
        if each is not None and not paused:
            if each.duration is not None and each.time >= each.duration:
                each.time = 0.0
            self._frames = self._frames or each.frames()
            self._worker.play(self._told(self._frames))
        else:
            self._worker.play(None)
        self._tell(self.playing)

    def seek(self, time: float, speed: float) -> None:
        """Go to a time of the trajectory that is played, s, and play it with another speed from then on.

        Raises:
            ValueError: The speed is not positive.
        """
        if speed <= 0.0:
            raise ValueError(f"the speed is {speed:g}; it must be positive")
        each = self._playback
        if isinstance(each, TrajectoryPlayback):
            each.time, each.speed = min(max(time, 0.0), each.duration), speed
            if self._paused:
                self._worker.play(self._shown(each))

    def _shown(self, trajectory: TrajectoryPlayback) -> Iterator[float]:
        yield from trajectory.at_time()
        self._tell(self.playing)

    def _told(self, frames: Iterator[float]) -> Iterator[float]:
        """Pass on the frames of a motion, and tell pages where it is; pause it at its end."""
        each = self._playback
        assert each is not None
        time = each.time
        try:
            for wait in frames:
                if each.time != time:
                    time = each.time
                    self._tell(self.playing)
                    if self._steps:
                        self.pause()
                yield wait
        except Exception:
            self.play(None)
            raise
        self._frames = None
        self.pause()
