"""tracking_pid (nobleo/tracking_pid), which was made for the original robot, passes its own test with ours."""

from __future__ import annotations

import re
from typing import Any

from workspace import client_environment, find_program


def test_the_rostest_of_tracking_pid_passes(world: Any) -> None:
    find_program("tracking_pid", "controller")
    test = world.run(
        "rostest", "--text", "tracking_pid", "test_tracking_pid.test", environment=client_environment(world.environment)
    )
    test.wait(120.0)
    # rostest ends with OK and returns 0 even if a test fails: only its summary tells.
    counts = {name: int(count) for name, count in re.findall(r"^ \* (TESTS|ERRORS|FAILURES): (\d+)", test.output, re.M)}
    print(f"tracking_pid: {counts}")
    assert counts.get("TESTS", 0) > 0
    assert (counts["ERRORS"], counts["FAILURES"]) == (0, 0)
