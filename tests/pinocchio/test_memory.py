"""Working memory that is kept with a robot: safe under threads, and without effect on results."""

from __future__ import annotations

import gc
import weakref
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.pinocchio.memory import working_memory


def answers(robot: eurdf.Robot, seed: int) -> list[Any]:
    """What functions answer at a random closed configuration."""
    random, tree = np.random.default_rng(seed), robot.tree
    q = eurdf.assemble(robot).q
    values = q[robot.actuation.idx_q] + random.uniform(-0.02, 0.02, len(robot.actuation.idx_q))
    q = eurdf.forward_kinematics(robot, values, q)
    apart = tree.integrate(q, random.uniform(-0.05, 0.05, tree.nv))
    return [
        q,
        *eurdf.residual_and_jacobian(robot, apart),
        eurdf.assemble(robot, apart, hold=robot.actuation.joints[0]).q,
        eurdf.kinematics.dq_dq_actuated(robot, q),
        eurdf.forward_dynamics(robot, q, np.zeros(tree.nv)).a,
        eurdf.inverse_kinematics(robot, {robot.mechanism.bodies[-1].name: np.zeros(3)}, apart, restarts=0).q,
    ]


@pytest.mark.parametrize("name", ["five_bar", "delta", "talos_leg"])
def test_threads_get_what_a_fresh_robot_answers(name: str) -> None:
    shared, seeds = eurdf.load(name, geometry=False), range(12)
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda seed: answers(shared, seed), seeds))
    for seed, own in zip(seeds, found, strict=True):
        np.testing.assert_equal(own, answers(eurdf.load(name, geometry=False), seed))


def test_working_memory_is_used_again_but_by_one_at_a_time() -> None:
    robot = eurdf.load("four_bar", geometry=False)

    def memory(robot: eurdf.Robot, key: int) -> list[int]:
        return [key]

    with working_memory(robot, memory, 1) as first, working_memory(robot, memory, 1) as second:
        assert first is not second
    with working_memory(robot, memory, 1) as again, working_memory(robot, memory, 2) as other:
        assert again in (first, second)
        assert other == [2]


def test_memory_is_dropped_after_an_error_and_beyond_a_number_of_keys() -> None:
    robot = eurdf.load("four_bar", geometry=False)

    class Memory:
        def __init__(self, robot: eurdf.Robot, key: int) -> None: ...

    with pytest.raises(KeyError), working_memory(robot, Memory, 0) as failed:
        raise KeyError
    with working_memory(robot, Memory, 0) as kept:
        assert kept is not failed
    references = []
    for key in range(100):
        with working_memory(robot, Memory, key) as memory:
            references.append(weakref.ref(memory))
    del memory, kept, failed
    gc.collect()
    assert sum(reference() is not None for reference in references) <= 8
