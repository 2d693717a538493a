"""servers: checks of the parameters of the world server and of the map server."""

from __future__ import annotations

from typing import Any

import pytest

from mobile_robot_simulator.parameters import MapParameters, WorldParameters


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"robots": "robot1"}, "robots must be a list of names such as [robot1, robot2], got 'robot1'"),
        ({"robots": ["1"]}, "robots must be a list of names such as [robot1, robot2], got ['1']"),
        ({"robots": ["a", "a"]}, "robots must be a list of different names, got ['a', 'a']"),
        ({"faults": "Drop"}, "faults must be a list of texts such as [\"Drop('/scan', probability=0.1)\"], got 'Drop'"),
        ({"faults": [1]}, "faults must be a list of texts such as [\"Drop('/scan', probability=0.1)\"], got [1]"),
    ],
)
def test_names_of_robots_and_texts_of_faults_are_checked(values: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError) as caught:
        WorldParameters.checked(values)
    assert str(caught.value) == message


def test_lists_are_kept_in_their_order() -> None:
    assert WorldParameters(robots=("b", "a")).robots == ("b", "a")


def test_a_map_server_needs_a_file() -> None:
    assert MapParameters(yaml_filename="map.yaml").topic_name == "map"
    with pytest.raises(ValueError, match=r"^yaml_filename is required$"):
        MapParameters.checked({})
