"""The command info."""

import json


def test_info_describes_a_map(command, room):
    words = command("info", room).stdout
    assert "120 x 80" in words and "0.05 m" in words and "6 m x 4 m" in words


def test_info_as_json(command, room):
    properties = json.loads(command("info", room, "--json").stdout)
    sides = {"width": 120, "height": 80, "resolution": 0.05, "origin": [0.0, 0.0, 0.0]}
    assert properties == {**sides, "occupied": 2 * 120 + 2 * 78, "free": 118 * 78, "unknown": 0}
