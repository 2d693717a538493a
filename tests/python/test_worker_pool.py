"""WorkerPool: results in order, errors of the work, and processes that die, each with a real one."""

from __future__ import annotations

import os
import signal
import time

import pytest

from falsification import deadly
from mobile_robot_simulator.worker_pool import WorkerDied, WorkerPool, how_it_ended

pytestmark = pytest.mark.slow


@pytest.fixture
def pool():
    pool = WorkerPool(deadly.work, 2)
    yield pool
    pool.close(at_once=True)


def test_results_come_in_the_order_of_the_tasks(pool):
    assert list(pool.run(list(range(1, 50)))) == [number * number for number in range(1, 50)]
    assert list(pool.run([])) == []
    # Results of a call that is given up do not appear in the next one.
    assert next(pool.run([5, 6, 7])) == 25
    assert list(pool.run([8, 9, 10])) == [64, 81, 100]


def test_errors_of_the_work_are_raised_here(pool):
    with pytest.raises(KeyError, match="other") as caught:
        list(pool.run([1, "other", 2]))
    assert "in work" in str(caught.value.__cause__)
    with pytest.raises(RuntimeError, match="OwnError: an error"):
        list(pool.run([1, "own", 2]))
    assert list(pool.run([3])) == [9]


@pytest.mark.parametrize(("task", "code"), [("exit", 3), ("close", -signal.SIGKILL)])
def test_a_process_that_dies_is_told_with_its_task(pool, task, code):
    found = []
    with pytest.raises(WorkerDied, match=r"before its task was done") as caught:
        found.extend(pool.run([1, 2, task, 4, 5]))
    assert found == [1, 4] and caught.value.index == 2 and caught.value.exit_code == code


def test_of_two_processes_that_die_the_one_with_the_earlier_task_is_told(pool):
    found = []
    with pytest.raises(WorkerDied) as caught:
        found.extend(pool.run([1, "exit late", "exit", 4]))
    assert found == [1] and (caught.value.index, caught.value.exit_code) == (1, 4)


def test_a_process_that_is_killed_while_it_waits(pool):
    os.kill(next(pool.run([0])), signal.SIGKILL)
    with pytest.raises(WorkerDied, match="was killed by SIGKILL, as when memory is used up while it waited") as caught:
        for _ in range(100):
            time.sleep(0.02)
            assert list(pool.run([1, 2])) == [1, 4]
    assert caught.value.index is None


def test_close_does_not_wait_for_work_that_is_given_up(pool):
    start = time.perf_counter()
    with pytest.raises(KeyError):
        list(pool.run(["other", "wait"]))
    pool.close(at_once=True)
    assert time.perf_counter() - start < 30.0


def test_work_that_cannot_be_pickled_is_refused():
    with pytest.raises(ValueError, match="must be functions or classes of a module: "):
        WorkerPool(lambda task: task, 2)


def test_ends_of_processes_have_words():
    assert how_it_ended(3) == "ended with exit code 3"
    assert how_it_ended(-15) == "was killed by SIGTERM"
    assert how_it_ended(-250) == "was killed by signal 250"
