"""Scanners: which parameters each of several scanners of a robot gets."""

from __future__ import annotations

import random
from collections.abc import Mapping
from typing import Any

from .parameters import LaserParameters, RobotParameters, check_names

SCANNERS = "scanners"
"""Parameter that names the scanners of a robot."""

DERIVED = ("laser_topic", "laser_frame_id", "seed")
"""Parameters from whose common value each scanner gets one of its own, unless it is given for the scanner."""


def scanner_names(values: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns the names of the scanners in the parameters of a robot; one empty name for one scanner without a name.

    Raises:
        ValueError: The value is not a list of different names.
    """
    given = _value(RobotParameters, SCANNERS, values)
    return RobotParameters.checked({SCANNERS: given}).scanners or ("",)


def split(name: str) -> tuple[str, str]:
    """Returns the scanner that a parameter is for, or an empty name, and the name of the parameter.

    `front.laser_mount` gives `front` and `laser_mount`. The prefix `<node>:` stays with neither.

    Args:
        name: Name of the parameter.
    """
    scanner, dot, own = name.rpartition(":")[2].partition(".")
    return (scanner, own) if dot and own in LaserParameters.model_fields else ("", name)


def check_robot_names(values: Mapping[str, Any]) -> None:
    """Checks that every name is a parameter of one of a robot's nodes, or of one of its scanners, as `front.laser_mount`.

    Raises:
        ValueError: A name is unknown, or `scanners` is not a list of different names.
    """
    scanners = scanner_names(values)
    for name in values:
        scanner, own = split(name) if isinstance(name, str) else ("", name)
        if scanner and scanner not in scanners:
            known = f"[{', '.join(filter(None, scanners))}]"
            raise ValueError(f"{name} needs {scanner} among the scanners, got scanners={known}")
        check_names([own])


def of_scanner(scanner: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the parameters of a robot for one of its scanners, with a topic, a frame and a seed of its own.

    The value of `<scanner>.<parameter>` counts more than that of `<parameter>`. Without such a value, the topic is
    `<scanner>/<laser_topic>`, the frame is `<scanner>_laser`, and the seed is derived from `seed` and the scanner's name, so
    that the noise of a scanner does not depend on which others there are.

    Args:
        scanner: Name of the scanner. If empty, the values are returned unchanged.
        values: Parameter values by name, with or without the prefix `<node>:`.
    """
    if not scanner:
        return dict(values)
    topic, seed = _value(LaserParameters, "laser_topic", values), _value(LaserParameters, "seed", values)
    folder, slash, last = str(topic).rpartition("/")
    own = {
        "laser_topic": f"{folder}{slash}{scanner}/{last}",
        "laser_frame_id": f"{scanner}_laser",
        "seed": random.Random(f"{seed}/{scanner}").getrandbits(63),
    }
    own |= {split(name)[1]: value for name, value in values.items() if split(name)[0] == scanner}
    common = {name: value for name, value in values.items() if not split(name)[0]}
    return common | {f"{LaserParameters.node_name}:{name}": value for name, value in own.items()}


def _value(model: type[RobotParameters | LaserParameters], name: str, values: Mapping[str, Any]) -> Any:
    """Returns a parameter of a node from values for all nodes."""
    default = model.model_fields[name].default
    return values.get(f"{model.node_name}:{name}", values.get(name, default))
