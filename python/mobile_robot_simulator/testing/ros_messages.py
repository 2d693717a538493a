"""Classes for ROS messages, services and actions that `messages` does not define, generated from their definitions.

The definitions of the common packages come with rosbags. Definitions of other packages can be registered. A class takes
keywords, has a default for every field, and checks each value that is assigned, as the classes of rclpy do.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, make_dataclass
from typing import Any, ClassVar

import numpy as np

from .. import messages
from ..messages import Message
from .common_definitions import ACTIONS, SERVICES

Check = Callable[[Any], Any]
"""Takes the value of a field. Returns the value to store, or raises AssertionError."""

FieldType = tuple[int, Any]
"""Type of a field in rosbags: one of the kinds below, and what it consists of."""

Definition = tuple[list[Any], list[tuple[str, FieldType]]]
"""Constants and fields of a message in rosbags."""

BASE, NAME, ARRAY, SEQUENCE = 1, 2, 3, 4
"""Kinds of field types in rosbags: a basic type, a message, an array of a fixed length, and one of any length."""

INTEGERS = {"byte", "char", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64))}
IDL_NAMES = {"float64": "double", "float32": "float", "bool": "boolean", "byte": "octet", "char": "uint8"}
"""Names of basic types in `get_fields_and_field_types`, where they differ from those in a definition."""


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
"""Classes of messages, services and actions by ROS type. One type has one class, because a topic carries one class."""

_registered: dict[str, str] = {}
"""Definitions that users have registered, by ROS type."""


def register_definitions(definitions: Mapping[str, str]) -> None:
    """Registers definitions of messages, services and actions, and makes their classes.

    Args:
        definitions: Texts of `.msg`, `.srv` and `.action` files by ROS type, such as `my_msgs/msg/Speeds`. A definition
            comes after those that it uses.

    Raises:
        ImportError: rosbags is not installed.
        ValueError: A name is not a ROS type, a definition is wrong, or the type already has another definition.
    """
    for ros_type, text in definitions.items():
        parts = ros_type.split("/")
        if len(parts) != 3 or not all(parts) or parts[1] not in ("msg", "srv", "action"):
            raise ValueError(f"a ROS type is package/msg/Name, package/srv/Name or package/action/Name, got {ros_type!r}")
        if _registered.get(ros_type, text) != text:
            raise ValueError(f"{ros_type} already has another definition")
        if ros_type in _registered:
            continue
        if ros_type in _made or ros_type in SERVICES or ros_type in ACTIONS or ros_type in _types().fielddefs:
            raise ValueError(f"{ros_type} is a common type, which cannot be defined again")
        if parts[1] != "msg":
            _make_common()
            _made[ros_type] = (_service if parts[1] == "srv" else _action)(ros_type, text)
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
    _make_common()
    packages: dict[str, dict[str, object]] = {}
    for ros_type in [*types.fielddefs, *SERVICES, *ACTIONS, *_registered]:
        package, folder, name = ros_type.split("/")
        packages.setdefault(f"{package}.{folder}", {})[name] = message_class(ros_type)
    return packages


def _make_common() -> None:
    """Makes the classes of the common services and actions."""
    for make, definitions in ((_service, SERVICES), (_action, ACTIONS)):
        for ros_type, text in definitions.items():
            if ros_type not in _made:
                _made[ros_type] = make(ros_type, text)


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

    package, _, name = ros_type.split("/")
    try:
        (definition,) = get_types_from_msg(text, f"{package}/msg/{name}").values()
    except TypesysError as error:
        raise ValueError(f"wrong definition of {ros_type}: {error}") from None
    return definition


def message_class(ros_type: str) -> Any:
    """Returns the class of a message or of a common service.

    Raises:
        ValueError: The type has no definition.
    """
    if ros_type not in _made:
        definition = _types().fielddefs.get(ros_type)
        if definition is None:
            raise ValueError(f"{ros_type} has no definition")
        _made[ros_type] = _message(ros_type, definition)
    return _made[ros_type]


def _service(ros_type: str, text: str) -> type:
    return _service_of(ros_type, _parts(ros_type, text, ("Request", "Response")))


def _service_of(ros_type: str, definitions: Mapping[str, Any]) -> type:
    """Returns a service class from the definitions of its request and its response."""
    kinds = {name: _message(f"{ros_type}_{name}", definition) for name, definition in definitions.items()}
    return type(ros_type.split("/")[2], (), {"ros_type": ros_type, **kinds})


def _action(ros_type: str, text: str) -> type:
    """Returns an action class. As on ROS 2, its attribute `Impl` has the services and topics that an action consists of."""
    parts = _parts(ros_type, text, ("Goal", "Result", "Feedback"))
    goal_id = "goal_id", (NAME, "unique_identifier_msgs/msg/UUID")
    stamp = "stamp", (NAME, "builtin_interfaces/msg/Time")
    goal, result, feedback = ((part.lower(), (NAME, f"{ros_type}_{part}")) for part in parts)
    status, accepted = ("status", (BASE, ("int8", 0))), ("accepted", (BASE, ("bool", 0)))
    kinds = {part: _message(f"{ros_type}_{part}", definition) for part, definition in parts.items()}
    _made.update({f"{ros_type}_{part}": kind for part, kind in kinds.items()})
    feedback_message: Definition = [], [goal_id, feedback]
    _made[f"{ros_type}_FeedbackMessage"] = _message(f"{ros_type}_FeedbackMessage", feedback_message)
    # Recordings need the types of topics.
    _types().register({f"{ros_type}_Feedback": parts["Feedback"], f"{ros_type}_FeedbackMessage": feedback_message})
    send_goal: dict[str, Definition] = {"Request": ([], [goal_id, goal]), "Response": ([], [accepted, stamp])}
    get_result: dict[str, Definition] = {"Request": ([], [goal_id]), "Response": ([], [status, result])}
    services = {
        "SendGoalService": _service_of(f"{ros_type}_SendGoal", send_goal),
        "GetResultService": _service_of(f"{ros_type}_GetResult", get_result),
        "CancelGoalService": _made["action_msgs/srv/CancelGoal"],
    }
    topics = {
        "FeedbackMessage": _made[f"{ros_type}_FeedbackMessage"],
        "GoalStatusMessage": message_class("action_msgs/msg/GoalStatusArray"),
    }
    return type(ros_type.split("/")[2], (), {"ros_type": ros_type, **kinds, "Impl": type("Impl", (), services | topics)})


def _parts(ros_type: str, text: str, names: Sequence[str]) -> dict[str, Any]:
    """Returns the parts of a definition, which lines of three hyphens separate, by name.

    Raises:
        ValueError: The number of parts is wrong, or a part is.
    """
    parts = [part.strip() for part in re.split(r"^---[ \t]*$", text, flags=re.MULTILINE)]
    if len(parts) != len(names):
        raise ValueError(f"{ros_type} must have lines '---' between {', '.join(names)}, got {len(parts)} parts")
    return {name: _parsed(f"{ros_type}_{name}", part) for name, part in zip(names, parts, strict=True)}


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
        made = message_class(content)
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
