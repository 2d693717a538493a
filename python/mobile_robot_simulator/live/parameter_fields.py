"""Parameter fields: what a page must know of each parameter to show it: its unit, its limits and its choices."""

from __future__ import annotations

import math
import re
from typing import Any

from ..parameters import Parameters

SELDOM = (
    "scanners",
    "publish_map_transform",
    "publish_rate",
    "publish_clock",
    "clock_rate",
    "initial_pose",
    "cmd_vel_stamped",
    "speed_factor",
)
"""Parameters that are seldom changed while a robot drives, beside names. The speed has a control of its own."""

_UNIT = re.compile(r"\[((?:m|s|rad|Hz|1/m)(?:[/,^ \d]|m|s|rad)*)\]")


def fields_of(model: type[Parameters]) -> list[dict[str, Any]]:
    """Returns the parameters of a node, each as a dictionary that JSON can hold.

    Args:
        model: Parameter class of the node.

    Returns:
        For each parameter: `name`, `help` (its description), `unit` (empty without one), `limits` (a text, empty without
        limits), `choices` (a list of texts if only these are allowed, else None), and `is_seldom`: True for what is seldom
        changed while a robot drives, such as names of topics and frames.
    """
    properties = model.model_json_schema()["properties"]
    return [
        {
            "name": name,
            "help": info.description or "",
            "unit": _unit(info.description or ""),
            "limits": _limits(properties[name]),
            "choices": _choices(properties[name]),
            "is_seldom": name in SELDOM or _is_name(name, properties[name]),
        }
        for name, info in model.model_fields.items()
    ]


def _is_name(name: str, schema: dict[str, Any]) -> bool:
    """Returns True for names of topics, frames and services."""
    return schema.get("type") == "string" and "enum" not in schema and name != "footprint"


def _unit(description: str) -> str:
    found = _UNIT.findall(description)
    return found[-1] if found else ""


def _limits(schema: dict[str, Any]) -> str:
    """Returns the limits of a number, such as `above 0, at most 1000`."""
    schema = next((each for each in schema.get("anyOf", ()) if "type" in each and each["type"] != "null"), schema)
    if schema.get("type") == "array":
        items = schema.get("prefixItems", [{}])
        return f"{len(items)} numbers{f', each {text}' if (text := _limits(items[0])) else ''}" if len(items) > 1 else ""
    # Behind a validator of our own, pydantic gives its own names of the limits.
    above, least = schema.get("exclusiveMinimum", schema.get("gt")), schema.get("minimum", schema.get("ge"))
    most = schema.get("maximum", schema.get("le"))
    texts = [f"above {_number(above)}"] if above is not None else []
    if least is not None and most is not None:
        return f"{_number(least)} to {_number(most)}"
    texts += [f"at least {_number(least)}"] if least is not None else []
    texts += [f"at most {_number(most)}"] if most is not None else []
    return ", ".join(texts)


def _number(value: float) -> str:
    turns = value / (2.0 * math.pi)
    return f"{2 * round(turns)}π" if round(turns) and abs(turns - round(turns)) < 1e-5 else f"{value:,.10g}"


def _choices(schema: dict[str, Any]) -> list[str] | None:
    if schema.get("type") == "boolean":
        return ["true", "false"]
    choices: list[str] | None = schema.get("enum")
    return choices
