"""Parameters of a node on the bus, with the class and method names of rclpy."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar

from ..quoting import nearest, quoted
from .parameter_descriptor import ParameterDescriptor


class ParameterNotDeclaredException(ValueError):
    """A parameter that is not declared was read or set."""


class ParameterAlreadyDeclaredException(ValueError):
    """A parameter was declared twice."""


class ParameterImmutableException(ValueError):
    """A read-only parameter was removed."""


class InvalidParameterValueException(ValueError):
    """A parameter was declared with a value that its descriptor excludes."""


class ParameterType(Enum):
    """Types of parameter values, numbered as in rclpy. The bus does not check types."""

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
    """A parameter of a node.

    Attributes:
        name: Name of the parameter.
        type_: Type, as in rclpy. Ignored by the bus.
        value: Value, of any type.
    """

    Type: ClassVar[type[ParameterType]] = ParameterType
    name: str
    type_: Any = None
    value: Any = None

    def get_parameter_value(self) -> ParameterValue:
        """Returns the value in an object with the attributes of rclpy's message, such as `double_value`."""
        return ParameterValue(self.value)


@dataclass(frozen=True)
class ParameterValue:
    """A parameter's value. Each attribute whose name ends in `_value`, such as `double_value`, returns it unchanged.

    Attributes:
        value: The value.
    """

    value: Any

    def __getattr__(self, name: str) -> Any:
        if name.endswith("_value") and not name.startswith("_"):
            return self.value
        raise AttributeError(name)


@dataclass
class SetParametersResult:
    """Result of setting a parameter.

    Attributes:
        successful: True if the parameter was set.
        reason: Why it was not set.
    """

    successful: bool = True
    reason: str = ""


SetParametersCallback = Callable[[list[Parameter]], Any]
"""Takes the parameters that are about to be set and returns a `SetParametersResult`."""


class ParameterStore:
    """The parameters of one node.

    Args:
        owner: Name of the node, for error messages.
        overrides: Values that replace the defaults of parameters when they are declared.
    """

    def __init__(self, owner: str, overrides: Mapping[str, Any]) -> None:
        self._owner = owner
        self._overrides = dict(overrides)
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._checks: list[SetParametersCallback] = []

    def declare(self, name: str, default: Any, descriptor: Any = None) -> Parameter:
        """Adds a parameter. Its value is the override with that name, or else the default.

        Args:
            name: Name of the parameter.
            default: Default value.
            descriptor: A `ParameterDescriptor` of `rcl_interfaces`, or None. `read_only` and the ranges count.

        Raises:
            ParameterAlreadyDeclaredException: The parameter is already declared. It is a ValueError.
            InvalidParameterValueException: The value is out of the descriptor's range. It is a ValueError.
        """
        if name in self._parameters:
            raise ParameterAlreadyDeclaredException(f"parameter {quoted(name)} is already declared")
        value = self._overrides.get(name, default)
        if (problem := _range_problem(value, descriptor)) is not None:
            raise InvalidParameterValueException(f"parameter {quoted(name)} of {self._owner} {problem}")
        self._descriptors[name] = copy.copy(descriptor or ParameterDescriptor())
        self._descriptors[name].name = name
        self._parameters[name] = Parameter(name, value=value)
        return self._parameters[name]

    def has(self, name: str) -> bool:
        """Returns True if the parameter is declared."""
        return name in self._parameters

    def get(self, name: str) -> Parameter:
        """Returns a declared parameter.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared; the message suggests a similar name. It is a
                ValueError.
        """
        if name not in self._parameters:
            near = nearest(name, self._parameters)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise ParameterNotDeclaredException(f"parameter {quoted(name)} of {self._owner} is not declared{hint}")
        return self._parameters[name]

    def set(self, parameters: Sequence[Parameter]) -> list[SetParametersResult]:
        """Sets each parameter, unless its descriptor or a check refuses it.

        Returns:
            One result per parameter: the first refusal, or success.

        Raises:
            ParameterNotDeclaredException: A parameter is not declared. Those before it in the list are set.
        """
        return [self.set_together([parameter]) for parameter in parameters]

    def set_together(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Sets all parameters, or none if the descriptor of one or a check refuses.

        Returns:
            The first refusal, or success.

        Raises:
            ParameterNotDeclaredException: A parameter is not declared. None is set.
        """
        for parameter in parameters:
            self.get(parameter.name)
        for parameter in parameters:
            descriptor = self._descriptors[parameter.name]
            problem = _range_problem(parameter.value, descriptor)
            if getattr(descriptor, "read_only", False):
                problem = "is read-only"
            if problem is not None:
                return SetParametersResult(False, f"parameter {quoted(parameter.name)} {problem}")
        for check in self._checks:
            answer: SetParametersResult = check(list(parameters))
            if not answer.successful:
                return answer
        self._parameters.update({parameter.name: parameter for parameter in parameters})
        return SetParametersResult()

    def undeclare(self, name: str) -> None:
        """Removes a parameter.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared.
            ParameterImmutableException: The parameter is read-only.
        """
        self.get(name)
        if getattr(self._descriptors[name], "read_only", False):
            raise ParameterImmutableException(f"parameter {quoted(name)} of {self._owner} is read-only")
        del self._parameters[name], self._descriptors[name]

    def describe(self, name: str) -> Any:
        """Returns the descriptor of a parameter.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared.
        """
        self.get(name)
        return self._descriptors[name]

    def add_check(self, check: SetParametersCallback) -> None:
        """Adds a callback that can refuse new values."""
        self._checks.append(check)


def _range_problem(value: Any, descriptor: Any) -> str | None:
    """Returns why a descriptor's ranges exclude a value, or None if they do not."""
    for kind in ("floating_point_range", "integer_range"):
        for bounds in getattr(descriptor, kind, ()):
            if isinstance(value, (int, float)) and not bounds.from_value <= value <= bounds.to_value:
                return f"must be from {bounds.from_value} to {bounds.to_value}, got {value}"
    return None
