"""Parameters of nodes."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode
from mobile_robot_simulator.bus.parameter import Parameter, SetParametersResult


def test_parameters_are_declared_read_checked_and_set(bus: Bus) -> None:
    node = BusNode(bus, "clerk", parameters={"speed": 0.25})
    assert node.declare_parameter("speed", 1.0).value == 0.25
    assert node.get_parameter("speed").get_parameter_value().double_value == 0.25
    assert [item.value for item in node.declare_parameters("laser", [("beams", 3), ("name", "x")])] == [3, "x"]
    assert node.get_parameter("laser.beams").value == 3 and node.get_parameter_or("none", 4) == 4
    with pytest.raises(ValueError, match=r"'sped' of clerk is not declared; did you mean 'speed'\?"):
        node.get_parameter("sped")
    with pytest.raises(ValueError, match="already declared"):
        node.declare_parameter("speed", 1.0)
    node.add_on_set_parameters_callback(lambda items: SetParametersResult(items[0].value > 0, "must be positive"))
    results = node.set_parameters([Parameter("speed", value=2.0), Parameter("speed", value=-2.0)])
    assert [result.successful for result in results] == [True, False] and node.get_parameter("speed").value == 2.0
