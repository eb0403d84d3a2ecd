"""What the controls of the page share."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from eurdf.viewing.files import RobotOnDisk
from eurdf.viewing.shown import ShownRobot
from eurdf.viewing.worker import Worker

if TYPE_CHECKING:
    import viser


@dataclass(slots=True, eq=False)
class Page:
    """A page with one robot that has controls.

    Attributes:
        server: The server of the page.
        worker: Does all that changes the state.
        shown: The robot.
        files: Where the robot comes from, if from files.
        messages: What the user should know, below the state of the loops.
        in_hand: Index of the slider that the user moves; it is not moved under the hand.
    """

    server: viser.ViserServer
    worker: Worker
    shown: ShownRobot
    files: RobotOnDisk | None
    messages: tuple[str, ...] = ()
    in_hand: int | None = field(default=None, init=False)

    def ask(self, key: Hashable, motion: Callable[[], Any], *, in_hand: int | None = None) -> None:
        """Have the user's motion done soon, in place of an earlier one of the same key; what is played stops.

        Args:
            key: What the motion is of.
            motion: Changes the session, and returns what to tell the user, or None.
            in_hand: Index of the slider that is moved, if one is.
        """

        def done() -> None:
            self.worker.play(None)
            said = motion()
            self.messages = () if said is None else (str(said),)
            self.in_hand = in_hand if said is None else None
            self.shown.place()
            self.in_hand = None

        self.worker.ask(key, done)

    def say(self, *messages: str) -> None:
        """Show messages, in place of those before; for the thread of the worker."""
        self.messages = messages
        self.shown.place()
