"""Chooses the nodes that a ROS process runs, and checks the parameters that ROS passes to them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, Protocol

from ..namespaces import SHARED, of_robot
from ..nav2_loopback_names import SYNONYMS, translate
from ..nodes.interface import Logger, Node
from ..nodes.laser import LaserScannerSimulator
from ..nodes.map_server import MapFileServer
from ..nodes.robot import MobileRobotSimulator
from ..nodes.world_server import WorldServer
from ..parameters import LaserParameters, MapParameters, Parameters, RobotParameters, WorldParameters, check_names
from ..quoting import quoted
from ..scanners import of_scanner, split
from .node import RosProcess

MODELS: dict[str, type[Parameters]] = {"robot": RobotParameters, "laser": LaserParameters, "map": MapParameters}
"""Parameter class of each node, by the name of the node on the command line."""

ALL: tuple[type[Parameters], ...] = (*MODELS.values(), WorldParameters)
"""Parameter classes of the nodes that run with `all`, in the order in which they start: the robot decides the clock."""

OF_ALL_ROBOTS = ("speed_factor", "unknown", "faults")
"""Parameters that cannot differ between the robots of a process, because they share the time, the map and the faults."""

ONLY_ALL = "robots has an effect only with all; each other command runs the node of one robot"
"""Warning about the parameter `robots` of a process that cannot have several."""

DERIVED = ("frame_prefix", "seed", "odometry_seed", *SHARED)
"""Parameters from whose common value each robot of a process gets one of its own when it starts."""

OF_A_ROBOT: tuple[type[Parameters], ...] = (RobotParameters, LaserParameters)
"""Parameter classes of the nodes that each robot has."""

STARTUP_ONLY = ("publish_clock", "robots", "scanners", "faults")
"""Parameters that cannot change while a node runs, because they decide which clock it uses, or which nodes there are."""


class Behaviour(Protocol):
    """The properties and methods of a robot, laser or map server that a ROS process uses."""

    @property
    def parameters(self) -> Any:
        """The current parameters."""

    def set_parameters(self, **values: Any) -> None:
        """Changes parameters."""

    def start(self) -> None:
        """Starts publishing and listening."""


def models_of(name: str) -> list[type[Parameters]]:
    """Returns the parameter classes of the nodes to run: of the named node, or of every node for `all`."""
    return list(ALL) if name == "all" else [MODELS[name]]


def create_behaviour(parameters: Parameters, node: Node, process: RosProcess, robot: str = "") -> Behaviour:
    """Creates the world, the robot, the laser or the map server. The class of the parameters decides which one.

    Args:
        parameters: Checked parameters.
        node: ROS node on which it runs.
        process: What all nodes of the process share. Robots move in its world, and lasers are mounted on its robots.
        robot: Name of the robot that the node belongs to; empty if there is only one.

    Raises:
        ValueError: The map file is invalid.
        OSError: The map file cannot be read.
    """
    if isinstance(parameters, RobotParameters):
        created = MobileRobotSimulator(node, parameters, world=process.world_for(node), name=robot)
        process.robots[robot] = process.disturbances.robot_named(robot).running_robot = created
        return created
    if isinstance(parameters, LaserParameters):
        laser = LaserScannerSimulator(node, parameters, carrier=process.robots.get(robot))
        process.disturbances.robot_named(robot).running_scanners[parameters.laser_topic] = laser
        return laser
    if isinstance(parameters, WorldParameters):
        return WorldServer(node, parameters, process.world_for(node))
    assert isinstance(parameters, MapParameters)
    process.disturbances.running_map_server = MapFileServer(node, parameters)
    return process.disturbances.running_map_server


def faults_in(given: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns the texts of the parameter `faults`, which every node takes.

    Args:
        given: Values by name, for all nodes of the process.

    Raises:
        ValueError: The value is not a list of texts.
    """
    return WorldParameters.checked({name: value for name, value in given.items() if name == "faults"}).faults


