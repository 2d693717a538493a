"""beam_model: readings follow the model of Probabilistic Robotics, table 6.1, with each part normalised."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import mobile_robot_simulator as mrs
import reference

SAMPLES_SEED = 1_234
READINGS = 200_000

WEIGHTS = ("z_hit", "z_short", "z_max", "z_rand")
BY_RANGE_NAMES = ("range_offset", "range_sigma_base", "range_sigma_per_metre", "range_step", "range_step_share")
NAMES = ("sigma_hit", "lambda_short", *WEIGHTS, *BY_RANGE_NAMES)

FALSE_ALARM = 1e-9
"""Probability that a correct model fails one call of `assert_fits`."""


def model(**weights: float) -> mrs.BeamModel:
    """A model that has only the given weights; all others are 0."""
    return mrs.BeamModel(**{"z_hit": 0.0, "z_max": 0.0, **weights})


def options_of(noise: mrs.BeamModel) -> dict[str, float]:
    """The arguments of a model."""
    return {name: getattr(noise, name) for name in NAMES}


def readings(
    noise: mrs.BeamModel, true_range: float | None, max_range: float, count: int = READINGS, seed: int = SAMPLES_SEED
) -> NDArray[np.float64]:
    """Readings of one beam. It hits a wall at `true_range`, or nothing if that is None."""
    cells = np.zeros((1, 2), np.int8)
    cells[0, 1] = 0 if true_range is None else 100
    # The wall starts at x = 1 m; the beam starts `true_range` before it.
    grid = mrs.OccupancyGrid(cells, resolution=1.0)
    laser = mrs.LaserScanner(fov=1.0, beam_count=1, max_range=max_range, min_range=0.0)
    poses = np.tile([1.0 - (true_range or 0.0), 0.5, 0.0], (count, 1))
    exact = laser.scan(grid, tuple(poses[0].tolist()))[0]
    assert exact == np.float32(max_range if true_range is None else true_range)
    return laser.scan_batch(grid, poses, noise=noise, seed=seed)[:, 0].astype(np.float64)


def assert_fits(found: NDArray[np.float64], noise: mrs.BeamModel, true_range: float | None, max_range: float) -> None:
    """Asserts that readings fit the model: Kolmogorov-Smirnov test below max_range, and share of readings at max_range."""
    count = len(found)
    assert found.min() >= 0.0
    assert found.max() <= np.float32(max_range)
    below = np.sort(found[found < np.float32(max_range)])

    def cdf(z: NDArray[np.float64]) -> NDArray[np.float64]:
        hits = true_range is not None
        return reference.reading_cdf(z, noise, true_range if hits else max_range, max_range, hits=hits)

    expected = cdf(below)
    # The empirical distribution just above and just below each reading. Equal float32 readings form one step.
    above, under = np.searchsorted(below, below, "right") / count, np.searchsorted(below, below, "left") / count
    # The model itself may have a step at 0.
    distance = max(np.max(above - expected, initial=0.0), np.max((expected - under)[below > 0.0], initial=0.0))
    # Massart's inequality: P(distance > d) <= 2 exp(-2 count d²). The 1e-4 allows for rounding to float32.
    critical = math.sqrt(-math.log(FALSE_ALARM / 2.0) / (2.0 * count)) + 1e-4
    assert distance < critical, f"{distance} of {critical}"
    atom = 1.0 - float(cdf(np.array([max_range]))[0])
    assert abs((found == np.float32(max_range)).mean() - atom) < critical


CASES = [
    # (true range, max range, sigma, lambda)
    (5.0, 30.0, 0.2, 0.5),
    (5.0, 30.0, 0.005, 2.0),
    (0.5, 30.0, 1.0, 3.0),
    (29.9, 30.0, 0.5, 0.1),
    (2.0, 3.0, 3.0, 1.0),
    (2.0, 3.0, 3.1, 1e-6),
    (1.0, 3.0, 50.0, 100.0),
    (2.9, 3.0, 1e6, 1e-12),
    (1e-3, 1.0, 0.1, 10.0),
    (700.0, 1000.0, 40.0, 0.01),
]
PARTS = {
    "hit": {"z_hit": 1.0},
    "short": {"z_short": 1.0},
    "max": {"z_max": 1.0},
    "rand": {"z_rand": 1.0},
    "all": {"z_hit": 0.4, "z_short": 0.3, "z_max": 0.1, "z_rand": 0.2},
    "no max": {"z_hit": 5.0, "z_short": 1.0, "z_rand": 2.0},
}


@pytest.mark.slow
@pytest.mark.parametrize("weights", PARTS.values(), ids=PARTS)
@pytest.mark.parametrize(("true_range", "max_range", "sigma", "rate"), CASES)
def test_readings_fit_the_model(
    true_range: float, max_range: float, sigma: float, rate: float, weights: dict[str, float]
) -> None:
    noise = model(sigma_hit=sigma, lambda_short=rate, **weights)
    assert_fits(readings(noise, true_range, max_range, 100_000), noise, true_range, max_range)


@pytest.mark.slow
@pytest.mark.parametrize("weights", PARTS.values(), ids=PARTS)
def test_readings_of_beams_that_hit_nothing_fit_the_model(weights: dict[str, float]) -> None:
    noise = model(sigma_hit=0.5, lambda_short=0.1, **weights)
    assert_fits(readings(noise, None, 30.0, 400_000), noise, None, 30.0)


@pytest.mark.slow
@pytest.mark.parametrize("weights", PARTS.values(), ids=PARTS)
def test_readings_of_a_true_range_of_zero_fit_the_model(weights: dict[str, float]) -> None:
    noise = model(sigma_hit=0.3, lambda_short=2.0, **weights)
    found = readings(noise, 0.0, 30.0, 400_000)
    assert abs((found == 0.0).mean() - noise.z_short) < 0.02
    assert_fits(found, noise, 0.0, 30.0)


BY_RANGE = {"range_offset": 0.15, "range_sigma_base": 0.02, "range_sigma_per_metre": 0.04}


@pytest.mark.parametrize("true_range", [0.02, 1.0, 5.0, 29.8])
def test_readings_by_range_fit_the_model(true_range: float) -> None:
    noise = model(sigma_hit=0.1, lambda_short=0.5, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1, **BY_RANGE)
    found = readings(noise, true_range, 30.0)
    assert_fits(found, noise, true_range, 30.0)
    for change in ({"range_offset": 0.1}, {"range_sigma_per_metre": 0.06}):
        if true_range > 1.0:
            with pytest.raises(AssertionError):
                assert_fits(found, mrs.BeamModel(**{**options_of(noise), **change}), true_range, 30.0)


def test_steps_have_the_resolution_of_a_data_sheet() -> None:
    """Readings of a beam that meets a wall at all distances: 1 % of the distance at most, and multiples of the step."""
    noise = model(z_rand=1.0, range_step=0.001, range_step_share=0.01)
    found = np.unique(readings(noise, 5.0, 30.0))
    steps = np.diff(found)
    # Nearer than 2 m, some multiples were not drawn.
    far = found[:-1] > 2.0
    assert (steps[far] <= 0.0101 * found[:-1][far]).all() and (steps[far] >= 0.0049 * found[:-1][far]).all()
    assert np.abs(found / 0.001 - np.rint(found / 0.001)).max() < 2e-3
    powers = np.log2(steps[far] / 0.001)
    assert np.abs(powers - np.rint(powers)).max() < 0.01
    assert found.max() < 30.0


def test_what_is_off_leaves_the_bytes_as_they_are() -> None:
    plain = mrs.BeamModel(sigma_hit=0.05, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1)
    same = mrs.BeamModel(**{**options_of(plain), "range_sigma_base": 0.05})
    assert np.array_equal(readings(plain, 5.0, 30.0), readings(same, 5.0, 30.0))
    # The same path as for numbers that count, with numbers that do not.
    tiny = mrs.BeamModel(**{**options_of(plain), "range_sigma_per_metre": 1e-300})
    assert np.array_equal(readings(plain, 5.0, 30.0), readings(tiny, 5.0, 30.0))


def test_sigma_by_incidence_counts_the_offset() -> None:
    noise = model(sigma_hit=0.05, z_hit=1.0, range_offset=0.4)
    found = readings(noise, 5.0, 30.0, 20_000).astype(np.float32)
    sigmas = noise.sigma_by_incidence(np.float32(5.0), found, np.float32(0.1), max_range=30.0)
    assert sigmas[0] == pytest.approx(0.05, rel=0.03)


def test_the_fit_test_rejects_wrong_parameters() -> None:
    right = model(sigma_hit=0.2, lambda_short=0.5, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1)
    found = readings(right, 5.0, 30.0)
    assert_fits(found, right, 5.0, 30.0)
    for change in ({"sigma_hit": 0.22}, {"lambda_short": 0.8}, {"z_short": 0.13}, {"z_max": 0.12}, {"z_rand": 0.12}):
        options = options_of(right)
        with pytest.raises(AssertionError):
            assert_fits(found, mrs.BeamModel(**{**options, **change}), 5.0, 30.0)


@pytest.mark.slow
def test_means_equal_the_computed_values() -> None:
    """E[z] = 8.155287 and E[short] = 1.552873. The tolerance is 6.2 standard errors of the mean."""
    noise = model(sigma_hit=0.2, lambda_short=0.5, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1)
    found = readings(noise, 5.0, 30.0, 1_000_000)
    assert abs(found.mean() - 8.155287) < 6.2 * found.std() / math.sqrt(len(found))
    short = readings(model(lambda_short=0.5, z_short=1.0), 5.0, 30.0, 1_000_000)
    assert abs(short.mean() - 1.552873) < 6.2 * short.std() / math.sqrt(len(short))
    assert short.max() <= 5.0


@pytest.mark.slow
def test_hits_have_the_tails_of_a_normal() -> None:
    deviations = (readings(model(sigma_hit=0.01, z_hit=1.0), 5.0, 30.0, 1_000_000) - 5.0) / 0.01
    for bound in (1.0, 2.0, 3.0, 3.66, 4.0, 4.5):
        for tail in (deviations > bound, deviations < -bound):
            expected = 1e6 * 0.5 * math.erfc(bound / math.sqrt(2.0))
            assert abs(tail.sum() - expected) < 7.0 * math.sqrt(expected) + 3.0
    for power, moment in ((1, 0.0), (2, 1.0), (3, 0.0), (4, 3.0), (6, 15.0)):
        values = deviations**power
        assert abs(values.mean() - moment) < 7.0 * values.std() / 1000.0


def test_readings_of_neighbouring_beams_and_scans_are_independent() -> None:
    room = np.full((1, 1), 0, np.int8)
    laser = mrs.LaserScanner(beam_count=400, max_range=10.0)
    found = laser.scan_batch(
        mrs.OccupancyGrid(room, resolution=1.0), np.zeros((400, 3)), noise=model(z_rand=1.0), seed=SAMPLES_SEED
    ).astype(float)
    uniform = found / 10.0 - 0.5
    for one, other in (
        (uniform[:, 1:], uniform[:, :-1]),
        (uniform[1:], uniform[:-1]),
        (uniform[1:, 1:], uniform[:-1, :-1]),
        (uniform, uniform.T),
    ):
        products = one * other
        assert abs(products.mean()) < 7.0 * products.std() / math.sqrt(products.size / 2)


def test_a_part_with_weight_zero_never_occurs() -> None:
    assert (readings(model(z_hit=1.0), None, 30.0) == 30.0).all()
    assert (readings(model(z_hit=1.0), 5.0, 30.0) < 30.0).all()
    assert (readings(model(z_short=0.3, z_hit=0.3), 5.0, 30.0) < 30.0).all()
    assert (readings(model(z_max=1.0), 5.0, 30.0) == 30.0).all()


# --- Likelihood ---


def likelihood(noise: mrs.BeamModel, z: NDArray[np.float64], true_range: float, max_range: float) -> NDArray[np.float64]:
    z32 = np.asarray(z, np.float32)
    return noise.likelihood(z32, np.full_like(z32, true_range), max_range)


@pytest.mark.parametrize("weights", PARTS.values(), ids=PARTS)
@pytest.mark.parametrize(("true_range", "max_range", "sigma", "rate"), [case for case in CASES if case[2] > 0.01])
def test_the_likelihood_is_the_density(
    true_range: float, max_range: float, sigma: float, rate: float, weights: dict[str, float]
) -> None:
    """The integral of the density is the distribution function. Together with the mass at max_range it is 1."""
    noise = model(sigma_hit=sigma, lambda_short=rate, **weights)
    true_range = float(np.float32(true_range))
    # The density jumps at the true range, so each side is integrated separately.
    total = 0.0
    for low, high in ((0.0, true_range), (true_range, max_range)):
        nodes = np.linspace(low, high, 20_001)
        middles = 0.5 * (nodes[1:] + nodes[:-1])
        density = likelihood(noise, middles, true_range, max_range)
        total += float(np.sum(density) * (nodes[1] - nodes[0]))
        assert total == pytest.approx(
            float(reference.reading_cdf(np.array([min(high, max_range)]), noise, true_range, max_range, hits=True)[0]),
            abs=2e-3,
        )
    atom = float(likelihood(noise, np.array([max_range]), true_range, max_range)[0])
    assert atom == noise.z_max
    assert total + atom == pytest.approx(1.0, abs=2e-3)


def test_the_likelihood_of_a_beam_that_hits_nothing() -> None:
    noise = model(lambda_short=0.5, z_hit=0.5, z_short=0.2, z_max=0.1, z_rand=0.2)
    found = likelihood(noise, np.array([30.0, 1.0, 31.0, -0.5]), 30.0, 30.0)
    short = 0.5 * math.exp(-0.5) / -math.expm1(-15.0)
    assert found == pytest.approx([0.6, 0.2 * short + 0.2 / 30.0, 0.6, 0.0])


@pytest.mark.parametrize("reading", [-1e-3, -math.inf])
def test_readings_below_0_have_no_likelihood(reading: float) -> None:
    assert likelihood(mrs.BeamModel(z_rand=0.1), np.array([reading]), 5.0, 30.0).tolist() == [0.0]


def test_marked_readings_have_the_probability_of_what_they_mark() -> None:
    noise = model(lambda_short=0.5, z_hit=0.5, z_short=0.2, z_max=0.1, z_rand=0.2)
    marked = np.array([math.inf, 30.001, 30.0, -math.inf, 0.05, math.nan], np.float32)
    found = noise.likelihood(marked, np.full_like(marked, 5.0), 30.0, min_range=0.1)
    below = 0.2 * math.expm1(-0.05) / math.expm1(-2.5) + 0.2 * 0.1 / 30.0
    assert found == pytest.approx([0.1, 0.1, 0.1, below, below, 1.0], rel=1e-6)
    at_zero = noise.likelihood(np.zeros(1, np.float32), np.zeros(1, np.float32), 30.0)
    assert at_zero.tolist() == [0.2]


def test_a_scan_as_in_a_message_can_be_scored() -> None:
    """One missing return used to make the likelihood of a whole scan 0."""
    grid = mrs.floor_plan("office", seed=1)
    poses = grid.draw_free_poses(50, radius=0.2, seed=1)
    laser = mrs.LaserScanner(max_range=6.0, min_range=0.6)
    noise = model(sigma_hit=0.05, lambda_short=1.0, z_hit=0.7, z_short=0.1, z_max=0.1, z_rand=0.1)
    readings = laser.mark_invalid(laser.scan_batch(grid, poses, noise=noise, seed=1))
    assert np.isposinf(readings).any() and np.isneginf(readings).any()
    true = laser.scan_batch(grid, poses)
    right = np.log(noise.likelihood(readings, true, 6.0, min_range=0.6)).sum(axis=1)
    wrong = np.log(noise.likelihood(readings, np.roll(true, 1, axis=0), 6.0, min_range=0.6)).sum(axis=1)
    assert np.isfinite(right).all() and (right > wrong).all()


def test_readings_and_true_ranges_are_broadcast() -> None:
    model, readings, ranges = mrs.BeamModel(), np.linspace(0, 9, 5, dtype=np.float32), np.float32([[3.0], [4.0], [10.0]])
    found = model.likelihood(readings, ranges, 10.0)
    assert found.shape == (3, 5)
    for row, true_range in zip(found, ranges[:, 0], strict=True):
        assert row.tolist() == model.likelihood(readings, np.full(5, true_range), 10.0).tolist()
    assert model.likelihood(readings, np.float32(3.0), 10.0).tolist() == found[0].tolist()
    assert model.likelihood(np.float32(3.0), np.float32(3.0), 10.0).shape == ()


def test_likelihoods_have_the_shape_of_the_readings() -> None:
    z = np.linspace(0.0, 30.0, 24, dtype=np.float32).reshape(4, 6)
    noise = mrs.BeamModel(z_rand=0.1)
    found = noise.likelihood(z, np.full_like(z, 7.0), 30.0)
    assert (found.shape, found.dtype) == ((4, 6), np.float64)
    each = [noise.likelihood(row, np.full_like(row, 7.0), 30.0) for row in z]
    assert np.array_equal(found, each)
    assert np.array_equal(noise.likelihood(z.T, np.full_like(z.T, 7.0), 30.0), found.T)


@pytest.mark.parametrize("sigma", [1e-300, 1e-9, 1e3, 1e9, 1e18, 1e300])
@pytest.mark.parametrize("rate", [1e-300, 1e-12, 1e3, 1e300])
def test_extreme_parameters_have_finite_likelihoods(sigma: float, rate: float) -> None:
    noise = mrs.BeamModel(sigma_hit=sigma, lambda_short=rate, z_hit=0.5, z_short=0.5)
    found = likelihood(noise, np.array([0.0, 1.0, 4.0, 6.0, 29.0, 30.0]), 5.0, 30.0)
    assert np.isfinite(found).all() and (found >= 0.0).all()


@pytest.mark.parametrize("sigma", [1e-300, 1e-9, 1e9, 1e300])
@pytest.mark.parametrize("rate", [1e-300, 1e-12, 1e3, 1e300])
@pytest.mark.parametrize("true_range", [0.0, 1e-3, 5.0, None])
def test_extreme_parameters_have_readings(sigma: float, rate: float, true_range: float | None) -> None:
    noise = mrs.BeamModel(sigma_hit=sigma, lambda_short=rate, z_hit=0.5, z_short=0.5, z_max=0.0)
    found = readings(noise, true_range, 30.0, 500)
    assert ((found >= 0.0) & (found <= 30.0)).all()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            (np.zeros(3, np.float32), np.zeros(4, np.float32), 30.0),
            ValueError,
            "readings and true_ranges must have shapes that broadcast, got (3,) and (4,)",
        ),
        ((np.zeros(3), np.zeros(3, np.float32), 30.0), TypeError, "readings must have dtype float32, got float64"),
        ((np.zeros(3, np.float32), np.zeros(3), 30.0), TypeError, "true_ranges must have dtype float32, got float64"),
        ((np.zeros(3, np.float32), np.zeros(3, np.float32), 0.0), ValueError, "max_range must be positive"),
        ((np.zeros(3, np.float32), np.zeros(3, np.float32), math.nan), ValueError, "max_range must be positive"),
        ((np.zeros(3, np.float32), np.zeros(3, np.float32), 5.0, 5.0), ValueError, "min_range must be at least 0"),
        ((np.zeros(3, np.float32), np.zeros(3, np.float32), 5.0, -1.0), ValueError, "min_range must be at least 0"),
        ((0.5, 0.5, 30.0), TypeError, "readings must have dtype float32, got float64"),
        ((np.zeros(1, np.float32), np.full(1, math.nan, np.float32), 30.0), ValueError, "true_ranges must be"),
        ((np.zeros(1, np.float32), np.full(1, -1.0, np.float32), 30.0), ValueError, "true_ranges must be"),
    ],
)
def test_invalid_likelihoods_are_rejected(arguments: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.BeamModel().likelihood(*arguments[:3], **({"min_range": arguments[3]} if arguments[3:] else {}))
    assert message in reference.message_of(caught.value)


# --- Construction ---


def test_defaults() -> None:
    noise = mrs.BeamModel()
    assert [getattr(noise, name) for name in NAMES] == [0.005, 2.0, 0.995, 0.0, 0.005, *[0.0] * 6]


def test_weights_are_scaled_to_sum_to_one() -> None:
    noise = mrs.BeamModel(z_hit=2.0, z_short=1.0, z_max=0.0, z_rand=1.0)
    assert [getattr(noise, name) for name in WEIGHTS] == [0.5, 0.25, 0.0, 0.25]


@pytest.mark.parametrize("duplicate", [copy.copy, copy.deepcopy, lambda noise: pickle.loads(pickle.dumps(noise))])
@pytest.mark.parametrize(
    "weights", [(0.995, 0.0, 0.005, 0.0), (3.0, 3.0, 3.0, 1.0), (0.3, 0.2, 0.1, 0.7), (1.0, 1.0, 1.0, 0.1)]
)
def test_copies_equal_the_model(duplicate: Any, weights: tuple[float, ...]) -> None:
    """Bit by bit, because a process that receives a copy must sample the same bytes."""
    noise = mrs.BeamModel(
        **dict(zip(WEIGHTS, weights, strict=True)), range_offset=-0.1, range_step=1e-3, range_step_share=0.01
    )
    other = duplicate(noise)
    assert [getattr(other, name) for name in NAMES] == [getattr(noise, name) for name in NAMES]
    assert repr(other) == repr(noise) == repr(eval(repr(noise), {"BeamModel": mrs.BeamModel}))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"sigma_hit": 0.0}, ValueError, "sigma_hit must be positive, got 0"),
        ({"sigma_hit": -0.1}, ValueError, "sigma_hit must be positive, got -0.1"),
        ({"sigma_hit": math.nan}, ValueError, "sigma_hit must be positive, got NaN"),
        ({"sigma_hit": math.inf}, ValueError, "sigma_hit must be"),
        ({"sigma_hit": "0.1"}, TypeError, "sigma_hit"),
        ({"lambda_short": 0.0}, ValueError, "lambda_short must be positive, got 0"),
        ({"lambda_short": -2.0}, ValueError, "lambda_short must be positive, got -2"),
        ({"lambda_short": math.nan}, ValueError, "lambda_short must be positive, got NaN"),
        ({"z_hit": -0.1}, ValueError, "z_hit must be at least 0, got -0.1"),
        ({"z_short": -1e-300}, ValueError, "z_short must be at least 0"),
        ({"z_max": math.nan}, ValueError, "z_max must be at least 0, got NaN"),
        ({"z_rand": math.inf}, ValueError, "z_rand must be"),
        ({"z_hit": 0.0, "z_max": 0.0}, ValueError, "at least one of z_hit, z_short, z_max, z_rand must be positive"),
        ({"z_hit": 1.7e308, "z_max": 1.7e308}, ValueError, "weights"),
        ({"z_hit": None}, TypeError, "z_hit"),
        ({"range_offset": math.inf}, ValueError, "range_offset must be finite, got inf"),
        ({"range_sigma_base": -0.1}, ValueError, "range_sigma_base must be at least 0, got -0.1"),
        ({"range_sigma_per_metre": math.nan}, ValueError, "range_sigma_per_metre must be at least 0, got NaN"),
        ({"range_step": -1.0}, ValueError, "range_step must be at least 0, got -1"),
        ({"range_step_share": 0.51}, ValueError, "range_step_share must be in 0..0.5, got 0.51"),
        ({"range_step": "1 mm"}, TypeError, "range_step"),
        ({"sigma": 0.1}, TypeError, "sigma"),
    ],
)
def test_invalid_models_are_rejected(options: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error) as caught:
        mrs.BeamModel(**options)
    assert message in reference.message_of(caught.value)


anything = st.one_of(
    st.none(), st.booleans(), st.integers(-(2**65), 2**65), st.floats(), st.text(max_size=3), st.just([1.0])
)


@given(st.dictionaries(st.sampled_from(NAMES), anything))
def test_no_argument_causes_a_panic(options: dict[str, Any]) -> None:
    try:
        noise = mrs.BeamModel(**options)
    except (ValueError, TypeError):
        return
    assert sum(getattr(noise, name) for name in WEIGHTS) == pytest.approx(1.0)
    found = readings(noise, 5.0, 30.0, 20)
    assert ((found >= 0.0) & (found <= 30.0)).all()
