"""material: paths of beams through glass and from mirror to mirror, against a tracer of a few lines among segments."""

from __future__ import annotations

import copy
import itertools
import math
import pickle
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

import mobile_robot_simulator as mrs

SEED = 20
WALL, GLASS, MIRROR, DARK = range(4)
CLEAR = mrs.Material("glass", return_chance=0.0)
"""Glass that every beam passes."""


# --- The oracle: segments, each with a material. It knows neither grids nor cells. ---

Point = NDArray[np.float64]
Segment = tuple[Point, Point, int]


def outline(corners: Sequence[Sequence[float]], material: int) -> list[Segment]:
    """Returns the edges of a polygon."""
    points = [np.array(corner, np.float64) for corner in corners]
    return [(a, b, material) for a, b in itertools.pairwise([*points, points[0]])]


def cross(a: Point, b: Point) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def trace(segments: list[Segment], start: Point, angle: float, limit: float, bounces: int = 16) -> tuple[float, int]:
    """Returns the length of the path of a beam and its number of reflections; glass always lets it pass."""
    at, way, length = np.array(start, np.float64), np.array([math.cos(angle), math.sin(angle)]), 0.0
    for bounce in range(bounces + 1):
        nearest, hit = math.inf, None
        for a, b, material in segments:
            turn = cross(way, b - a)
            if material != GLASS and turn != 0.0:
                distance, share = cross(a - at, b - a) / turn, cross(a - at, way) / turn
                if distance > 1e-7 and 0.0 <= share <= 1.0 and distance < nearest:
                    nearest, hit = distance, (a, b, material)
        length += nearest
        if hit is None or length >= limit:
            return limit, bounce
        a, b, material = hit
        if material != MIRROR:
            return length, bounce
        along = (b - a) / np.linalg.norm(b - a)
        at, way = at + nearest * way, 2.0 * np.dot(way, along) * along - way
    return limit, bounces


def square(col: int, row: int, material: int, side: float) -> list[Segment]:
    """Returns the outline of a cell."""
    x, y = col * side, row * side
    return outline([(x, y), (x + side, y), (x + side, y + side), (x, y + side)], material)


