"""random_stream: no two calls draw the same noise, and the results are those of seed and index written out."""

from __future__ import annotations

import copy
import pickle
import threading

import numpy as np
import pytest

import mobile_robot_simulator as mrs

SEED = 7
GRID = mrs.OccupancyGrid(np.pad(np.zeros((20, 30), np.int8), 1, constant_values=100), resolution=0.1)
LASER = mrs.LaserScanner(beam_count=31)
MODEL = mrs.BeamModel(sigma_hit=0.02, z_hit=0.8, z_short=0.1, z_max=0.05, z_rand=0.05)
POSES = GRID.draw_free_poses(12, radius=0.2, seed=SEED)


def test_calls_continue_one_another_and_equal_seed_and_index_written_out() -> None:
    whole = LASER.scan_batch(GRID, POSES, noise=MODEL, seed=SEED)
    stream = mrs.RandomStream(SEED)
    parts = [LASER.scan_batch(GRID, part, noise=MODEL, seed=stream) for part in (POSES[:5], POSES[5:5], POSES[5:])]
    assert np.concatenate(parts).tobytes() == whole.tobytes() and stream.next_index == 12
    again = LASER.scan_batch(GRID, POSES, noise=MODEL, seed=stream)
    assert again.tobytes() == LASER.scan_batch(GRID, POSES, noise=MODEL, seed=SEED, first_index=12).tobytes()


def test_two_calls_have_uncorrelated_noise() -> None:
    """At poses that differ by a micrometre, the errors of two calls with the same seed and index are the same."""
    stream, model = mrs.RandomStream(SEED), mrs.BeamModel(sigma_hit=0.02, z_hit=1.0, z_max=0.0)
    poses = np.repeat([[1.5, 1.0, 0.3]], 200, axis=0)
    shifted = poses + np.array([1e-6, 0.0, 0.0])
    errors = [
        (LASER.scan_batch(GRID, batch, noise=model, seed=seed) - LASER.scan_batch(GRID, batch)).ravel()
        for batch, seed in ((poses, SEED), (shifted, SEED), (poses, stream), (shifted, stream))
    ]
    assert np.corrcoef(errors[0], errors[1])[0, 1] > 0.999
    # 6200 pairs: the standard deviation of the correlation is 0.013.
    assert abs(np.corrcoef(errors[2], errors[3])[0, 1]) < 0.06


def test_steps_and_poses_take_a_stream_too() -> None:
    noise, step = mrs.MotionNoise(alpha1=0.1, alpha4=0.1), (mrs.Pose(), (1.0, 0.0, 0.5), 0.1)
    stream = mrs.RandomStream(SEED, next_index=3)
    assert noise.sample(*step, seed=stream) == noise.sample(*step, seed=SEED, index=3)
    assert noise.sample(*step, seed=stream) == noise.sample(*step, seed=SEED, index=4)
    drawn = GRID.draw_free_poses(4, radius=0.2, seed=stream)
    assert drawn.tobytes() == GRID.draw_free_poses(4, radius=0.2, seed=SEED, first_index=5).tobytes()
    pose = GRID.draw_free_pose(radius=0.2, seed=stream)
    assert tuple(pose) == tuple(GRID.draw_free_poses(1, radius=0.2, seed=SEED, first_index=9)[0])
    assert stream.next_index == 10 and stream.take(5) == 10 and stream.take(0) == 15


def test_without_noise_and_after_an_error_no_index_is_taken() -> None:
    stream = mrs.RandomStream(SEED)
    LASER.scan_batch(GRID, POSES, seed=stream)
    with pytest.raises(ValueError, match="out must have shape"):
        LASER.scan_batch(GRID, POSES, noise=MODEL, seed=stream, out=np.zeros((1, 31), np.float32))
    assert stream.next_index == 0


def test_noise_without_a_seed_is_refused_and_the_error_says_how_to_continue() -> None:
    with pytest.raises(ValueError, match="noise needs a seed: give seed=RandomStream"):
        LASER.scan_batch(GRID, POSES, noise=MODEL)
    with pytest.raises(
        ValueError, match="a seed needs an index: give index= the number of steps before, or seed=RandomStream"
    ):
        mrs.MotionNoise().sample(mrs.Pose(), (1.0, 0.0, 0.0), 0.1, seed=SEED)
    with pytest.raises(ValueError, match="first_index must not be given with a RandomStream"):
        LASER.scan_batch(GRID, POSES, noise=MODEL, seed=mrs.RandomStream(1), first_index=0)


def test_threads_take_different_indices() -> None:
    stream, taken = mrs.RandomStream(SEED), list[int]()
    threads = [threading.Thread(target=lambda: taken.extend(stream.take(3) for _ in range(2000))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(taken) == list(range(0, 24_000, 3)) and stream.next_index == 24_000


def test_a_copy_continues_from_the_same_index_by_itself() -> None:
    stream = mrs.RandomStream(SEED, next_index=4)
    copies = [copy.copy(stream), copy.deepcopy(stream), pickle.loads(pickle.dumps(stream))]
    stream.take(1)
    assert [(other.seed, other.next_index) for other in copies] == [(SEED, 4)] * 3
    assert repr(copies[0]) == "RandomStream(7, next_index=4)"


def test_invalid_streams_are_rejected() -> None:
    with pytest.raises(ValueError, match=r"seed must be in 0..2\*\*64 - 1, got -1"):
        mrs.RandomStream(-1)
    with pytest.raises(TypeError, match="next_index must be an integer, got float"):
        mrs.RandomStream(1, next_index=0.5)  # type: ignore[arg-type]
    last = mrs.RandomStream(1, next_index=2**64 - 2)
    with pytest.raises(ValueError, match="must have 5 indices left, got 1"):
        last.take(5)
    assert last.take(1) == 2**64 - 2
