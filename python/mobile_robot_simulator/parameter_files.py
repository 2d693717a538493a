"""Reads and writes ROS 2 parameter files, and reads assignments such as `name:=value`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from .nav2_loopback_names import SYNONYMS, translate
from .parameters import NODES, LaserParameters, Parameters, WorldParameters, check_names, for_node
from .quoting import misspelled, quoted
from .scanners import check_robot_names, split
from .user_files import read_text
from .yaml_documents import MappingNode, Node, entries_of, parse, text_of, value_of

_PARAMETERS = "ros__parameters"
_WILDCARDS = ("*", "**")

FAULTS = "faults"
"""Parameter with the faults of a process, in the section for all nodes or of the world server."""


def is_for_ros(name: str) -> bool:
    """Returns True if a parameter belongs to ROS itself, which every node of ROS 2 has."""
    return name in ("use_sim_time", "start_type_description_service") or name.startswith("qos_overrides.")


def read_file(path: str | Path) -> dict[str, Any]:
    """Reads the values in a ROS 2 parameter file, as the nodes on ROS 2 do.

    Args:
        path: YAML file with sections that hold `ros__parameters`. The section `/**` is for all nodes; a section with the
            name of a node is for that node only, in any namespace. Sections of other nodes are ignored, and so are the
            parameters of ROS itself, such as `use_sim_time`, and `faults`, which `read_fault_texts` reads.

    Returns:
        Values by key, as `parameters.for_node` takes them: the key is `name` for a value from `/**`, and `node:name` for a
        value from the section of a node. Parameters of nav2_loopback_sim have their own names; `translated` replaces them.

    Raises:
        OSError: The file cannot be read.
        ValueError: The content is not YAML or does not have this structure, no section is for these nodes, one node has
            sections in two namespaces, or a parameter is unknown.
    """
    root = _read_root(path)
    models = {model.node_name: model for model in NODES}
    sections: dict[str, tuple[str, MappingNode]] = {}
    others = []
    for name, section in _sections(root, "", path):
        namespace, _, node = name.rpartition("/")
        if node not in (*models, *_WILDCARDS):
            if near := misspelled(node, models):
                raise ValueError(f"{path}: unknown node {quoted(node)}; did you mean {near[0]!r}?")
            others.append(name)
            continue
        node = "**" if node in _WILDCARDS else node
        if node in sections:
            first = f"{sections[node][0]}/{node}"
            raise ValueError(f"{path}: there must be one section for {node}, got {quoted(first)} and {quoted(name)}")
        sections[node] = (namespace, section)
    if others and not sections:
        raise ValueError(f"{path}: must have a section for {', '.join(models)} or /**, got sections for {quoted(others)}")
    values: dict[str, Any] = {}
    for node, (_, section) in sorted(sections.items(), key=lambda item: item[0] != "**"):
        own = {name: value for name, value in _flat(section, "", path) if not is_for_ros(name)}
        if node == "**":
            own.pop(FAULTS, None)
        _check_names(own, NODES if node == "**" else (models[node],), path)
        values.update(own if node == "**" else {f"{node}:{name}": value for name, value in own.items()})
    return values


def read_fault_texts(path: str | Path) -> tuple[str, ...]:
    """Reads the parameter `faults` of a ROS 2 parameter file: the texts of all faults, empty if there is none.

    Args:
        path: YAML file. The section `/**` has the parameter, or that of the node `world_server`, which counts more.

    Raises:
        OSError: The file cannot be read.
        ValueError: The content is not YAML or does not have this structure, or `faults` is not a list of texts.
    """
    found: dict[str, Any] = {}
    for name, section in _sections(_read_root(path), "", path):
        node = name.rpartition("/")[2]
        if node in (*_WILDCARDS, WorldParameters.node_name):
            found.update((node, value) for name, value in _flat(section, "", path) if name == FAULTS)
    texts = found.get(WorldParameters.node_name, next(iter(found.values()), ()))
    try:
        return WorldParameters.checked({FAULTS: texts}).faults
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _read_root(path: str | Path) -> MappingNode:
    root = parse(read_text(path), path)
    if not isinstance(root, MappingNode):
        got = "nothing" if root is None else text_of(root)
        raise ValueError(f"{path}: must contain node names with {_PARAMETERS}, got {got}")
    return root


def _sections(node: MappingNode, prefix: str, path: str | Path) -> Iterator[tuple[str, MappingNode]]:
    """Yields the full name of each node and the mapping of its parameters. Namespaces are mappings around the nodes."""
    for key, value in entries_of(node, path).items():
        name = f"{prefix}/{key.strip('/')}"
        if key == _PARAMETERS and prefix and isinstance(value, MappingNode):
            yield prefix, value
        elif key != _PARAMETERS and isinstance(value, MappingNode) and value.value:
            yield from _sections(value, name, path)
        else:
            where = prefix if key == _PARAMETERS else key
            line = value.start_mark.line + 1
            raise ValueError(f"{path}: line {line}: {where} must contain a mapping {_PARAMETERS}, got {text_of(value)}")


def _flat(node: MappingNode, prefix: str, path: str | Path) -> Iterator[tuple[str, Any]]:
    """Yields names and values. The name of a value in a mapping is that of the mapping, a dot, and its own."""
    for key, value in entries_of(node, path).items():
        if isinstance(value, MappingNode):
            yield from _flat(value, f"{prefix}{key}.", path)
        else:
            yield f"{prefix}{key}", value_of(value)


def read_assignment(text: str) -> tuple[str, Any]:
    """Returns the key and the value of an assignment, as in `--param name:=value`.

    Args:
        text: `name:=value`, or `node:name:=value` for one node only. The value is YAML, with the types of ROS 2: 1e7 is a
            number.

    Raises:
        ValueError: The text is not an assignment, the parameter is unknown, or the value is not YAML.
    """
    name, separator, value = text.partition(":=")
    if not separator or not name:
        raise ValueError(f"a parameter must have the form name:=value, got {quoted(text)}")
    _check_names([name])
    try:
        return name, value_of(_without_mapping(parse(value)))
    except ValueError as error:
        raise ValueError(f"the value of {name} must be YAML, got {quoted(value)}: {error}") from None


def _without_mapping(node: Node | None) -> Node | None:
    if isinstance(node, MappingNode):
        raise ValueError("a value must be a single value or a list")
    return node


def translated(values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns values without the names of ROS itself, and with our names instead of those of nav2_loopback_sim.

    If a parameter is given under both names, ours wins.

    Args:
        values: Values by key, as `read_file` returns them.

    Raises:
        ValueError: A value of nav2_loopback_sim cannot be translated.
    """
    names = {key: key.rpartition(":")[2] for key in values}
    result = {key: value for key, value in values.items() if names[key] not in SYNONYMS and not is_for_ros(names[key])}
    for model in NODES:
        given = {key: value for key, value in values.items() if key == names[key]}
        given |= {names[key]: value for key, value in values.items() if key == f"{model.node_name}:{names[key]}"}
        for meaning in translate(given).values():
            own = {name: value for name, value in meaning.items() if name in model.model_fields and name not in given}
            result.update({f"{model.node_name}:{name}": value for name, value in own.items()})
    return result


