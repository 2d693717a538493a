"""Help pages of the commands."""

import pytest

pytestmark = pytest.mark.slow


def test_a_flag_shows_no_type_of_a_value(command):
    for arguments in ((), ("run",), ("scan",)):
        text = command(*arguments, "--help").stdout
        assert "--help" in text and "bool" not in text.lower()
    assert "<float>" in command("run", "--help").stdout