def split_arguments(
    name: str, arguments: Sequence[str], is_ros_argument: Callable[[str], bool], form: str
) -> tuple[str | None, list[str]]:
    """Splits a command line into the map file, or None, and the arguments for ROS.

    Args:
        name: Name of the node, or `all`. Only `map` and `all` take a map file.
        arguments: The command line after that name.
        is_ros_argument: Returns True if an argument is for ROS. The first such argument and all that follow it go to ROS.
        form: What ROS arguments look like, for the error message.

    Raises:
        ValueError: There is an unexpected argument before those for ROS.
    """
    first = next((index for index, argument in enumerate(arguments) if is_ros_argument(argument)), len(arguments))
    own, for_ros = list(arguments[:first]), list(arguments[first:])
    takes_map = name in ("map", "all")
    looks_like_an_option = next((index for index, argument in enumerate(own) if argument[:1] == "-" or ":=" in argument), 1)
    if (unexpected := min(looks_like_an_option, takes_map)) < len(own):
        expected = f"a map file and ROS arguments ({form})" if takes_map else f"ROS arguments only ({form})"
        raise ValueError(f"unexpected argument {quoted(own[unexpected])}; {name} takes {expected}")
    return (own[0] if own else None), for_ros


def check_options_follow(marker: str, options: Iterable[str], arguments: Iterable[str]) -> None:
    """Checks that no option of ROS comes before the argument that begins those for ROS.

    Args:
        marker: Argument that begins those for ROS.
        options: Options that ROS reads after it only.
        arguments: The command line.

    Raises:
        ValueError: An option comes before the marker. The message names both.
    """
    options = frozenset(options)
    first = next((argument for argument in arguments if argument == marker or argument in options), marker)
    if first != marker:
        raise ValueError(f"{first} needs {marker} before it")


class ParameterResolver:
    """Turns the values that ROS has for a node into checked parameters. One resolver serves all nodes of a process.

    Args:
        name: Name of the node that runs, or `all`.
        defaults: Defaults of this ROS version, by parameter class, where they differ from the defaults of the class.
        map_file: Map file from the command line, which overrides `yaml_filename`.
    """

    def __init__(self, name: str, defaults: Mapping[type[Parameters], Mapping[str, Any]], map_file: str | None) -> None:
        self._map_is_optional = name == "all"
        self._defaults = defaults
        self._overrides = {"yaml_filename": map_file} if map_file else {}
        self._announced: set[str] = set()

    def resolve(self, model: type[Parameters], given: Mapping[str, Any], logger: Logger) -> Parameters | None:
        """Returns the parameters of one node. With `all`, the map server is optional: returns None if it has no map file.

        Parameter names of nav2_loopback_sim are translated to ours, and each translation is logged once per process. If a
        parameter is given under both names, ours wins.

        Args:
            model: Parameter class of the node.
            given: Values by name. Names that are not parameters of this node are ignored.
            logger: Logger of the node.

        Raises:
            ValueError: A value is invalid, or the map server has no map file.
        """
        values = {**self._defaults.get(model, {}), **self._translated(model, given, logger)}
        values.update((name, value) for name, value in {**given, **self._overrides}.items() if name in model.model_fields)
        if model is MapParameters and "yaml_filename" not in values:
            if self._map_is_optional:
                return None
            raise ValueError(
                "map needs a map file: give MAP.yaml or the parameter yaml_filename (on ROS 1: _yaml_filename:=MAP.yaml)"
            )
        return model.checked(values)

    def defaults_of(self, model: type[Parameters]) -> dict[str, Any]:
        """Returns the defaults of all parameters of a node that have one."""
        own = {name: info.default for name, info in model.model_fields.items() if not info.is_required()}
        return {**own, **self._defaults.get(model, {})}

    def _translated(self, model: type[Parameters], given: Mapping[str, Any], logger: Logger) -> dict[str, Any]:
        values: dict[str, Any] = {}
        for synonym, meaning in translate(given).items():
            own = {name: value for name, value in meaning.items() if name in model.model_fields}
            values.update(own)
            if own and synonym not in self._announced:
                self._announced.add(synonym)
                assignments = ", ".join(f"{name} = {value}" for name, value in own.items())
                logger.info(f"{synonym} (a parameter of nav2_loopback_sim) sets {assignments}")
        return values


