"""quoting: values in messages are cut while their text is made."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml

from mobile_robot_simulator.bus.node import Node
from mobile_robot_simulator.parameters import NODES, LaserParameters, RobotParameters
from mobile_robot_simulator.quoting import LONGEST, nearest, quoted, shortened

ALIASES = "a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n" + "".join(
    f"a{level}: &a{level} [{', '.join([f'*a{level - 1}'] * 10)}]\n" for level in range(1, 10)
)


def bomb() -> Any:
    """A list that takes some kB. Its whole text would take 30 GB."""
    return yaml.safe_load(ALIASES)["a9"]


def deep(levels: int) -> Any:
    value: Any = 1
    for _ in range(levels):
        value = [value]
    return value


@pytest.mark.parametrize("value", [1, -2.5, 1e300, "a 'word'", b"\0", None, True, [1, [2, 3]], (1,), {"a": [1]}, {1}, "ä"])
def test_short_values_look_as_in_repr(value: object) -> None:
    assert quoted(value) == repr(value)


@pytest.mark.parametrize(
    "value",
    [
        "x" * 10_000_000,
        b"x" * 10_000_000,
        "\0" * 1000,
        list(range(10_000_000)),
        {key: key for key in range(100_000)},
        10**100_000,
        deep(100_000),
        np.zeros((1000, 1000)),
        object(),
    ],
    ids=lambda value: type(value).__name__,
)
def test_every_value_is_cut(value: object) -> None:
    assert 0 < len(quoted(value)) <= LONGEST
    assert len(quoted([value] * 100)) <= LONGEST


def test_shared_items_are_not_multiplied() -> None:
    assert len(quoted(bomb())) <= LONGEST
    assert quoted([[[[[0]]]]]) == "[[[[...]]]]"


def test_numbers_keep_their_short_form() -> None:
    assert quoted(1e300) == "1e+300"
    assert quoted(2**64) == "18446744073709551616"
    assert quoted(10**300) == "an integer of 997 bits"


def test_other_messages_are_one_line() -> None:
    assert shortened(ValueError("first\n  second")) == "first second"
    assert len(shortened("x" * 1000)) == LONGEST


@pytest.mark.parametrize("model", NODES)
@pytest.mark.parametrize(
    "value", [bomb(), deep(5000), "x" * 1_000_000, 10**100_000], ids=["aliases", "deep", "text", "digits"]
)
def test_the_errors_of_all_parameters_are_short(model: Any, value: object) -> None:
    refused = 0
    for name in model.model_fields:
        try:
            model.checked({name: value})
        except ValueError as error:
            assert len(str(error)) < 12 * LONGEST, name
            refused += 1
    assert refused > 10


def test_unknown_names_are_cut() -> None:
    with pytest.raises(ValueError) as caught:
        LaserParameters.checked({"x" * 1_000_000: 1})
    assert len(str(caught.value)) < 2000


def test_the_values_of_two_parameters_are_cut() -> None:
    corners = str([[np.cos(angle), np.sin(angle)] for angle in np.linspace(0, 6, 300)]).replace("np.float64", "")
    corners = corners.replace("(", "").replace(")", "")
    with pytest.raises(ValueError, match="only one of robot_radius and footprint") as caught:
        RobotParameters.checked({"robot_radius": 1.0, "footprint": corners})
    assert len(str(caught.value)) < 2 * LONGEST


def test_the_names_of_topics_are_cut() -> None:
    with pytest.raises((ValueError, RuntimeError)) as caught:
        Node("/" * 1_000_000)
    assert len(str(caught.value)) < 2 * LONGEST


@pytest.mark.parametrize(
    ("name", "known", "found"),
    [
        ("laser_fow", ["laser_fov", "laser_seed"], ["laser_fov"]),
        ("sigma", ["sigma_hit", "seed"], ["sigma_hit"]),
        ("sigma", ["sigma_hit", "incidence_sigma"], ["sigma_hit"]),
        ("sigma", ["sigma_hit", "sigma_short"], []),
        ("laser_noise", ["laser_topic"], []),
        ("laser_z_rand", ["laser_min_range"], []),
        ("/scan", ["/odom", "/robot1/scan"], ["/robot1/scan"]),
        ("POSESTAMPD", ["PoseArray", "PoseStamped"], ["PoseStamped"]),
        ("/foo", ["/odom", "/scan"], []),
        ("", ["office"], []),
        ("castle", ["cave", "maze", "office"], []),
        (5, ["office"], []),
    ],
)
def test_only_near_names_are_suggested(name: object, known: list[str], found: list[str]) -> None:
    assert nearest(name, known) == found
