"""SteadyTime: a time that never decreases, whatever its clock does."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from mobile_robot_simulator.instant import Instant
from mobile_robot_simulator.nodes.steady_time import MAX_STEP_NS, SteadyTime

SECOND = 1_000_000_000


class Watch:
    """A clock that shows what it is set to."""

    def __init__(self, ns: int) -> None:
        self.ns = ns

    def now(self) -> Instant:
        return Instant(self.ns)


def test_no_time_passes_while_the_clock_jumps() -> None:
    watch = Watch(0)
    time, seen = SteadyTime(watch), list[int]()
    # The first message on /clock, a recording that starts again, and one more hour.
    for watch.ns in (1_700_000_000 * SECOND, 1_700_000_001 * SECOND, 5 * SECOND, 7 * SECOND, 7 * SECOND + MAX_STEP_NS):
        seen.append(time())
    assert seen == [0, SECOND, SECOND, 3 * SECOND, 3 * SECOND + MAX_STEP_NS]


@given(st.lists(st.integers(0, 2**62), min_size=1))
def test_it_never_decreases_and_passes_as_on_the_clock_otherwise(readings: list[int]) -> None:
    watch = Watch(readings[0])
    time, expected = SteadyTime(watch), readings[0]
    for before, after in pairwise(readings):
        watch.ns = after
        expected += after - before if 0 <= after - before <= MAX_STEP_NS else 0
        assert time() == expected
