"""Descriptions of parameters, with the names of `rcl_interfaces.msg`."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(kw_only=True)
class FloatingPointRange:
    """Range of a parameter that is a number.

    Attributes:
        from_value: Smallest value.
        to_value: Largest value.
        step: Distance between two values. 0 for any value. Not checked.
    """

    from_value: float = 0.0
    to_value: float = 0.0
    step: float = 0.0


@dataclass(kw_only=True)
class IntegerRange:
    """Range of a parameter that is an integer.

    Attributes:
        from_value: Smallest value.
        to_value: Largest value.
        step: Distance between two values. 0 or 1 for any value. Not checked.
    """

    from_value: int = 0
    to_value: int = 0
    step: int = 0


@dataclass(kw_only=True)
class ParameterDescriptor:
    """Description of a parameter. The bus refuses to set a parameter that is read-only or out of range.

    Attributes:
        name: Name of the parameter.
        type: Number of its type. Not checked.
        description: What it is for.
        additional_constraints: What else its value must be. Not checked.
        read_only: True if it cannot be set after its declaration.
        dynamic_typing: True if its type can change. Has no effect, because the bus does not check types.
        floating_point_range: One range, or none.
        integer_range: One range, or none.
    """

    name: str = ""
    type: int = 0
    description: str = ""
    additional_constraints: str = ""
    read_only: bool = False
    dynamic_typing: bool = False
    floating_point_range: list[FloatingPointRange] = field(default_factory=list)
    integer_range: list[IntegerRange] = field(default_factory=list)
