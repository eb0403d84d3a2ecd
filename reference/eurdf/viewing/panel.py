"""The panel of the page: the state of the loops, what can be done, and what is known of the robot."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial
from typing import Any

from eurdf.errors import EurdfError, InvalidRobot
from eurdf.kinematics.analysis import analyze
from eurdf.transmissions.passive_limits import passive_limits
from eurdf.viewing import text
from eurdf.viewing.figure import LAYERS
from eurdf.viewing.graph import graph_svg
from eurdf.viewing.move_tab import MoveTab
from eurdf.viewing.play_tab import PlayTab
from eurdf.viewing.playback import Trajectory
from eurdf.viewing.scene import PlacedRobot
from eurdf.viewing.shown import Page

# Time between looks at the files, s.
_LOOK = 0.5
# Time without a motion after which the singularity and the limits are computed, s.
_PAUSE = 0.25


class Panel:
    """The controls and texts of one robot."""

    def __init__(self, page: Page) -> None:
        """Add them."""
        self._page = page
        gui = page.server.gui
        self._farthest = 0.0  # the largest distance to singularity met
        self._later: threading.Timer | None = None
        self._closed = threading.Event()
        self._status = gui.add_html("")
        tabs = gui.add_tab_group()
        self._tabs: dict[str, Any] = {
            name: tabs.add_tab(name) for name in ("Move", "Play", "Show", "Robot", "Limits", "Graph")
        }
        self._folders: dict[str, Any] = {}
        self._move: Any = None
        self._play: Any = None
        with self._tabs["Robot"]:
            self._gauge = gui.add_html("")
            self._bar = gui.add_progress_bar(0.0)
            self._dimensions = gui.add_html("")
            self._diagnostics = gui.add_html("")
        with self._tabs["Limits"]:
            self._limits = gui.add_html("")
        with self._tabs["Graph"]:
            self._graph = gui.add_html("")
        self._fill()
        page.shown.on_place = self._refresh
        if page.files is not None:
            threading.Thread(target=self._watch, name="eurdf viewer files", daemon=True).start()

    def play(self, trajectory: Trajectory) -> None:
        """Replay a trajectory."""
        self._play.play(trajectory)

    def close(self) -> None:
        """Stop what runs in the background."""
        self._closed.set()
        if self._later is not None:
            self._later.cancel()

    def _fill(self) -> None:
        """Make the controls and texts that depend on the robot; what the user chose is kept."""
        session, robot = self._page.shown.session, self._page.shown.robot
        if self._move is not None:
            self._move.remove()
        self._move = self._in_tab("Move", lambda: MoveTab(self._page, self._move))
        self._play = self._in_tab("Play", lambda: PlayTab(self._page, self._play))
        self._in_tab("Show", self._checkboxes)
        self._dimensions.content = text.dimensions(session.analysis)
        self._diagnostics.content = text.diagnostics(robot.diagnostics)
        self._graph.content = f'<div style="overflow-x: auto; padding: 2px 8px">{graph_svg(robot.mechanism)}</div>'
        self._farthest = 0.0

    def _in_tab(self, name: str, make: Callable[[], Any]) -> Any:
        """Make controls in a tab, in place of those that are there."""
        if name in self._folders:
            self._folders[name].remove()
        with self._tabs[name]:
            folder = self._folders[name] = self._page.server.gui.add_folder(None)
        with folder:
            return make()

    def _checkboxes(self) -> None:
        figure = self._page.shown.figure
        for layer in filter(figure.has, LAYERS):
            box = self._page.server.gui.add_checkbox(layer, figure.shown[layer])
            box.on_update(partial(self._toggle, layer))

    def _toggle(self, layer: str, event: Any) -> None:
        wanted = bool(event.target.value)
        self._page.worker.ask(("layer", layer), lambda: self._page.shown.figure.toggle(layer, wanted))

    def _refresh(self, placed: PlacedRobot) -> None:
        """Bring sliders and texts to the state of the session."""
        self._move.refresh(placed)
        self._play.refresh()
        self._status.content = text.status(self._page.shown.session.residual, placed.openings, self._page.messages)
        if self._later is not None:
            self._later.cancel()
        self._later = threading.Timer(_PAUSE, lambda: self._page.worker.ask("analysis", self._analyze))
        self._later.daemon = True
        self._later.start()

    def _analyze(self) -> None:
        """Show how far the configuration is from singular, and the limits of the passive joints there."""
        session = self._page.shown.session
        analysis = analyze(session.robot, session.q)
        self._gauge.content = text.gauge(analysis)
        value = analysis.singularity
        self._bar.visible = value is not None
        if value is not None:
            self._farthest = max(self._farthest, value)
            self._bar.value = 100.0 * min(1.0, value / self._farthest) if self._farthest else 0.0
        try:
            is_open = not session.is_closed
            limits = (
                text.box("the loops are open") if is_open else text.limits(passive_limits(session.robot, session.q))
            )
        except ValueError as reason:  # also NoTransmission
            limits = text.box(text.escaped(str(reason)))
        self._limits.content = limits

    def _watch(self) -> None:
        """Load the robot again when its files change."""
        assert self._page.files is not None
        while not self._closed.wait(_LOOK):
            if self._page.files.has_changed:
                self._page.worker.ask("files", self._reload)

    def _reload(self) -> None:
        assert self._page.files is not None
        try:
            robot = self._page.files.load()
        except InvalidRobot as refusal:
            self._diagnostics.content = text.diagnostics(refusal.diagnostics)
            errors = text.first_error(refusal.diagnostics)
            self._page.say(f"the files changed and have errors; this is the robot before. {errors}")
        except (EurdfError, OSError) as error:
            self._page.say(f"the files changed and cannot be loaded; this is the robot before. {error}")
        else:
            plays = self._play.plays
            self._page.worker.play(None)
            with self._page.server.atomic():
                self._page.shown.replace(robot)
                self._fill()
                self._page.say("the files changed: this is the robot now")
            self._play.go_on(plays)