class Fleet:
    """The robots of a process, and which parameters each of them gets.

    The parameter `robots` names them. A parameter `robot1.NAME` is the parameter `NAME` of `robot1` only.

    Args:
        given: Values by name, for all nodes of the process.
    """

    def __init__(self, given: Mapping[str, Any]) -> None:
        checked = WorldParameters.checked({name: value for name, value in given.items() if name == "robots"})
        self.names: tuple[str, ...] = checked.robots or ("",)
        self.scanners: dict[str, tuple[str, ...]] = {}
        """Names of the scanners of each robot; one empty name for one scanner without a name."""
        self.unknown: set[str] = set()
        """Names of parameters that were warned about."""

    def owner_of(self, name: str) -> tuple[str, str]:
        """Returns the robot that a parameter is for, or an empty name, and the parameter's name without it."""
        robot, dot, own_name = name.partition(".")
        return (robot, own_name) if dot and robot in self.names else ("", name)

    def check_change(self, name: str, robot: str, node_has: Collection[str]) -> None:
        """Checks that a parameter can change on the node of a robot.

        Args:
            name: Name of the parameter.
            robot: Name of the robot; empty for nodes that belong to no robot.
            node_has: Names of the node's parameters.

        Raises:
            ValueError: The parameter belongs to the node of another robot, or to the world.
        """
        owner, own_name = self.owner_of(name)
        if owner:
            raise ValueError(f"{name} can only be set at startup; set {own_name} on the nodes of {owner}")
        if name in ("robots", "faults") and name not in node_has:
            raise ValueError(f"{name} can only be set at startup")

    def owners_of(self, model: type[Parameters]) -> list[tuple[str, str]]:
        """Returns the robots and scanners that have a node with these parameters.

        The name of the robot is empty if the node belongs to none, and so is that of the scanner if it has none.
        """
        robots = self.names if model in OF_A_ROBOT else ("",)
        if model is not LaserParameters:
            return [(robot, "") for robot in robots]
        return [(robot, scanner) for robot in robots for scanner in self.scanners.get(robot, ("",))]

    def add(self, robot: str, parameters: Parameters) -> None:
        """Notes the scanners of a robot.

        Args:
            robot: Name of the robot.
            parameters: Parameters of one of its nodes. Only those of the robot itself name scanners.
        """
        if isinstance(parameters, RobotParameters):
            self.scanners[robot] = parameters.scanners or ("",)

    def given_to(
        self, robot: str, given: Mapping[str, Any], resolve: Callable[[str], str], scanner: str = ""
    ) -> dict[str, Any]:
        """Returns the values for the nodes of one robot, or of one of its scanners, with frames and seeds of its own.

        Raises ValueError if a parameter of one robot must be the same for all.

        Args:
            robot: Name of the robot; empty for nodes that belong to no robot, and for the only robot.
            given: Values by name, for all nodes of the process.
            resolve: Returns the full name of a topic or service outside of the robots' namespaces, where the map is.
            scanner: Name of the scanner; empty for the other nodes of the robot, and for the only scanner.
        """
        values = of_scanner(scanner, self._given_to_robot(robot, given, resolve))
        # A prefix `<node>:` marks what is only for the node, and counts more.
        return {name.rpartition(":")[2]: value for name, value in values.items()}

    def _given_to_robot(self, robot: str, given: Mapping[str, Any], resolve: Callable[[str], str]) -> dict[str, Any]:
        common = {name: value for name, value in given.items() if not self.owner_of(name)[0]}
        if not robot:
            return common
        own = {self.owner_of(name)[1]: value for name, value in given.items() if self.owner_of(name)[0] == robot}
        for name in OF_ALL_ROBOTS:
            if name in own:
                raise ValueError(f"{name} must be the same for all robots: set {name}, not {robot}.{name}")
        if robot != self.names[0]:
            common["publish_clock"] = False
        values = of_robot(robot, {**common, **own})
        for name in SHARED:
            topic = values.get(name, RobotParameters.model_fields[name].default)
            values[name] = topic and resolve(topic)
        return values


