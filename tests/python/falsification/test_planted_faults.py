"""Five planted faults: each is found within 500 drives and shrunk to at most three things; the careful controller passes."""

from __future__ import annotations

import pytest

from falsification.planted import ARRIVES, CROWDED, FAULTS, OPEN, SAFE, Careful
from mobile_robot_simulator.falsification import falsify, run_drive

SEED = 0


@pytest.mark.slow
@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_found_and_shrunk(name):
    controller, space, requirement = FAULTS[name]
    found = falsify(controller, space, requirement, 500, seed=SEED)
    assert found.first_failure is not None and found.first_failure <= found.drives <= 500
    small = found.shrunk
    assert small is not None and small.failed and small.world.things <= 3
    assert small.world.things <= found.worst.world.things
    assert run_drive(small.world, controller, requirement) == small
    # The world shows the fault, not something that any controller runs into.
    assert not run_drive(small.world, Careful, requirement).failed


@pytest.mark.slow
@pytest.mark.parametrize(("space", "requirement"), [(CROWDED, SAFE), (OPEN, ARRIVES)])
def test_the_careful_controller_passes(space, requirement):
    found = falsify(Careful, space, requirement, 96, seed=SEED)
    assert (found.drives, found.failures, found.first_failure, found.shrunk) == (96, 0, None, None)
    assert not found.failed and found.worst.robustness > 0.1
