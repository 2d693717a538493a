"""Parameters: the base class of the parameters of a node."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any, ClassVar, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from .errors import explain

T = TypeVar("T", bound="Parameters")


class Parameters(BaseModel):
    """Base class of the parameters of a node. Immutable; every instance has passed all checks.

    Raises:
        ValueError: A name is unknown or a value is invalid. The message gives the name, the value and the requirement.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    node_name: ClassVar[str]
    """Name of the node, as in parameter files."""

    def __init__(self, **values: Any) -> None:
        try:
            super().__init__(**values)
        except ValidationError as error:
            raise ValueError(explain(error, type(self).model_fields)) from None

    @classmethod
    def checked(cls: type[T], values: Mapping[str, Any]) -> T:
        """Returns parameters with these values, and defaults for all others.

        Args:
            values: Values by parameter name.

        Raises:
            ValueError: A name is unknown or a value is invalid. The message gives the name, the value and the requirement.
        """
        return cls(**values)

    def changed(self: T, values: Mapping[str, Any]) -> T:
        """Returns a copy with some values changed, after checking them as `checked` does.

        Args:
            values: Changed values by parameter name.

        Raises:
            ValueError: A name is unknown or a value is invalid.
        """
        given = self.model_dump(include=self.model_fields_set)
        return type(self).checked({**given, **values})

    @cached_property
    def frames(self) -> Mapping[str, str]:
        """Full name of each frame: the value of a parameter such as `base_link_frame`, after `frame_prefix`.

        Computed once, because the nodes need frames for each message. It has an entry for every parameter that is a text.
        """
        prefix, texts = getattr(self, "frame_prefix", ""), {name: value for name, value in self if isinstance(value, str)}
        return {name: f"{prefix}{text.lstrip('/')}" if prefix else text for name, text in texts.items()}


FRAME_PREFIX: Any = Field("", description="prefix of all frames except the map's, such as robot1/")
