"""Global localization by a particle filter (Monte Carlo localization), in NumPy on top of two calls of the simulator.

A robot wanders through a map with drifting odometry and a noisy scanner. The filter knows the map, the odometry and the
scans, and at first nothing of the pose. It prints how far its estimate is from the true pose, and draws both paths.

    python particle_filter.py [MAP.yaml] [--model {beams,field}] [--seed SEED] [--out PICTURE.png]
"""

import argparse

import numpy as np

import mobile_robot_simulator as mrs
from mobile_robot_simulator.messages import Twist, Vector3

FIRST_PARTICLES, PARTICLES = 30_000, 3_000
NOISE = mrs.BeamModel(sigma_hit=0.1, lambda_short=1.0, z_hit=0.85, z_short=0.05, z_max=0.05, z_rand=0.05)
MODELS = {"beams": NOISE, "field": mrs.LikelihoodField(sigma_hit=0.1, z_hit=0.9, z_rand=0.1, max_distance=1.0)}
DRIFT = [0.01, 0.001, 0.005, 0.01, 0.0, 0.0]  # odometry_alphas of the robot


def wander(sim):
    """Drives on, and turns left until there is room ahead."""
    scan = sim.latest("/scan")
    # Not the minimum, because one reading in ten is false.
    ahead = np.quantile(np.nan_to_num(scan.ranges[200:341], posinf=scan.range_max, neginf=0.0), 0.2)
    turn = 0.8 if ahead < 0.9 else 0.3 * float(np.sin(0.2 * sim.time))
    sim.publish("/cmd_vel", Twist(linear=Vector3(x=0.6 * float(np.clip(ahead - 0.5, 0.0, 1.0))), angular=Vector3(z=turn)))


def resampled(particles, log_weights, count, rng):
    """Draws particles by their weights, with one random number for all (low-variance sampling)."""
    weights = np.exp(log_weights - log_weights.max())
    places = (rng.random() + np.arange(count)) / count * weights.sum()
    return particles[np.searchsorted(weights.cumsum(), places).clip(max=len(particles) - 1)]


def moved(particles, before, after, rng):
    """Moves particles as the odometry did, each with an error of its own in speed and turn."""
    x, y, turn = before.twist_to(after, 1.0)
    spread = (0.2 * np.hypot(x, y) + 0.01, 0.01, 0.2 * abs(turn) + 0.1 * np.hypot(x, y) + 0.01)
    return mrs.integrate_twist(particles, rng.normal((x, y, turn), spread, particles.shape), 1.0)


def main():
    """Drives the robot for a minute, and follows it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", nargs="?")
    parser.add_argument("--model", choices=MODELS, default="beams", help="how scans are scored")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", default="localization.png")
    arguments = parser.parse_args()
    grid = mrs.load_map(arguments.map) if arguments.map else mrs.floor_plan("office", seed=1, size=(30.0, 20.0))
    rng, stream = np.random.default_rng(arguments.seed), mrs.RandomStream(arguments.seed)
    start = grid.draw_free_pose(radius=0.8, seed=arguments.seed)
    noise = {name: getattr(NOISE, name) for name in ("sigma_hit", "lambda_short", "z_hit", "z_short", "z_max", "z_rand")}
    robot = {"odometry_alphas": DRIFT, "robot_radius": 0.25, "contact": "slide"}
    sim = mrs.Simulation(grid, seed=arguments.seed, start=start, parameters={**noise, **robot})

    particles = grid.draw_free_poses(FIRST_PARTICLES, radius=0.25, seed=stream)
    odometry, rows = mrs.Pose(), []
    sim.run_for(0.1)
    for step in range(120):
        for _ in range(5):
            wander(sim)
            sim.run_for(0.1)
        before, odometry = odometry, sim.latest("/odom").pose.pose.to_planar()
        # A few new particles, in case that the right ones were lost.
        particles[::50] = grid.draw_free_poses(len(particles[::50]), radius=0.25, seed=stream)
        particles = moved(particles, before, odometry, rng)
        scan, model = sim.latest("/scan").ranges, MODELS[arguments.model]
        scores = sim.laser.scanner.log_likelihood(grid, particles, scan, noise=model, beams=9, temper=0.2)
        particles = resampled(particles, scores, FIRST_PARTICLES if step < 10 else PARTICLES, rng)
        yaw = np.angle(np.exp(1j * particles[:, 2]).mean())
        rows.append((sim.time, *sim.truth.pose, *particles[:, :2].mean(axis=0), yaw, particles[:, :2].std(axis=0).max()))

    time, x, y, truth_yaw, found_x, found_y, found_yaw, spread = np.array(rows).T
    error = np.hypot(found_x - x, found_y - y)
    turned = np.degrees(np.abs(np.angle(np.exp(1j * (found_yaw - truth_yaw)))))
    print("time [s]  error [m]  error [deg]  spread [m]")
    for row in range(9, len(rows), 10):
        print(f"{time[row]:8.1f}  {error[row]:9.3f}  {turned[row]:11.2f}  {spread[row]:10.3f}")

    axes = grid.plot()
    axes.plot(x, y, "b-", found_x, found_y, "r.", markersize=3)
    axes.legend(["true path", "estimates"], loc="upper left")
    axes.figure.savefig(arguments.out, bbox_inches="tight")


if __name__ == "__main__":
    main()
