"""Reads and writes ROS 2 parameter files, and reads assignments such as `name:=value`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from .parameters import NODES, check_names, for_node, unknown_name


def read_file(path: str | Path) -> dict[str, Any]:
    """Reads the values in a ROS 2 parameter file.

    Args:
        path: YAML file with sections that hold `ros__parameters`. The section `/**` is for all nodes; a section with the
            name of a node is for that node only.

    Returns:
        Values by key, as `parameters.for_node` takes them: the key is `name` for a value from `/**`, and `node:name` for a
        value from the section of a node.

    Raises:
        OSError: The file cannot be read.
        ValueError: The content is not YAML, does not have this structure, or names an unknown node or parameter.
    """
    data = Path(path).read_bytes()
    try:
        content = yaml.safe_load(data)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is not YAML: {error}") from None
    if not isinstance(content, dict):
        raise ValueError(f"{path} must contain node names with ros__parameters, got {type(content).__name__}")
    nodes = {model.node_name: model for model in NODES}
    values: dict[str, Any] = {}
    for key in sorted(content, key=lambda key: key != "/**"):
        node = str(key).lstrip("/")
        if node not in (*nodes, "**"):
            raise ValueError(f"{path}: {unknown_name(str(key), ['/**', *nodes], kind='node')}")
        section = content[key]
        parameters = section.get("ros__parameters") if isinstance(section, dict) else None
        if not isinstance(parameters, dict):
            raise ValueError(f"{path}: {key} must contain a mapping ros__parameters, got {section!r}")
        check_names(map(str, parameters), NODES if node == "**" else (nodes[node],))
        values.update(parameters if node == "**" else {f"{node}:{name}": value for name, value in parameters.items()})
    return values


def read_assignment(text: str) -> tuple[str, Any]:
    """Returns the key and the value of an assignment, as in `--param name:=value`.

    Args:
        text: `name:=value`, or `node:name:=value` for one node only. The value is YAML.

    Raises:
        ValueError: The text is not an assignment, the parameter is unknown, or the value is not YAML.
    """
    name, separator, value = text.partition(":=")
    if not separator or not name:
        raise ValueError(f"a parameter must have the form name:=value, got {text!r}")
    check_names([name])
    try:
        return name, yaml.safe_load(value)
    except yaml.YAMLError:
        raise ValueError(f"the value of {name} must be YAML, got {value!r}") from None


def to_yaml(values: Mapping[str, Any] | None = None) -> str:
    """Returns a parameter file with the values and descriptions of all parameters.

    Args:
        values: Values by key, as `read_file` returns them. All other parameters have their defaults.

    Raises:
        ValueError: A name is unknown or a value is invalid.
    """
    check_names(values or {})
    lines = []
    for model in NODES:
        parameters = for_node(model, values or {})
        lines += [f"{model.node_name}:", "  ros__parameters:"]
        for name, info in model.model_fields.items():
            value = yaml.safe_dump(getattr(parameters, name), default_flow_style=True).removesuffix("...\n").strip()
            value = f"[{', '.join(map(str, getattr(parameters, name)))}]" if value.startswith("!!python/tuple") else value
            lines.append(f"    {name}: {value}".ljust(46) + f"  # {info.description}")
    return "\n".join(lines) + "\n"