def warn_about_unknown(names: Iterable[str], logger: Logger, fleet: Fleet) -> None:
    """Logs a warning for each name that is not a parameter of any node. The warning suggests the nearest known name.

    Each name is warned about once per process.
    """
    for name in {fleet.owner_of(name)[1]: None for name in names}:
        if name not in SYNONYMS and name not in fleet.unknown:
            try:
                check_names([split(name)[1]], ALL)
            except ValueError as error:
                fleet.unknown.add(name)
                logger.warning(str(error))


def warn_about_scanners(names: Iterable[str], logger: Logger, fleet: Fleet) -> None:
    """Logs a warning for each parameter that is for a scanner which no robot has. Each is warned about once per process."""
    known = {scanner for scanners in fleet.scanners.values() for scanner in scanners}
    for name in names:
        scanner, _ = split(fleet.owner_of(name)[1])
        if scanner and scanner not in known and name not in fleet.unknown:
            fleet.unknown.add(name)
            logger.warning(f"{name} has no effect, because no robot has a scanner {scanner}: name it in scanners")


def change_everywhere(
    behaviours: Sequence[Behaviour], name: str, value_for: Callable[[type[Parameters]], Any]
) -> str | None:
    """Changes one parameter in all running nodes that have it, or in none of them if one refuses.

    Args:
        behaviours: Robot, laser or map server, or several of them.
        name: Name of the parameter.
        value_for: Returns the new value for the parameter class of a node. A LookupError counts as a refusal.

    Returns:
        None, or the reason why the change was refused.
    """
    changed: list[tuple[Behaviour, Any]] = []
    for behaviour in behaviours:
        if name not in (*type(behaviour.parameters).model_fields, *SYNONYMS):
            continue
        before = getattr(behaviour.parameters, name, None)
        try:
            refusal = change_parameters(behaviour, {name: value_for(type(behaviour.parameters))})
        except LookupError:
            refusal = f"{name} has no default and stays {before}"
        if refusal is not None:
            for other, value in changed:
                change_parameters(other, {name: value})
            return refusal
        changed.append((behaviour, before))
    return None


def change_parameters(behaviour: Behaviour, values: Mapping[str, Any]) -> str | None:
    """Changes parameters of a running node: either all of them, or none if a value is refused.

    Args:
        behaviour: Robot, laser or map server.
        values: New values by name. Names that are not parameters of this node are ignored.

    Returns:
        None, or the reason why the change was refused.
    """
    known = {name: value for name, value in values.items() if name in (*type(behaviour.parameters).model_fields, *SYNONYMS)}
    try:
        for name, value in known.items():
            _check_change(behaviour, name, value)
        if known:
            behaviour.set_parameters(**known)
    except (ValueError, TypeError, OSError) as error:
        return str(error)
    return None


def _check_change(behaviour: Behaviour, name: str, value: Any) -> None:
    if name in SYNONYMS:
        own_names = ", ".join(translate({name: value})[name])
        raise ValueError(f"{name} (a parameter of nav2_loopback_sim) can only be set at startup; set {own_names} instead")
    if name in STARTUP_ONLY and value != (current := getattr(behaviour.parameters, name)):
        raise ValueError(f"{name} can only be set at startup and stays {current}")
