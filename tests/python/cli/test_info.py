"""The command info."""


def test_info_describes_a_map(command, room):
    words = command("info", room).stdout
    assert "120 x 80" in words and "0.05 m" in words and "6 m x 4 m" in words
