"""Fault examples: each can be added to the simulation that it is for."""

import pytest
from sessions import robot

from mobile_robot_simulator.faults.reading import FAULTS, read_fault
from mobile_robot_simulator.live.fault_examples import fault_examples
from simulations import pair


@pytest.mark.parametrize("make", [robot, pair])
def test_there_is_an_example_of_each_kind_and_each_can_be_added(make):
    examples = fault_examples(make())
    assert sorted(text.partition("(")[0] for text in examples) == sorted(FAULTS)
    for text in examples:
        simulation = make()
        simulation.add_fault(read_fault(text))
        simulation.run_for(0.5)
        assert simulation.faults[0].acts
