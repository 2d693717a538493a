"""The nodes that a parameter file can set, and which values are for which of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from .errors import unknown_name
from .laser import LaserParameters
from .model import Parameters
from .robot import RobotParameters

T = TypeVar("T", bound=Parameters)

NODES: tuple[type[Parameters], ...] = (RobotParameters, LaserParameters)
"""Parameter classes of the nodes that a parameter file can set."""


def check_names(names: Iterable[str], models: Iterable[type[Parameters]] = NODES) -> None:
    """Checks that every name is a parameter of one of the nodes.

    Args:
        names: Parameter names; `node:name` stands for the parameter `name` of that node only.
        models: Parameter classes of the nodes.

    Raises:
        ValueError: A name is unknown. The message suggests the nearest known name.
    """
    models = tuple(models)
    known = sorted({name for model in models for name in model.model_fields})
    for key in names:
        node, separator, name = key.rpartition(":") if isinstance(key, str) else ("", "", key)
        own = [model for model in models if model.node_name == node]
        if separator and not own:
            raise ValueError(unknown_name(node, [model.node_name for model in models], kind="node"))
        if name not in (own[0].model_fields if own else known):
            raise ValueError(unknown_name(name, own[0].model_fields if own else known))


def for_node(model: type[T], values: Mapping[str, Any]) -> T:
    """Returns the parameters of one node from values for all nodes.

    Args:
        model: Parameter class of the node.
        values: Values by key. The key `name` sets the parameter of every node that has it. The key `node:name` sets the
            parameter of that node only and takes precedence.

    Raises:
        ValueError: A value is invalid.
    """
    own = {name: values[name] for name in model.model_fields if name in values}
    for name in model.model_fields:
        if (key := f"{model.node_name}:{name}") in values:
            own[name] = values[key]
    return model.checked(own)
