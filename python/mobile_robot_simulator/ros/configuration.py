"""What runs as a node in ROS, and how it comes by its parameters there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol

from ..nodes.interface import Logger, Node
from ..nodes.laser import LaserScannerSimulator
from ..nodes.map_server import MapFileServer
from ..nodes.robot import MobileRobotSimulator
from ..parameters import LaserParameters, MapParameters, Parameters, RobotParameters, check_names
from .nav2_loopback_names import SYNONYMS, translate

MODELS: dict[str, type[Parameters]] = {"robot": RobotParameters, "laser": LaserParameters, "map": MapParameters}
"""Parameters of the nodes that can be run, by the names that the commands have for these."""

FIXED = ("publish_clock",)
"""Parameters that count at the start only: they decide which clock a node goes by."""


class Behaviour(Protocol):
    """The robot, the laser or the map."""

    @property
    def parameters(self) -> Any:
        """The parameters in use."""

    def set_parameters(self, **values: Any) -> None:
        """Change parameters, at any time."""

    def start(self) -> None:
        """Begin."""


def models_of(name: str) -> list[type[Parameters]]:
    """Parameters of what runs under a name: one node's, or with `all` those of every one."""
    return list(MODELS.values()) if name == "all" else [MODELS[name]]


def behaviour_of(parameters: Parameters, node: Node) -> Behaviour:
    """The robot, the laser or the map of these parameters, on a node."""
    if isinstance(parameters, RobotParameters):
        return MobileRobotSimulator(node, parameters)
    if isinstance(parameters, LaserParameters):
        return LaserScannerSimulator(node, parameters)
    assert isinstance(parameters, MapParameters)
    return MapFileServer(node, parameters)


def split(name: str, arguments: Sequence[str], is_ros: Callable[[str], bool]) -> tuple[str | None, list[str]]:
    """The map's file, where one is served, and from the first argument of ROS on its arguments.

    raises: ValueError for anything else.
    """
    first = next((index for index, argument in enumerate(arguments) if is_ros(argument)), len(arguments))
    ours, theirs = list(arguments[:first]), list(arguments[first:])
    wanted = name in ("map", "all")
    if len(ours) > wanted:
        raise ValueError(f"unexpected argument {ours[wanted]!r}; {name} takes {'MAP.yaml and ' * wanted}arguments of ROS")
    return (ours[0] if ours else None), theirs


def resolve(model: type[Parameters], given: Mapping[str, Any], logger: Logger, announced: set[str]) -> dict[str, Any]:
    """A node's values, under our names, among what was given; other names for them are announced, each once.

    Own names go before others' names for the same.
    raises: ValueError for a value under another's name that has no meaning here.
    """
    values: dict[str, Any] = {}
    for synonym, meaning in translate(given).items():
        ours = {name: value for name, value in meaning.items() if name in model.model_fields}
        values.update(ours)
        if ours and synonym not in announced:
            announced.add(synonym)
            logger.info(f"{synonym} is taken as {', '.join(f'{name} = {value}' for name, value in ours.items())}")
    return {**values, **{name: value for name, value in given.items() if name in model.model_fields}}


def warn_of_unknown(names: Iterable[str], logger: Logger) -> None:
    """Warn of names that no parameter of any node has."""
    for name in names:
        if name not in SYNONYMS:
            try:
                check_names([name], MODELS.values())
            except ValueError as error:
                logger.warning(str(error))


def change(behaviour: Behaviour, values: Mapping[str, Any]) -> None:
    """Change parameters of a node that runs.

    raises: ValueError or OSError with the reason if that can't be; then nothing has changed.
    """
    for name, value in values.items():
        if name in SYNONYMS:
            raise ValueError(f"{name} is another's name; change {', '.join(translate({name: value})[name])}")
        if name in FIXED and getattr(behaviour.parameters, name) != value:
            raise ValueError(f"{name} counts at the start only, and stays {getattr(behaviour.parameters, name)}")
    behaviour.set_parameters(**values)
