"""The thread that does what pages and programs ask for."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest

from eurdf.viewing.worker import Worker


def test_worker_runs_the_last_of_each_key_and_frames_between() -> None:
    errors: list[Exception] = []
    worker = Worker(errors.append)
    ran: list[int] = []
    begun, go_on = threading.Event(), threading.Event()
    worker.ask("first", lambda: (begun.set(), go_on.wait(10)))
    assert begun.wait(10)
    for number in range(5):
        worker.ask("slider", lambda number=number: ran.append(number))
    worker.ask("wrong", lambda: 1 / 0)
    go_on.set()
    assert worker.call(lambda: "done") == "done"
    assert ran == [4]
    assert [type(error) for error in errors] == [ZeroDivisionError]
    with pytest.raises(ZeroDivisionError):
        worker.call(lambda: 1 / 0)

    frames: list[int] = []
    ended = threading.Event()

    def play() -> Iterator[float]:
        for frame in range(3):
            frames.append(frame)
            yield 0.001
        ended.set()

    worker.play(play())
    assert ended.wait(10)
    assert frames == [0, 1, 2]
    worker.stop()
    with pytest.raises(RuntimeError, match="closed"):
        worker.call(lambda: None)
