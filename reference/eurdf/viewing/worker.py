"""One thread that does everything with a session, in order: of what is asked for again and again, only the last."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Hashable, Iterator
from concurrent.futures import Future
from typing import Any


class Worker:
    """Runs tasks one after the other, and plays frames while there are none."""

    def __init__(self, report: Callable[[Exception], None]) -> None:
        """Start the thread; ``report`` is called with what a task raised that nobody waits for."""
        self._report = report
        self._tasks: dict[Hashable, tuple[Callable[[], Any], Future[Any] | None]] = {}
        self._frames: Iterator[float] | None = None
        self._stopped = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="eurdf viewer", daemon=True)
        self._thread.start()

    def ask(self, key: Hashable, task: Callable[[], Any]) -> None:
        """Run a task soon, in place of an earlier one of the same key that has not begun."""
        with self._changed:
            self._tasks.pop(key, None)
            self._tasks[key] = task, None
            self._changed.notify()

    def call(self, task: Callable[[], Any]) -> Any:
        """Run a task and return what it returns, or raise what it raises."""
        if threading.current_thread() is self._thread:
            return task()
        future: Future[Any] = Future()
        with self._changed:
            if self._stopped:
                raise RuntimeError("the viewer is closed")
            self._tasks[future] = task, future
            self._changed.notify()
        return future.result()

    def play(self, frames: Iterator[float] | None) -> None:
        """Play frames between the tasks, each of which shows itself and yields for how long, s; or stop playing."""
        with self._changed:
            self._frames = frames
            self._changed.notify()

    @property
    def is_playing(self) -> bool:
        """Whether frames are played."""
        return self._frames is not None

    def stop(self) -> None:
        """End the thread; what was not begun is dropped."""
        with self._changed:
            self._stopped = True
            for _, future in self._tasks.values():
                if future is not None:
                    future.cancel()
            self._tasks.clear()
            self._changed.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self) -> None:
        due = 0.0
        while True:
            with self._changed:
                while not (self._stopped or self._tasks):
                    left = due - time.monotonic()
                    if self._frames is not None and left <= 0.0:
                        break
                    self._changed.wait(None if self._frames is None else left)
                if self._stopped:
                    return
                key = next(iter(self._tasks), None)
                task, future = self._tasks.pop(key) if key is not None else (None, None)
                frames = self._frames
            if task is not None:
                self._do(task, future)
            elif frames is not None:
                due = time.monotonic() + self._frame(frames)

    def _frame(self, frames: Iterator[float]) -> float:
        try:
            return next(frames)
        except StopIteration:
            pass
        except Exception as error:
            self._report(error)
        with self._changed:
            if self._frames is frames:
                self._frames = None
        return 0.0

    def _do(self, task: Callable[[], Any], future: Future[Any] | None) -> None:
        try:
            result = task()
        except Exception as error:
            if future is None:
                self._report(error)
            else:
                future.set_exception(error)
        else:
            if future is not None:
                future.set_result(result)
