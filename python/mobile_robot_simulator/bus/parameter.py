"""Parameters of a node on the bus, under rclpy's names."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar


class ParameterNotDeclaredException(ValueError):
    """A parameter was asked for that was not declared."""


class ParameterAlreadyDeclaredException(ValueError):
    """A parameter was declared twice."""


class ParameterType(Enum):
    """What a parameter's value is, as rclpy numbers it; on the bus any value is taken."""

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9


@dataclass(frozen=True)
class Parameter:
    """A node's parameter."""

    Type: ClassVar[type[ParameterType]] = ParameterType
    name: str
    type_: Any = None
    value: Any = None

    def get_parameter_value(self) -> ParameterValue:
        """The value by its type's name."""
        return ParameterValue(self.value)


@dataclass(frozen=True)
class ParameterValue:
    """A parameter's value, by the name of whichever type it is taken for."""

    value: Any

    def __getattr__(self, name: str) -> Any:
        if name.endswith("_value") and not name.startswith("_"):
            return self.value
        raise AttributeError(name)


@dataclass
class SetParametersResult:
    """Whether parameters could be set, and why not."""

    successful: bool = True
    reason: str = ""
