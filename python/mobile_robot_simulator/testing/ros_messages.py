"""Classes for ROS messages and services that `messages` does not define, generated from their definitions.

The definitions of the common packages come with rosbags. Definitions of other packages can be registered. A class takes
keywords, has a default for every field, and checks each value that is assigned, as the classes of rclpy do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, make_dataclass
from typing import Any, ClassVar

import numpy as np

from .. import messages
from ..messages import Message

Check = Callable[[Any], Any]
"""Takes the value of a field. Returns the value to store, or raises AssertionError."""

FieldType = tuple[int, Any]
"""Type of a field in rosbags: one of the kinds below, and what it consists of."""

BASE, NAME, ARRAY, SEQUENCE = 1, 2, 3, 4
"""Kinds of field types in rosbags: a basic type, a message, an array of a fixed length, and one of any length."""

INTEGERS = {"byte", "char", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}
IDL_NAMES = {"float64": "double", "float32": "float", "bool": "boolean", "byte": "octet", "char": "uint8"}
"""Names of basic types in `get_fields_and_field_types`, where they differ from those in a definition."""

SERVICES = {
    "example_interfaces/srv/AddTwoInts": "int64 a\nint64 b\n---\nint64 sum",
    "nav_msgs/srv/GetPlan": "geometry_msgs/PoseStamped start\ngeometry_msgs/PoseStamped goal\nfloat32 tolerance\n---\n"
    "nav_msgs/Path plan",
    "std_srvs/srv/Empty": "---",
    "std_srvs/srv/SetBool": "bool data\n---\nbool success\nstring message",
}
"""Definitions of common services, which rosbags does not have."""


class RosMessage(Message):
    """Base class of the generated messages. An assignment of a wrong type raises AssertionError, as in rclpy."""

    __slots__ = ()
    _checks: ClassVar[Mapping[str, Check]]
    _field_types: ClassVar[Mapping[str, str]]

    def __setattr__(self, name: str, value: Any) -> None:
        check = self._checks.get(name)
        object.__setattr__(self, name, value if check is None else check(value))

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Returns the type of each field by its name, such as `double` or `geometry_msgs/Point`."""
        return dict(cls._field_types)


_made: dict[str, type] = {kind.ros_type: kind for kind in vars(messages).values() if hasattr(kind, "ros_type")}
"""Classes of messages and services by ROS type. One type has one class, because a topic carries one class."""

_registered: dict[str, str] = {}
"""Definitions that users have registered, by ROS type."""


def register_definitions(definitions: Mapping[str, str]) -> None:
    """Registers definitions of messages and services, and makes their classes.

    Args:
        definitions: Texts of `.msg` and `.srv` files by ROS type, such as `my_msgs/msg/Speeds`. A definition comes after
            those that it uses.

    Raises:
        ImportError: rosbags is not installed.
        ValueError: A name is not a ROS type, a definition is wrong, or the type already has another definition.
    """
    for ros_type, text in definitions.items():
        parts = ros_type.split("/")
        if len(parts) != 3 or not all(parts) or parts[1] not in ("msg", "srv"):
            raise ValueError(f"a ROS type is package/msg/Name or package/srv/Name, got {ros_type!r}")
        if _registered.get(ros_type, text) != text:
            raise ValueError(f"{ros_type} already has another definition")
        if ros_type in _registered:
            continue
        if ros_type in _made or ros_type in SERVICES or ros_type in _types().fielddefs:
            raise ValueError(f"{ros_type} is a common type, which cannot be defined again")
        if parts[1] == "srv":
            _made[ros_type] = _service(ros_type, text)
        else:
            definition = _parsed(ros_type, text)
            kind = _message(ros_type, definition)
            _types().register({ros_type: definition})
            _made[ros_type] = kind
        _registered[ros_type] = text


def generated_packages() -> dict[str, dict[str, object]]:
    """Returns the classes of all definitions by ROS module and name, or nothing if rosbags is not installed."""
    try:
        types = _types()
    except ImportError:
        return {}
    for ros_type, text in SERVICES.items():
        if ros_type not in _made:
            _made[ros_type] = _service(ros_type, text)
    packages: dict[str, dict[str, object]] = {}
    for ros_type in [*types.fielddefs, *SERVICES, *_registered]:
        package, folder, name = ros_type.split("/")
        packages.setdefault(f"{package}.{folder}", {})[name] = _class_of(ros_type)
    return packages


def _types() -> Any:
    """Returns the definitions of messages, which recordings use as well.

    Raises:
        ImportError: rosbags is not installed.
    """
    from ..recording.serialization import ros2_types

    return ros2_types()


def _parsed(ros_type: str, text: str) -> Any:
    """Returns the constants and fields of a definition.

    Raises:
        ValueError: The definition is wrong.
    """
    from rosbags.typesys import TypesysError, get_types_from_msg

    try:
        (definition,) = get_types_from_msg(text, ros_type.replace("/srv/", "/msg/")).values()
    except TypesysError as error:
        raise ValueError(f"wrong definition of {ros_type}: {error}") from None
    return definition


def _class_of(ros_type: str) -> type:
    if ros_type not in _made:
        definition = _types().fielddefs.get(ros_type)
        if definition is None:
            raise ValueError(f"{ros_type} has no definition")
        _made[ros_type] = _message(ros_type, definition)
    return _made[ros_type]