def random_room(rng: np.random.Generator, resolution: float) -> tuple[mrs.OccupancyGrid, list[Segment]]:
    """Returns a room with walls around it and blocks of all materials in it, as a grid and as segments."""
    size = 24
    cells, materials = np.zeros((size, size), np.int8), np.zeros((size, size), np.uint8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    for side in range(4):
        number = rng.integers(4)
        for view in (materials, materials.T)[side % 2 : side % 2 + 1]:
            view[-(side // 2), 1:-1] = number
    for _ in range(12):
        row, col = rng.integers(2, size - 3, 2)
        height, width = rng.integers(1, 4, 2)
        cells[row : row + height, col : col + width] = 100
        materials[row : row + height, col : col + width] = rng.integers(4)
    segments = []
    for row, col in np.argwhere(cells == 100):
        segments += square(col, row, materials[row, col], resolution)
    table = ["wall", CLEAR, "mirror", "dark"]
    return mrs.OccupancyGrid(cells, resolution=resolution, materials=materials, material_table=table), segments


def free_poses(grid: mrs.OccupancyGrid, count: int, seed: int) -> NDArray[np.float64]:
    return np.asarray(grid.draw_free_poses(count, radius=0.02, seed=seed))


LASER = mrs.LaserScanner(fov=6.2, beam_count=97, max_range=12.0)


def test_paths_in_rooms_of_cells_are_those_of_the_oracle() -> None:
    rng = np.random.default_rng(SEED)
    reflected = 0
    for room in range(12):
        grid, segments = random_room(rng, 0.25)
        poses = free_poses(grid, 2, room)
        for pose, ranges in zip(poses, LASER.scan_batch(grid, poses), strict=True):
            traced = [trace(segments, pose[:2], pose[2] + angle, LASER.max_range) for angle in LASER.angles]
            reflected += sum(bounces > 0 for _, bounces in traced)
            expected = np.array([length for length, _ in traced])
            # A beam within rounding of a corner may go either way after it.
            assert np.mean(np.abs(ranges - expected) < 1e-4) > 0.995
    assert reflected > 500


def placed(points: Point, pose: mrs.Pose) -> Point:
    """Returns points (N, 2) of the frame of a pose in the frame around it."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    return points @ np.array([[cos, sin], [-sin, cos]]) + [pose.x, pose.y]


def test_paths_among_obstacles_at_any_angle_are_those_of_the_oracle() -> None:
    rng = np.random.default_rng(SEED)
    cells = np.zeros((40, 40), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    origin = mrs.Pose(-3.0, 2.0, 0.7)
    grid = mrs.OccupancyGrid(cells, resolution=0.25, origin=origin)
    walls = outline([(0.25, 0.25), (9.75, 0.25), (9.75, 9.75), (0.25, 9.75)], WALL)
    materials = {WALL: "wall", GLASS: CLEAR, MIRROR: "mirror", DARK: "dark"}
    reflected = 0
    for _ in range(40):
        obstacles, segments = [], list(walls)
        for _ in range(5):
            number = int(rng.choice([MIRROR, MIRROR, GLASS, WALL]))
            points = rng.uniform(0.2, 1.0, 5)[:, np.newaxis] * [(math.cos(a), math.sin(a)) for a in np.arange(5) * 1.2566]
            pose = mrs.Pose(*rng.uniform(2.0, 8.0, 2), rng.uniform(-3.0, 3.0))
            obstacles.append((mrs.Shape.polygon(points).with_material(materials[number]), origin * pose))
            segments += outline(placed(points, pose), number)
        start = mrs.Pose(*rng.uniform(1.0, 9.0, 2), rng.uniform(-3.0, 3.0))
        if mrs.touches(grid, mrs.Shape.disc(0.05), origin * start, obstacles=obstacles):
            continue
        ranges = LASER.scan(grid, origin * start, obstacles=obstacles)
        traced = [trace(segments, np.array([start.x, start.y]), start.yaw + a, LASER.max_range) for a in LASER.angles]
        reflected += sum(bounces > 0 for _, bounces in traced)
        assert np.mean(np.abs(ranges - [length for length, _ in traced]) < 1e-4) > 0.99
    assert reflected > 100


def corridor(far: int, near: int = WALL) -> mrs.OccupancyGrid:
    """Returns a row of ten free cells of 1 m between a cell of one material at x = 0 and one at x = 11."""
    cells, materials = np.zeros((1, 12), np.int8), np.zeros((1, 12), np.uint8)
    cells[0, [0, -1]], materials[0, [0, -1]] = 100, (near, far)
    return mrs.OccupancyGrid(cells, resolution=1.0, materials=materials)


AHEAD = mrs.LaserScanner(beam_count=1, max_range=100.0)


def test_a_mirror_shows_what_is_behind_the_robot() -> None:
    # 7 m to the mirror, and 10 m back to the wall.
    assert AHEAD.scan(corridor(MIRROR), (4.0, 0.5, 0.0)) == [17.0]


def test_a_beam_between_two_mirrors_ends_without_a_return() -> None:
    assert AHEAD.scan(corridor(MIRROR, MIRROR), (4.0, 0.5, 0.0)) == [100.0]
    endless = mrs.LaserScanner(beam_count=1, max_range=1e9)
    assert endless.scan(corridor(MIRROR, MIRROR), (4.0, 0.5, 0.0)) == np.float32(1e9)


def test_glass_returns_a_beam_at_a_right_angle_and_lets_others_pass() -> None:
    cells, materials = np.zeros((41, 12), np.int8), np.zeros((41, 12), np.uint8)
    cells[:, [5, 10]], materials[:, 5] = 100, GLASS
    grid = mrs.OccupancyGrid(cells, resolution=1.0, materials=materials)
    angles = np.array([0.0, 0.05, 0.099, 0.101, 0.5])
    laser = mrs.LaserScanner(beam_count=1, max_range=100.0)
    ranges = [float(laser.scan(grid, (1.0, 20.5, angle))[0]) for angle in angles]
    np.testing.assert_allclose(ranges, np.array([4, 4, 4, 9, 9]) / np.cos(angles), rtol=1e-6)


def test_the_share_of_beams_that_glass_returns_is_its_chance() -> None:
    cells, materials = np.zeros((1, 12), np.int8), np.zeros((1, 12), np.uint8)
    cells[0, [5, 10]], materials[0, 5] = 100, GLASS
    pane = mrs.Material("glass", return_chance=0.3)
    grid = mrs.OccupancyGrid(cells, resolution=1.0, materials=materials, material_table=["wall", pane])
    laser = mrs.LaserScanner(fov=1e-6, beam_count=100, max_range=100.0)
    noise = mrs.BeamModel(sigma_hit=1e-3, z_hit=1.0, z_max=0.0)
    readings = laser.scan_batch(grid, np.tile([1.0, 0.5, 0.0], (400, 1)), noise=noise, seed=SEED)
    is_pane = np.abs(readings - 4.0) < 0.1
    assert np.all(is_pane | (np.abs(readings - 9.0) < 0.1))
    # 40,000 draws: the standard deviation of the share is 0.0023.
    assert abs(is_pane.mean() - 0.3) < 0.01
    assert abs(is_pane.mean(axis=0) - 0.3).max() < 0.1  # each beam by itself
    assert abs(np.mean(is_pane[:, 1:] & is_pane[:, :-1]) - 0.09) < 0.01  # neighbours are independent


@pytest.mark.parametrize("noise", [None, mrs.BeamModel(sigma_hit=0.05)])
def test_the_same_bytes_for_threads_chunks_and_scans_that_take_no_time(noise: mrs.BeamModel | None) -> None:
    grid, _ = random_room(np.random.default_rng(SEED), 0.25)
    grid = grid.with_materials(grid.materials)  # glass that returns some beams
    poses = free_poses(grid, 40, SEED)
    obstacles = [(mrs.Shape.disc(0.4).with_material("mirror"), (3.0, 3.0, 0.0))]
    call = {"obstacles": obstacles, "noise": noise}
    seed = {} if noise is None else {"seed": SEED}
    whole = LASER.scan_batch(grid, poses, threads=1, **call, **seed)
    assert LASER.scan_batch(grid, poses, threads=7, **call, **seed).tobytes() == whole.tobytes()
    parts = [
        LASER.scan_batch(grid, poses[first:last], first_index=first if seed else None, **call, **seed)
        for first, last in ((0, 1), (1, 18), (18, 40))
    ]
    assert np.concatenate(parts).tobytes() == whole.tobytes()
    assert LASER.scan_batch(grid, poses, scan_duration=0.0, **call, **seed).tobytes() == whole.tobytes()


def test_a_scan_that_takes_time_sees_a_mirror_where_it_is() -> None:
    grid = mrs.OccupancyGrid(np.full((1, 1), 100, np.int8), resolution=1.0)  # a wall from x = 0 to 1
    laser = mrs.LaserScanner(fov=1e-9, beam_count=3, max_range=100.0)
    plate = mrs.Shape.rectangle(0.2, 5.0).with_material("mirror")
    # The robot at x = 3 looks at a mirror whose face moves away from x = 5.9 at 1 m/s.
    ranges = laser.scan_batch(
        grid, [(3.0, 0.5, 0.0)], scan_duration=2.0, obstacles=[(plate, (6.0, 0.5, 0.0), (1.0, 0.0, 0.0))]
    )
    np.testing.assert_allclose(ranges, [[2.9 + 4.9, 3.9 + 5.9, 4.9 + 6.9]], atol=1e-6)


def test_grids_of_one_material_have_the_bytes_of_grids_without() -> None:
    grid = mrs.floor_plan("office", seed=1)
    poses = free_poses(grid, 50, SEED)
    plain = LASER.scan_batch(grid, poses, noise=mrs.BeamModel(), seed=1)
    for number in (WALL, DARK):
        layer = np.full(grid.shape, number, np.uint8)
        assert (
            LASER.scan_batch(grid.with_materials(layer), poses, noise=mrs.BeamModel(), seed=1).tobytes() == plain.tobytes()
        )
    free = np.where(grid.cells == 100, WALL, MIRROR).astype(np.uint8)  # mirrors in free cells do nothing
    assert LASER.scan_batch(grid.with_materials(free), poses, noise=mrs.BeamModel(), seed=1).tobytes() == plain.tobytes()


def test_clear_glass_has_the_bytes_of_no_wall_at_all() -> None:
    rng = np.random.default_rng(SEED)
    cells = np.where(rng.random((60, 60)) < 0.1, 100, 0).astype(np.int8)
    panes = (cells == 100) & (rng.random((60, 60)) < 0.5)
    grid = mrs.OccupancyGrid(cells, resolution=0.2, materials=panes.astype(np.uint8), material_table=["wall", CLEAR])
    empty = mrs.OccupancyGrid(np.where(panes, 0, cells).astype(np.int8), resolution=0.2)
    poses = free_poses(grid, 40, SEED)
    assert LASER.scan_batch(grid, poses).tobytes() == LASER.scan_batch(empty, poses).tobytes()


def test_each_kind_has_the_reflectivity_of_the_material_that_has_its_name() -> None:
    for kind, name, reflectivity in (("opaque", "wall", 1.0), ("glass", "glass", 0.08), ("mirror", "mirror", 0.9)):
        assert mrs.Material(kind) == mrs.Material.named(name) == mrs.Material(kind, reflectivity=reflectivity)  # type: ignore[arg-type]
        assert mrs.Material(kind, reflectivity=0.5).reflectivity == 0.5  # type: ignore[arg-type]


def test_a_path_is_never_shorter_than_the_way_to_the_first_surface() -> None:
    grid, _ = random_room(np.random.default_rng(SEED), 0.25)
    poses = free_poses(grid, 100, SEED)
    assert np.all(LASER.scan_batch(grid, poses) >= LASER.scan_batch(grid.with_materials(None), poses))


def test_the_likelihood_of_a_scan_knows_glass_and_mirrors() -> None:
    noise = mrs.BeamModel(sigma_hit=0.1)
    poses = [(4.0, 0.5, 0.0), (5.0, 0.5, 0.0)]
    scores = AHEAD.log_likelihood(corridor(MIRROR), poses, np.float32([17.0]), noise=noise)
    assert scores[0] == pytest.approx(math.log(noise.likelihood(np.float32(17.0), np.float32(17.0), max_range=100.0)))
    assert scores[1] < scores[0]


def test_materials_are_kept_in_copies_pickles_and_after_changes() -> None:
    grid = corridor(MIRROR)
    for kept in (copy.copy(grid), pickle.loads(pickle.dumps(grid))):
        assert kept.material_table == [mrs.Material.named(name) for name in ("wall", "glass", "mirror", "dark")]
        assert kept.materials is not None and kept.materials.tolist() == [[0] * 11 + [MIRROR]]
        kept.set_cells(0, 1, np.full((1, 1), 100, np.int8))
        assert AHEAD.scan(kept, (4.0, 0.5, 0.0)) == [7.0 + 9.0]
    assert not grid.materials.flags.writeable
    assert grid.with_materials(None).materials is None
    shape = mrs.Shape.disc(0.3).with_material(mrs.Material("glass", reflectivity=0.5))
    assert pickle.loads(pickle.dumps(shape)) == shape != mrs.Shape.disc(0.3)
    assert eval(repr(shape), {"Shape": mrs.Shape, "Material": mrs.Material}) == shape


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: mrs.Material("wood"), "kind must be 'opaque', 'glass' or 'mirror', got \"wood\""),
        (lambda: mrs.Material.named("wood"), 'the material must be one of wall, glass, mirror, dark, got "wood"'),
        (lambda: mrs.Material(reflectivity=1.5), "reflectivity must be in 0..1, got 1.5"),
        (lambda: mrs.Material(return_chance=math.nan), "return_chance must be in 0..1, got NaN"),
        (lambda: mrs.Material(return_angle=-1.0), "return_angle must be in 0..π/2 rad, got -1"),
        (lambda: corridor(7), "materials must be numbers of the 4 in the table, got 7 in row 0, column 11"),
        (
            lambda: corridor(0).with_materials(np.zeros((2, 3), np.uint8)),
            "materials must have the shape (1, 12) of the cells, got (2, 3)",
        ),
        (lambda: corridor(0).with_materials(np.zeros(3, np.uint8)), "materials must have shape (H, W), got (3,)"),
        (lambda: corridor(0).with_materials(None, table=["wall"]), "table needs materials, got None"),
        (lambda: corridor(0).with_materials(np.zeros((1, 12), np.uint8), table=[]), "materials must be in 1..255, got 0"),
        (lambda: mrs.Shape.disc(1.0).with_material("wood"), "the material must be one of wall"),
    ],
)
def test_bad_materials_are_rejected(call: object, message: str) -> None:
    with pytest.raises(ValueError) as error:
        call()  # type: ignore[operator]
    assert message in str(error.value)


def test_materials_of_the_wrong_type_are_rejected() -> None:
    with pytest.raises(TypeError, match=r"materials must .*uint8"):
        corridor(0).with_materials(np.zeros((1, 12), np.float64))
    with pytest.raises(TypeError, match="a material must be a Material or the name of one, got int: 3"):
        mrs.Shape.disc(1.0).with_material(3)  # type: ignore[arg-type]
