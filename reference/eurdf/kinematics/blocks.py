"""Arguments of many elements, and work on them in blocks: one after the other, in threads, or by an executor."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from eurdf.array import Matrix
from eurdf.blas import ONE_THREAD
from eurdf.kinematics.closing import start
from eurdf.kinematics.evaluate import many_tree
from eurdf.kinematics.named import configurations_of
from eurdf.pinocchio.arguments import checked_array, checked_count

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Called with the number of elements that are done, and the number of all.
Progress = Callable[[int, int], None]

Arrays = Sequence[npt.NDArray[Any]]

# Memory of the arrays of one block, bytes, and the largest number of elements in one: with more, the arrays are not in
# the cache of the processor; with less, NumPy takes longer to begin its loops than to run them.
_BLOCK_BYTES = 2**24
_LONGEST_BLOCK = 2000

# Blocks are smaller by the number of threads, so that each has several, but not by more than this.
_PARTS = 4

# Number of blocks that an executor is given at once, so that a long batch does not fill its queue.
_MOST_SUBMITTED = 64


@dataclass(frozen=True, slots=True)
class Blocks:
    """How a batch is divided and who works on it.

    Attributes:
        size: Number of elements of a block.
        threads: Number of threads.
        executor: Who works on the blocks in place of threads.
        progress: Called after each block.
    """

    size: int
    threads: int = 1
    executor: Executor | None = None
    progress: Progress | None = None

    def map(self, function: Callable[..., Arrays], task: Any, arrays: Arrays) -> tuple[npt.NDArray[Any], ...]:
        """The results of a function for each block of elements, joined in the order of the elements.

        Args:
            function: Called as ``function(task, *parts)``; its name must be importable.
            task: What is the same for all blocks.
            arrays: Arrays whose first axis has the elements.
        """
        total = len(arrays[0])
        starts = range(0, max(total, 1), self.size)
        calls = ((task, *(array[first : first + self.size] for array in arrays)) for first in starts)
        found: tuple[npt.NDArray[Any], ...] = ()
        count = 0
        for index, result in self._results(function, calls):
            found = found or tuple(np.empty((total, *part.shape[1:]), part.dtype) for part in result)
            for whole, part in zip(found, result, strict=True):
                whole[starts[index] : starts[index] + len(part)] = part
            count += len(result[0])
            if self.progress is not None:
                self.progress(count, total)
        return found

    def _results(self, function: Callable[..., Arrays], calls: Iterator[Any]) -> Iterator[tuple[int, Arrays]]:
        """The result of each call with its index, in any order."""
        if self.executor is None and self.threads == 1:
            for index, arguments in enumerate(calls):
                yield index, _evaluated(function, *arguments)
            return
        with self._workers() as executor:
            numbered = enumerate(calls)
            running: dict[Future[Arrays], int] = {}
            try:
                while True:
                    for index, arguments in itertools.islice(numbered, _MOST_SUBMITTED - len(running)):
                        running[executor.submit(_evaluated, function, *arguments)] = index
                    if not running:
                        return
                    for future in wait(running, return_when=FIRST_COMPLETED).done:
                        yield running.pop(future), future.result()
            finally:
                for future in running:
                    future.cancel()

    @contextmanager
    def _workers(self) -> Iterator[Executor]:
        if self.executor is not None:
            yield self.executor
            return
        with ThreadPoolExecutor(self.threads) as executor:
            yield executor


def blocks(
    numbers: int, block: int | None, threads: int, executor: Executor | None, progress: Progress | None
) -> Blocks:
    """How to divide a batch.

    Args:
        numbers: Roughly how many numbers one element takes.
        block: Number of elements of a block; chosen by the memory they take if it is None.
        threads: Number of threads.
        executor: Who works on the blocks in place of threads, or None.
        progress: Called after each block, or None.

    Raises:
        ValueError: ``block`` or ``threads`` is not a positive integer, or both ``threads`` and ``executor`` are given.
    """
    threads = checked_count("threads", threads, 1)
    if executor is not None and threads > 1:
        raise ValueError("both threads and executor are given; use one of them")
    size = max(1, min(_LONGEST_BLOCK, _BLOCK_BYTES // (8 * max(numbers, 1))) // min(threads, _PARTS))
    return Blocks(size if block is None else checked_count("block", block, 1), threads, executor, progress)


def _evaluated(function: Callable[..., Arrays], *arguments: Any) -> Arrays:
    # Elements that overflow do not converge, and say so.
    with np.errstate(all="ignore"), ONE_THREAD:
        return function(*arguments)


def shape_of(given: Any) -> tuple[int, ...]:
    """The shape of the given numbers; () for lists of unequal length, which have none."""
    try:
        return np.shape(given)
    except ValueError:
        return ()


def checked_rows(name: str, given: Any, width: int) -> Matrix:
    """The given numbers as an array (B, width).

    Raises:
        ValueError: It has another shape, or something in it is not a finite number.
    """
    shape = shape_of(given)
    if len(shape) == 2 and shape[1] == width:
        return checked_array(name, given, shape)
    if shape == (0,):
        return np.empty((0, width))
    raise ValueError(f"{name} has the shape {shape}; expected (B, {width}): one row for each element")


def checked_configurations(robot: Robot, name: str, given: Any) -> Matrix:
    """The given configurations (B, nq), normalized.

    Raises:
        ValueError: They have another shape, are not finite, or one of them cannot be normalized.
    """
    q = checked_rows(name, configurations_of(robot, given, name), robot.tree.nq)
    with np.errstate(all="ignore"):
        normal = many_tree(robot).normalized(q)
    wrong = np.flatnonzero(~np.isfinite(normal).all(axis=1))
    if len(wrong):
        start(robot, q[wrong[0]], f"{name}[{wrong[0]}]")
    return normal


def starts(robot: Robot, q0: Any, count: int) -> tuple[Matrix, bool]:
    """The configurations (B, nq) to start at, and whether they are all the same.

    Args:
        robot: The robot.
        q0: One configuration (nq,), one for each element (B, nq), or None for `assembled` or the neutral one.
        count: B.

    Raises:
        ValueError: As in `checked_configurations`, or their number is not B.
    """
    if isinstance(q0, Mapping):
        q0 = configurations_of(robot, q0, "q0")
        q0 = q0[0] if len(q0) == 1 else q0
    if q0 is None or len(shape_of(q0)) == 1:
        q = start(robot, q0)
        return np.broadcast_to(q, (count, len(q))), True
    q = checked_configurations(robot, "q0", q0)
    if len(q) != count:
        raise ValueError(f"q0 has {len(q)} rows; expected {count}, one for each element, or one configuration")
    return q, False
