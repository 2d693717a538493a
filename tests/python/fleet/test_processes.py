"""Fleets and signals, forks and other processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest

SETUP = """
import os, signal, sys
import numpy as np
import mobile_robot_simulator as mrs

grid = mrs.floor_plan("office", seed=1)
fleet = mrs.Fleet(
    grid, seeds=np.arange(200), footprint=mrs.Shape.disc(0.2), scanner=mrs.LaserScanner(beam_count=90), noise=mrs.BeamModel()
)
commands = np.tile([0.5, 0.0, 0.3], (200, 1))
"""

LONG_STEP = (
    SETUP
    + """
before = fleet.save().words.tobytes()
print("runs", flush=True)
try:
    fleet.step(commands, 1e6, threads=int(sys.argv[1]))
except KeyboardInterrupt:
    print("KeyboardInterrupt")
assert fleet.save().words.tobytes() == before
fleet.step(commands, 0.1)
print("works")
"""
)

FORK = (
    SETUP
    + """
import warnings
warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 and later warn of forks with threads.
fleet.step(commands, 0.1, threads=2)
state = fleet.save()
expected = fleet.step(commands, 0.1, threads=2).ranges.tobytes()
fleet.restore(state)
child = os.fork()
if child == 0:
    signal.alarm(60)
    os._exit(0 if fleet.step(commands, 0.1, threads=2).ranges.tobytes() == expected else 2)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
print("works")
"""
)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows cannot send SIGINT to one process")
@pytest.mark.parametrize("threads", ["1", "2"])
def test_ctrl_c_ends_a_step_that_changes_nothing(threads: str) -> None:
    """The step would take hours."""
    ran = subprocess.Popen([sys.executable, "-c", LONG_STEP, threads], stdout=subprocess.PIPE, text=True)
    assert ran.stdout is not None and ran.stdout.readline() == "runs\n"
    time.sleep(0.5)
    ran.send_signal(signal.SIGINT)
    rest, _ = ran.communicate(timeout=60)
    assert (rest, ran.returncode) == ("KeyboardInterrupt\nworks\n", 0)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_forked_process_goes_on_with_the_fleet() -> None:
    ran = subprocess.run([sys.executable, "-c", FORK], capture_output=True, text=True, timeout=120, check=False)
    assert (ran.stdout, ran.returncode) == ("works\n", 0), ran.stderr
