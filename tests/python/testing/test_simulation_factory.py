"""SimulationFactory: settings for missing arguments, and what is saved when. The rest is tested with the plugin."""

from __future__ import annotations

import pytest

from mobile_robot_simulator.testing.simulation_factory import SimulationFactory
from simulations import drive, hall


def test_settings_replace_missing_arguments(tmp_path):
    factory = SimulationFactory({"seed": 3, "map": "maze", "size": (9.0, 9.0)}, "never", tmp_path)
    sim = factory()
    assert sim.laser.parameters.seed == 3 and sim.grid.shape == (180, 180)
    assert tuple(factory(hall(6.0), start=(1, 1, 0), seed=4).pose) == (1.0, 1.0, 0.0)
    assert factory.own_seeds == [4]


def test_a_marked_start_takes_precedence_over_marked_robots(tmp_path):
    factory = SimulationFactory({"seed": 3, "start": (1, 1, 0), "robots": ["one"]}, "never", tmp_path)
    assert list(factory(hall(6.0)).robots) == [""]


@pytest.mark.slow
@pytest.mark.parametrize(("record", "count"), [("never", 0), ("on-failure", 2), ("always", 2)])
def test_recordings_and_pictures_are_saved_when_asked(tmp_path, record, count):
    pytest.importorskip("rosbags")
    pytest.importorskip("matplotlib")
    factory = SimulationFactory({"seed": 0}, record, tmp_path)
    for _ in range(2):
        sim = factory(hall(6.0), start=(1, 1, 0))
        drive(sim)
        sim.run_for(0.5)
    lines = factory.save()
    assert [line.partition(":")[0] for line in lines] == ["recording", "picture"] * count
    factory.close()
    for name in ("recording.mcap", "drive.png"):
        assert len(list(tmp_path.glob(f"**/{name}"))) == count
    with pytest.raises(RuntimeError, match="the simulation is closed"):
        sim.run_for(1.0)
