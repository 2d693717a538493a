"""Kept: the user's objects that are saved and restored with a simulation."""

from __future__ import annotations

import mobile_robot_simulator as mrs
from mobile_robot_simulator import faults
from mobile_robot_simulator.simulation.kept import Kept
from simulations import small_room


def test_kept_objects_are_saved_and_others_are_not():
    class Counter:
        def __init__(self) -> None:
            self.counts = [0]

    sim = small_room()
    counter, other = sim.keep(Counter()), Counter()
    sim.subscribe("/scan", mrs.messages.LaserScan, lambda scan: counter.counts.append(1))
    sim.subscribe("/scan", mrs.messages.LaserScan, lambda scan: other.counts.append(1))
    state = sim.save()
    sim.run_for(1.0)
    assert len(counter.counts) == len(other.counts) == 11
    sim.restore(state)
    assert counter.counts == [0] and len(other.counts) == 11


def test_kept_objects_refer_to_the_same_simulation_after_a_restore():
    sim = small_room()
    box = sim.add_obstacle(mrs.Shape.disc(0.2), (3.0, 3.0, 0.0))
    drop = sim.add_fault(faults.Drop("/odom", probability=0.5))

    class Probe:
        def __init__(self) -> None:
            self.parts = [sim, sim.robot, sim.laser, sim.map_server, sim.truth, sim.named(None), box, drop]
            self.act, self.count = self.look, 0

        def look(self) -> None:
            self.count += 1

    probe = sim.keep(Probe())
    parts = list(probe.parts)
    probe.act()
    state = sim.save()
    probe.act()
    for _ in range(2):
        sim.restore(state)
        assert all(now is before for now, before in zip(probe.parts, parts, strict=True))
        probe.act()
        assert probe.count == 2


class Copied:
    """An object that is saved by deep copies of its attributes. One of them is the object itself."""

    def __init__(self) -> None:
        self.itself, self.numbers = self, [1]


class Savable:
    """An object that saves and restores itself."""

    def __init__(self) -> None:
        self.saved, self.scratch = [1], [1]

    def save(self) -> object:
        return list(self.saved)

    def restore(self, state: object) -> None:
        self.saved = list(state)


def test_an_object_is_saved_by_its_own_methods_or_by_copies_of_its_attributes():
    kept, copied, savable = Kept(), Copied(), Savable()
    kept.add(copied)
    kept.add(savable)
    state = kept.save()
    for _ in range(2):
        copied.numbers.append(2)
        savable.saved.append(2)
        savable.scratch.append(2)
        kept.restore(state)
        assert copied.numbers == [1] and copied.itself is copied and savable.saved == [1]
    assert savable.scratch == [1, 2, 2]


def test_objects_added_later_are_no_longer_kept():
    kept, copied = Kept(), Copied()
    state = kept.save()
    kept.add(copied)
    kept.restore(state)
    assert kept.save() == ()


def test_a_kept_object_may_hold_any_value_of_the_core():
    class Bumper:
        def __init__(self) -> None:
            self.contact = mrs.Contact(point=(1.0, 2.0), normal=(0.0, 1.0), fraction=0.5)

    sim = small_room()
    bumper = sim.keep(Bumper())
    first, state = bumper.contact, sim.save()
    bumper.contact = mrs.Contact(point=(3.0, 2.0), normal=(1.0, 0.0), fraction=0.25)
    sim.restore(state)
    assert bumper.contact == first