def _check_names(names: Iterable[str], models: Iterable[type[Parameters]] = NODES, path: str | Path | None = None) -> None:
    """Checks names like `check_names`. Those of nav2_loopback_sim and of ROS itself are known too."""
    bare = ((name, name.rpartition(":")[2]) for name in names if not split(name)[0])
    try:
        check_names([name for name, own in bare if own not in SYNONYMS and not is_for_ros(own)], models)
    except ValueError as error:
        raise ValueError(str(error) if path is None else f"{path}: {error}") from None


def to_yaml(values: Mapping[str, Any] | None = None) -> str:
    """Returns a parameter file with the values and descriptions of all parameters.

    Args:
        values: Values by key, as `read_file` returns them. All other parameters have their defaults.

    Raises:
        ValueError: A name is unknown or a value is invalid.
    """
    values = values or {}
    check_robot_names(values)
    lines = []
    for model in NODES:
        parameters = for_node(model, values)
        lines += [f"{model.node_name}:", "  ros__parameters:"]
        for name, info in model.model_fields.items():
            lines.append(f"    {name}: {yaml_of(getattr(parameters, name))}".ljust(46) + f"  # {info.description}")
        if model is LaserParameters:
            own = ((key.rpartition(":")[2], value) for key, value in values.items() if split(key)[0])
            lines += [f"    {name}: {yaml_of(value)}" for name, value in own]
    return "\n".join(lines) + "\n"


def yaml_of(value: Any) -> str:
    """Returns the value of a parameter as YAML on one line."""
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(str, value))}]"
    return yaml.safe_dump(value, default_flow_style=True).removesuffix("...\n").strip()
