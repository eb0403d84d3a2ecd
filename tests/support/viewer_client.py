"""A page of the viewer without a browser: it keeps what the server says, and says what a page would."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from types import TracebackType
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

#: Time within which the server has to do what it is asked for, s.
PATIENCE = 60.0


class ViewerClient:
    """A connection to the websocket of a viewer.

    Attributes:
        said: The messages, in order.
    """

    def __init__(self, url: str, **options: Any) -> None:
        self.said: list[dict[str, Any]] = []
        address = f"{url.replace('http', 'ws')}/socket"
        self._connected = ExitStack()
        self._socket = self._connected.enter_context(
            connect(address, max_size=None, **{"origin": url, "proxy": None, **options})
        )
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()

    def __enter__(self) -> ViewerClient:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._connected.close()
        self._thread.join()

    def send(self, kind: str, **fields: Any) -> None:
        """Say something."""
        self._socket.send(json.dumps({"type": kind, **fields}))

    def last(self, kind: str, robot: int | None = None) -> dict[str, Any] | None:
        """The last message of a type."""
        return next((each for each in reversed(self.said) if (each["type"], each.get("robot")) == (kind, robot)), None)

    def says(self, text: str) -> bool:
        """Whether a message contains a text."""
        return any(text in each.get("text", "") for each in list(self.said))

    def wait_for(self, condition: Callable[[], Any]) -> Any:
        """What a condition is once it is true."""
        return wait_for(condition)

    def _receive(self) -> None:
        try:
            for text in self._socket:
                self.said.append(json.loads(text))
        except ConnectionClosed:
            pass


def wait_for(condition: Callable[[], Any]) -> Any:
    """What a condition is once it is true."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.01)
    raise AssertionError("it did not happen")