def _service(ros_type: str, text: str) -> type:
    parts = [part.strip() for part in f"\n{text}\n".split("\n---\n")]
    if len(parts) != 2:
        raise ValueError(f"{ros_type} must have one line '---', between request and response")
    kinds = {}
    for name, part in zip(("Request", "Response"), parts, strict=True):
        kinds[name] = _message(f"{ros_type}_{name}", _parsed(f"{ros_type}_{name}", part))
    return type(ros_type.split("/")[2], (), {"ros_type": ros_type, **kinds})


def _message(ros_type: str, definition: Any) -> type:
    constants, members = definition
    package, folder, class_name = ros_type.split("/")
    fields, checks, field_types = [], {}, {}
    for name, kind in members:
        make, check, field_types[name] = _field(kind, f"{class_name}.{name}")
        checks[name] = check
        fields.append((name, Any, field(default_factory=make)))
    namespace = {
        **{name: value for name, _, value in constants},
        "ros_type": ros_type,
        "_checks": checks,
        "_field_types": field_types,
        "__doc__": f"The ROS message {ros_type}, generated from its definition.",
        "__module__": f"{package}.{folder}",
    }
    return make_dataclass(class_name, fields, bases=(RosMessage,), namespace=namespace, eq=False, kw_only=True, slots=True)


def _field(kind: FieldType, where: str) -> tuple[Callable[[], Any], Check, str]:
    """Returns how to make the default of a field, how to check a value, and the name of the type in rclpy."""
    node, content = int(kind[0]), kind[1]
    if node == BASE:
        name, limit = content
        default, check = _basic(name, where)
        return lambda: default, check, IDL_NAMES.get(name, name) + (f"<{limit}>" if limit else "")
    if node == NAME:
        made = _class_of(content)
        return made, _instance_check(made, made.__name__, where), content.replace("/msg/", "/")
    (item, length) = content
    make_item, check_item, item_name = _field(item, f"{where}[]")
    count = length if node == ARRAY else 0
    if int(item[0]) == BASE and item[1][0] not in ("string", "wstring"):
        base = item[1][0]
        dtype = np.dtype({"byte": "uint8", "char": "uint8"}.get(base, base))
        make, check = _array(dtype, count, node, length, where)
    else:
        make, check = _list(make_item, check_item, count, node, length, where)
    bound = f", {length}" if length else ""
    return make, check, f"{item_name}[{length}]" if node == ARRAY else f"sequence<{item_name}{bound}>"


def _basic(name: str, where: str) -> tuple[Any, Check]:
    """Returns the default of a basic type and how to check its values."""
    if name in INTEGERS:
        limits = np.iinfo({"byte": "uint8", "char": "uint8"}.get(name, name))

        def check_integer(value: Any) -> int:
            if name == "byte" and isinstance(value, bytes) and len(value) == 1:
                return value[0]
            _need(isinstance(value, int), where, "an int", value)
            _need(limits.min <= value <= limits.max, where, f"between {limits.min} and {limits.max}", value)
            return int(value)

        return 0, check_integer
    kind = {"bool": bool, "string": str, "wstring": str}.get(name, float)
    return kind(), _instance_check(kind, kind.__name__, where)


def _instance_check(kind: type, name: str, where: str) -> Check:
    def check(value: Any) -> Any:
        _need(isinstance(value, kind), where, f"a {name}", value)
        return value

    return check


def _array(dtype: np.dtype[Any], count: int, node: int, length: int, where: str) -> tuple[Callable[[], Any], Check]:
    """Returns default and check of a field with an array of numbers. A sequence of numbers is converted to an array."""
    accepted = "iuf" if dtype.kind == "f" else "iu" if dtype.kind in "iu" else dtype.kind

    def check(value: Any) -> Any:
        try:
            given = np.frombuffer(value, np.uint8) if isinstance(value, (bytes, bytearray)) else np.asarray(value)
        except ValueError:
            given = np.zeros((0, 0))
        fits = given.ndim == 1 and (given.size == 0 or given.dtype.kind in accepted)
        if fits and given.size and dtype.kind in "iu":
            limits = np.iinfo(dtype)
            fits = bool(limits.min <= given.min() and given.max() <= limits.max)
        _need(fits, where, f"a sequence of {dtype}", value)
        _check_length(len(given), node, length, where)
        return value if given is value and given.dtype == dtype else given.astype(dtype)

    return lambda: np.zeros(count, dtype), check


def _list(
    make_item: Callable[[], Any], check_item: Check, count: int, node: int, length: int, where: str
) -> tuple[Callable[[], Any], Check]:
    """Returns default and check of a field with a list of texts or messages."""

    def check(value: Any) -> Any:
        _need(isinstance(value, (list, tuple)), where, "a list", value)
        _check_length(len(value), node, length, where)
        return [check_item(item) for item in value]

    return lambda: [make_item() for _ in range(count)], check


def _check_length(got: int, node: int, length: int, where: str) -> None:
    if node == ARRAY:
        _need(got == length, where, f"of length {length}", got)
    elif length:
        _need(got <= length, where, f"at most {length} long", got)


def _need(fits: bool, where: str, what: str, got: Any) -> None:
    if not fits:
        raise AssertionError(f"{where} must be {what}, got {got!r}")
