"""Drivers, on the bus."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.cli.drivers import Commander, Script, Wander

SEED = 4


def open_floor() -> mrs.OccupancyGrid:
    return mrs.OccupancyGrid(np.zeros((200, 200), np.int8), resolution=0.1)


def commands_of(script: Script, duration: float) -> list[tuple[float, float]]:
    simulation = mrs.Simulation(open_floor())
    sent: list[tuple[float, float]] = []
    simulation.subscribe("/cmd_vel", mrs.messages.Twist, lambda twist: sent.append((simulation.time, twist.linear.x)))
    node = simulation.create_node("driver")
    script.start(node, Commander(node, "/cmd_vel", stamped=False))
    simulation.run_for(duration)
    return sent


def test_a_script_sends_each_command_at_its_time_and_repeats_it():
    sent = commands_of(Script(((0.0, 0.5, 0.0, 0.0), (0.25, 1.0, 0.0, 0.0))), 0.45)
    assert sent == [(0.0, 0.5), (0.1, 0.5), (0.2, 0.5), (0.25, 1.0), (0.3, 1.0), (0.4, 1.0)]


def test_a_script_holds_a_command_past_the_velocity_timeout():
    simulation = mrs.Simulation(open_floor(), start=(5.0, 5.0, 0.0))
    node = simulation.create_node("driver")
    script = Script(((0.0, 1.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0)))
    script.start(node, Commander(node, "/cmd_vel", stamped=False))
    simulation.run_for(4.0)
    assert tuple(simulation.pose) == pytest.approx((7.0, 5.0, 0.0), abs=1e-12)


def test_stamped_commands_carry_the_time():
    simulation = mrs.Simulation(open_floor(), parameters={"cmd_vel_stamped": True})
    node = simulation.create_node("driver")
    simulation.run_for(1.5)
    Commander(node, "/cmd_vel", stamped=True).command(0.1, 0.2, 0.3)
    message = simulation.latest("/cmd_vel")
    assert message.header.stamp == mrs.messages.Time(1, 500_000_000)
    assert (message.twist.linear.x, message.twist.linear.y, message.twist.angular.z) == (0.1, 0.2, 0.3)


def test_a_script_is_read_from_csv(tmp_path):
    file = tmp_path / "commands.csv"
    file.write_text("time,vx,vy,wz\n0,0.5,0,0\n\n1.5,0,0,-1e-1\n")
    assert Script.read(file).rows == ((0.0, 0.5, 0.0, 0.0), (1.5, 0.0, 0.0, -0.1))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "first line must be time,vx,vy,wz, got ''"),
        ("0,1,0,0\n", "first line must be time,vx,vy,wz, got '0,1,0,0'"),
        ("time,vx,vy,wz\n", "at least one command"),
        ("time,vx,vy,wz\n0,1,0\n", "line 2: must be four numbers, got '0,1,0'"),
        ("time,vx,vy,wz\n0,1,0,fast\n", "line 2: must be four numbers, got '0,1,0,fast'"),
        ("time,vx,vy,wz\n0,nan,0,0\n", "line 2: must be finite"),
        ("time,vx,vy,wz\n-1,0,0,0\n", "line 2: times must be at least 0 and increase, got -1.0"),
        ("time,vx,vy,wz\n1,0,0,0\n1,0,0,0\n", "line 3: times must be at least 0 and increase, got 1.0"),
    ],
)
def test_a_bad_script_is_refused_by_its_line(tmp_path, text, message):
    file = tmp_path / "commands.csv"
    file.write_text(text)
    with pytest.raises(ValueError, match=message) as error:
        Script.read(file)
    assert str(file) in str(error.value)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("beams", [3, 90, 541])
def test_wander_keeps_clear_of_walls(seed, beams):
    cells = np.zeros((160, 240), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[60:64, :150] = cells[100:104, 90:] = cells[20:30, 100:110] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.05)
    # With three beams, straight ahead and to the sides, only a slow robot in the open sees enough.
    driver, seconds = Wander(speed=0.5), 120.0 if beams > 3 else 1.0
    simulation = mrs.Simulation(
        grid, parameters={"laser_beam_count": beams}, seed=seed, start=grid.draw_free_pose(radius=0.6, seed=seed)
    )
    touched = []
    simulation.subscribe(
        "/odom", mrs.messages.Odometry, lambda _: touched.append(not grid.is_free_disc(*tuple(simulation.pose)[:2], 0.2))
    )
    node = simulation.create_node("driver")
    driver.start(node, Commander(node, "/cmd_vel", stamped=False), "/scan", seed)
    simulation.run_for(seconds)
    assert not any(touched)
    assert simulation.robot.distance > 0.1 * seconds


def test_wander_goes_the_same_way_twice():
    grid = mrs.floor_plan("office", seed=1)
    ends = []
    for _ in range(2):
        simulation = mrs.Simulation(grid, seed=SEED, start=grid.draw_free_pose(radius=0.5, seed=SEED))
        node = simulation.create_node("driver")
        Wander().start(node, Commander(node, "/cmd_vel", stamped=False), "/scan", SEED)
        simulation.run_for(30.0)
        ends.append(tuple(simulation.pose))
    assert ends[0] == ends[1]
