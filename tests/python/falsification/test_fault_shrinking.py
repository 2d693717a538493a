"""fault_shrinking: texts of faults get shorter, weaker and simpler, and never longer or stronger."""

from __future__ import annotations

import pytest

from falsification.windy import controller, requirement, space
from mobile_robot_simulator.falsification import falsify
from mobile_robot_simulator.falsification.fault_shrinking import simpler_faults, simpler_numbers, smaller_faults
from mobile_robot_simulator.faults.reading import read_fault


def test_a_fault_gets_shorter_and_weaker():
    assert list(smaller_faults("Push(start=1.25, speed=0.3, direction=-1.5, end=3.25)")) == [
        "Push(start=1.25, speed=0.3, direction=-1.5, end=2.25)",
        "Push(start=1.25, speed=0.3, direction=-1.5, end=2.75)",
        "Push(start=1.25, speed=0.15, direction=-1.5, end=3.25)",
        "Push(start=1.25, speed=0.22, direction=-1.5, end=3.25)",
    ]
    assert list(smaller_faults("Slip(0.4)")) == ["Slip(0.2)", "Slip(0.3)"]
    assert next(smaller_faults("OdometryDrift((0.2, 0.0, 0.04, 0, 0, 0), seed=3)")) == (
        "OdometryDrift((0.1, 0.0, 0.02, 0.0, 0.0, 0.0), seed=3)"
    )
    assert list(smaller_faults("Drop('/scan', probability=0.5)")) == []


@pytest.mark.parametrize("text", ["Push(speed=0.3, start=2.0, end=7.7)", "OdometryDrift([0.3, 0, 0, 0, 0, 0], end=2.0)"])
def test_it_ends_with_a_short_and_weak_fault(text: str):
    seen = [text]
    while smaller := list(smaller_faults(seen[-1])):
        assert len(seen) < 30
        seen.append(smaller[0])
    last = read_fault(seen[-1])
    assert last.end - last.start == pytest.approx(0.1)
    assert 0.001 <= (last.speed if "Push" in text else last.alphas[0]) < 0.002


def test_simpler_numbers_never_make_a_fault_longer_or_stronger():
    for text in ("Push(start=1.26, speed=0.26, direction=1.571, end=3.777)", "Slip(0.26, start=1.26, end=3.777)"):
        before = read_fault(text)
        found = list(simpler_faults(text))
        assert found
        for simpler in found:
            if "end=0.0" in simpler:
                continue
            fault = read_fault(simpler)
            assert fault.end - fault.start <= before.end - before.start + 1e-9
            strength = "speed" if "Push" in text else "share"
            assert getattr(fault, strength) <= getattr(before, strength)
    assert "Push(start=0.0, speed=0.26, end=2.517)" in list(simpler_faults("Push(start=1.26, speed=0.26, end=3.777)"))
    assert list(simpler_faults("Slip(0.5, seed=17)")) == ["Slip(0.0, seed=17)", "Slip(0.5, seed=0)"]
    assert "BlockedSector(0.0, 0.2)" in list(simpler_faults("BlockedSector(-0.2, 0.2)"))
    assert list(simpler_numbers(1.234)) == [0.0, 1.0, 1.2, 1.23]


def test_a_drive_that_fails_because_of_a_push_is_shrunk_to_one_that_just_suffices():
    found = falsify(controller, space, requirement, 200, seed=1)
    (text,) = found.shrunk.world.faults
    push = read_fault(text)
    # The wall is 0.65 m away from the edge of the robot; with it, contact begins before the end of the push.
    assert type(push).__name__ == "Push" and 0.65 <= push.speed * (push.end - push.start) <= 1.0
    assert found.shrunk.world.obstacles == () and found.worst.world.things > 1
    assert falsify(controller, space, requirement, 200, seed=1).shrunk.world == found.shrunk.world
