"""A page of the viewer without a browser: it applies what the server sends, and sends what a user's hand would."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

import numpy as np

#: Time within which the server has to do what it is asked for, s.
PATIENCE = 60.0


class ViewerClient:
    """A connection to the websocket of a viewer.

    Attributes:
        nodes: Position and quaternion w, x, y, z of each node of the scene in its parent.
        hidden: The nodes that are not shown; neither is what hangs from them.
        controls: The properties of the controls, by their identifier.
        on_message: Called after each message that was applied.
    """

    def __init__(self, url: str) -> None:
        import viser
        from websockets.sync.client import connect

        self.nodes: dict[str, dict[str, tuple[float, ...]]] = {"": {}}
        self.hidden: set[str] = set()
        self.controls: dict[str, dict[str, Any]] = {}
        self.on_message: Callable[[ViewerClient], None] = lambda _: None
        self.failed: list[BaseException] = []
        self._ready = False
        self._lock = threading.Lock()
        self._socket = connect(
            url.replace("http", "ws"), subprotocols=[f"viser-v{viser.__version__}"], origin=url, max_size=None
        )
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()
        # The server listens to a page once it knows its camera.
        self._send(
            type="ViewerCameraMessage",
            wxyz=(1.0, 0.0, 0.0, 0.0),
            position=(1.0, 0.0, 0.0),
            fov=1.0,
            near=0.01,
            far=100.0,
            image_height=100,
            image_width=100,
            look_at=(0.0, 0.0, 0.0),
            up_direction=(0.0, 0.0, 1.0),
        )
        self.wait_for(lambda: self._ready)

    def __enter__(self) -> ViewerClient:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._socket.close()
        self._thread.join()

    def wait_for(self, condition: Callable[[], Any]) -> Any:
        """What a condition is once it is true."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            with self._lock:
                if self.failed:
                    raise self.failed[0]
                if found := condition():
                    return found
            time.sleep(0.01)
        raise AssertionError("it did not happen")

    def bodies(self, robot: int) -> list[tuple[float, ...]]:
        """Position and quaternion w, x, y, z of the bodies of a robot that is shown, by its number.

        There are none while one version of the robot takes the place of another.
        """
        above = [name for name in self.nodes if name.startswith(f"/robot{robot}/version") and name.count("/") == 2]
        roots = [name for name in above if name not in self.hidden]
        if len(roots) != 1:
            return []
        root = roots[0]
        count = sum(name.startswith(f"{root}/body") and name.count("/") == 3 for name in self.nodes)
        placed = [self.nodes[f"{root}/body{number}"] for number in range(count)]
        return [(*node["position"], *node["wxyz"]) for node in placed]

    def without_place(self, robot: int) -> bool:
        """Whether a body of a robot has something to show before it was told where it is."""
        new = {name for name, node in self.nodes.items() if "new" in node and name.startswith(f"/robot{robot}/version")}
        return any(name.rpartition("/")[0] in new for name in self.nodes if name.count("/") == 4)

    def control(self, label: str) -> str | None:
        """The identifier of the control with this label, if there is one."""
        return next((key for key, each in self.controls.items() if each.get("label") == label), None)

    def value(self, label: str) -> Any:
        """The value of a control."""
        key = self.control(label)
        return None if key is None else self.controls[key]["value"]

    def says(self, text: str) -> bool:
        """Whether a text of the page contains this one."""
        return any(text in each.get("content", "") for each in self.controls.values())

    def set(self, label: str, value: Any) -> None:
        """Move a slider, choose from a list, or click on a button (with the value True)."""
        key = self.wait_for(lambda: self.control(label))
        self._send(type="GuiUpdateMessage", uuid=key, updates={"value": value})
        with self._lock:
            self.controls[key]["value"] = value  # a page does not hear of its own change

    def click(self, label: str) -> None:
        """Click on a button."""
        self.set(label, True)

    def drag(self, position: Any) -> None:
        """Drag the handle to a position (3,), and let go."""
        name = "/gizmo"
        self.wait_for(lambda: name in self.nodes)
        where = tuple(float(value) for value in position)
        self._send(type="TransformControlsDragStartMessage", name=name)
        self._send(type="TransformControlsUpdateMessage", name=name, wxyz=(1.0, 0.0, 0.0, 0.0), position=where)
        self._send(type="TransformControlsDragEndMessage", name=name)

    def _send(self, **message: Any) -> None:
        import msgspec

        self._socket.send(msgspec.msgpack.encode(message))

    def _receive(self) -> None:
        import msgspec
        import zstandard
        from websockets.exceptions import ConnectionClosed

        try:
            for data in self._socket:
                assert isinstance(data, bytes)
                size, packed = int.from_bytes(data[:8], "little"), int.from_bytes(data[8:16], "little")
                text = zstandard.ZstdDecompressor().decompress(data[16 : 16 + packed], max_output_size=size)
                for message in msgspec.msgpack.decode(text)["messages"]:
                    with self._lock:
                        self._apply(message)
                        self.on_message(self)
        except ConnectionClosed:
            pass
        except BaseException as error:
            self.failed.append(error)

    def _apply(self, message: dict[str, Any]) -> None:
        kind, name = message["type"], message.get("name", "")
        if kind == "SetPositionMessage":
            self.nodes[name]["position"] = message["position"]
            self.nodes[name].pop("new", None)
        elif kind == "SetOrientationMessage":
            self.nodes[name]["wxyz"] = message["wxyz"]
        elif kind == "SetSceneNodeVisibilityMessage":
            (self.hidden.discard if message["visible"] else self.hidden.add)(name)
        elif kind == "RemoveSceneNodeMessage":
            self.nodes = {
                node: pose for node, pose in self.nodes.items() if node != name and not node.startswith(f"{name}/")
            }
        elif kind == "ReplayDoneMessage":
            self._ready = True
        elif kind == "GuiUpdateMessage":
            self.controls.get(message["uuid"], {}).update(message["updates"])
        elif kind == "GuiRemoveMessage":
            self.controls.pop(message["uuid"], None)
        elif "container_uuid" in message:
            self.controls[message["uuid"]] = {**message["props"], "value": message.get("value")}
        elif "props" in message and name:
            self.nodes[name] = {"position": (0.0, 0.0, 0.0), "wxyz": (1.0, 0.0, 0.0, 0.0)}
            if message["type"] == "FrameMessage":
                self.nodes[name]["new"] = ()


def differ(found: list[tuple[float, ...]], expected: list[tuple[float, ...]]) -> float:
    """The largest difference of poses, of which a quaternion and its negative are the same."""
    a, b = np.array(found), np.array(expected)
    if a.shape != b.shape:
        return np.inf
    signs = np.sign(np.sum(a[:, 3:] * b[:, 3:], axis=1, keepdims=True))
    return float(np.abs(np.hstack((a[:, :3] - b[:, :3], a[:, 3:] - signs * b[:, 3:]))).max())
