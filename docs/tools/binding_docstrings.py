"""A griffe extension that adds the docstrings of the Rust binding to the API reference.

The stub `_core.pyi` has the types, the compiled module has the docstrings. Each docstring is written once, in Rust.
"""

from __future__ import annotations

import inspect
from typing import Any

import griffe

import mobile_robot_simulator._core as core

PREFIX = f"{core.__name__}."


class BindingDocstrings(griffe.Extension):
    """Adds to the objects of the stub what the stub does not contain."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Takes the docstring from the object of the same name in the compiled module."""
        if obj.docstring is not None or obj.name.startswith("_") or not obj.path.startswith(PREFIX):
            return
        found: Any = core
        for name in obj.path.removeprefix(PREFIX).split("."):
            found = getattr(found, name, None)
        if text := getattr(found, "__doc__", None):
            obj.docstring = griffe.Docstring(inspect.cleandoc(text), parent=obj, parser="google")

    def on_class(self, *, cls: griffe.Class, **_: Any) -> None:
        """Shows the signature of `__new__` as that of `__init__`: the classes of the binding have no `__init__`."""
        new = cls.members.get("__new__")
        if cls.path.startswith(PREFIX) and isinstance(new, griffe.Function):
            init = griffe.Function("__init__", parameters=griffe.Parameters(*list(new.parameters)[1:]), lineno=new.lineno)
            del cls.members["__new__"]
            cls.set_member("__init__", init)
