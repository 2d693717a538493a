"""yaml_documents: what yaml-cpp takes is parsed, scalars have the types of ROS 2, and errors give the line."""

from __future__ import annotations

import math
from typing import Any

import pytest

from mobile_robot_simulator.yaml_documents import MappingNode, entries_of, invalid, parse, text_of, value_of


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1", 1),
        ("-7", -7),
        ("0x10", 16),
        ("010", 8),
        ("1.5", 1.5),
        ("1e7", 1e7),
        (".5", 0.5),
        (".inf", math.inf),
        ("-.inf", -math.inf),
        ("yes", True),
        ("off", False),
        ("True", True),
        ("~", None),
        ("", None),
        ("'1'", "1"),
        ("1_000", "1_000"),
        ("2024-01-01", "2024-01-01"),
        ("12:30", "12:30"),
        ("[1, two, [3.0]]", [1, "two", [3.0]]),
        ("{a: 1, b: {c: no}}", {"a": 1, "b": {"c": False}}),
    ],
)
def test_values_have_the_types_of_ros_2(text: str, expected: Any) -> None:
    found = value_of(parse(text))
    assert found == expected and type(found) is type(expected)


def test_keys_are_unique_words() -> None:
    root = parse("a: 1\nb: 2\na: 3\n")
    assert isinstance(root, MappingNode)
    with pytest.raises(ValueError, match="file: line 3: 'a' must be given once, got it in line 1 too"):
        entries_of(root, "file")
    root = parse("[1, 2]: 3")
    assert isinstance(root, MappingNode)
    with pytest.raises(ValueError, match="a key must be a single word, got '"):
        entries_of(root)


def test_only_maps_have_second_documents_and_aliases() -> None:
    assert value_of(parse("a: &x [1]\nb: *x\n---\nother", as_nav2=True)) == {"a": [1], "b": [1]}
    with pytest.raises(ValueError, match="must contain one YAML document, got more"):
        parse("a: 1\n---\nb: 2")
    with pytest.raises(ValueError, match="aliases are not supported"):
        parse("a: &x [1]\nb: *x")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1", "not valid YAML: line 1"),
        ("a: 1\nb: c: d", "not valid YAML: line 2, column 5"),
        ('"\\UFFFFFFFF"', "not valid YAML: line 1"),
        ("[" * 1000, "inside at most 50 others"),
    ],
)
def test_errors_give_the_line(text: str, message: str) -> None:
    with pytest.raises(ValueError) as caught:
        parse(text, "file")
    assert str(caught.value).startswith("file: not valid YAML") and message in str(caught.value)


def test_a_message_shows_the_text_of_the_file_and_its_line() -> None:
    root = parse("a: 1\nb: [1,\n  2]\n")
    assert isinstance(root, MappingNode)
    node = entries_of(root)["b"]
    assert text_of(node) == "'[1, 2]'"
    assert str(invalid("b", node, "a number")) == "b must be a number, got '[1, 2]' in line 2"
