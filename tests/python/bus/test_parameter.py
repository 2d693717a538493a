"""Parameters of nodes."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.bus.bus import Bus
from mobile_robot_simulator.bus.node import BusNode
from mobile_robot_simulator.bus.parameter import (
    Parameter,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    SetParametersResult,
)
from mobile_robot_simulator.bus.parameter_descriptor import ParameterDescriptor


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


def test_parameters_are_set_together_or_not_at_all(bus: Bus) -> None:
    node = BusNode(bus, "clerk")
    node.declare_parameters("", [("low", 1.0), ("high", 2.0), ("frame", "map", ParameterDescriptor(read_only=True))])

    def ordered(items: list[Parameter]) -> SetParametersResult:
        values = {item.name: item.value for item in items}
        return SetParametersResult(values["low"] < values["high"], "low must be below high")

    node.add_on_set_parameters_callback(ordered)
    assert node.set_parameters_atomically([Parameter("low", value=3.0), Parameter("high", value=4.0)]).successful
    for changes, reason in [
        ({"low": 6.0, "high": 5.0}, "low must be below high"),
        ({"low": 0.0, "high": 5.0, "frame": "odom"}, "parameter 'frame' is read-only"),
    ]:
        result = node.set_parameters_atomically([Parameter(name, value=value) for name, value in changes.items()])
        assert (result.successful, result.reason) == (False, reason)
    with pytest.raises(ParameterNotDeclaredException, match="'none' of clerk is not declared"):
        node.set_parameters_atomically([Parameter("low", value=0.0), Parameter("none")])
    assert [it.value for it in node.get_parameters(["low", "high", "frame"])] == [3.0, 4.0, "map"]


def test_parameters_are_described_and_undeclared(bus: Bus) -> None:
    node, given = BusNode(bus, "clerk"), ParameterDescriptor(description="m/s", read_only=True)
    node.declare_parameters("", [("speed", 1.0, given), ("gain", 2.0)])
    assert [(it.name, it.description) for it in node.describe_parameters(["speed", "gain"])] == [
        ("speed", "m/s"),
        ("gain", ""),
    ]
    assert node.describe_parameter("speed").read_only and given.name == ""
    with pytest.raises(ParameterImmutableException, match="'speed' of clerk is read-only"):
        node.undeclare_parameter("speed")
    node.undeclare_parameter("gain")
    assert not node.has_parameter("gain") and node.declare_parameter("gain", 3.0).value == 3.0
    for call in (node.undeclare_parameter, node.describe_parameter):
        with pytest.raises(ParameterNotDeclaredException):
            call("none")
