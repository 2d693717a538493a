"""map_pool: no map is in two splits, equal files are one map, and a grid is loaded once."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

import mobile_robot_simulator as mrs
from datasets.small_plans import small
from mobile_robot_simulator.datasets import Plan
from mobile_robot_simulator.datasets.map_pool import MapPool, MapSource, digest_of, shares, sources_by_split


def save(path: Path, seed: int) -> None:
    mrs.save_map(mrs.floor_plan("maze", seed=seed, size=(10.0, 8.0), resolution=0.1), path)


@pytest.mark.parametrize(
    ("total", "weights", "expected"),
    [(10, [1, 1], [5, 5]), (10, [8, 1, 1], [8, 1, 1]), (3, [0.98, 0.01, 0.01], [1, 1, 1]), (7, [2, 1], [5, 2])],
)
def test_shares(total: int, weights: list[float], expected: list[int]) -> None:
    assert shares(total, weights, least=1) == expected


def test_equal_files_are_one_map_and_no_map_is_in_two_splits(tmp_path: Path) -> None:
    for name, seed in {"a": 1, "b": 2, "copy_of_a": 1, "c": 3}.items():
        save(tmp_path / f"{name}.yaml", seed)
    plan = Plan(count=10, maps=[{"files": "*.yaml"}], splits={"train": 1, "test": 1, "val": 1}, folder=tmp_path)
    found = sources_by_split(plan)
    names = sorted(source.name for sources in found.values() for source in sources)
    assert names == ["a.yaml", "b.yaml", "c.yaml"] and [len(sources) for sources in found.values()] == [1, 1, 1]


def test_the_seed_decides_the_split_and_nothing_else() -> None:
    plan = small(maps=[{"floor_plan": "maze", "seeds": [0, 99]}], splits={"train": 0.9, "test": 0.1})
    found = sources_by_split(plan)
    assert {split: len(sources) for split, sources in found.items()} == {"train": 90, "test": 10}
    assert not {*found["train"]} & {*found["test"]} and sources_by_split(plan) == found
    other = sources_by_split(plan.model_copy(update={"seed": 6}))
    assert {*other["test"]} != {*found["test"]}


def test_fewer_maps_than_splits() -> None:
    with pytest.raises(ValueError, match="at least one map for each split, because no map is in two; got 1 for train, test"):
        sources_by_split(small(maps=[{"floor_plan": "maze"}]))


def test_a_name_without_a_file(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"no map file of this name for 'x\*.yaml' of the plan"):
        sources_by_split(Plan(count=1, maps=[{"files": "x*.yaml"}], folder=tmp_path))


def test_a_file_that_changes_is_an_error(tmp_path: Path) -> None:
    save(tmp_path / "a.yaml", 1)
    (source,) = sources_by_split(Plan(count=1, maps=[{"files": "a.yaml"}], folder=tmp_path))["train"]
    save(tmp_path / "a.yaml", 2)
    with pytest.raises(ValueError, match=r"a.yaml: the map has changed since the data set was begun"):
        source.load()


def test_the_digest_tells_grids_apart() -> None:
    grid = mrs.floor_plan("maze", seed=1, size=(10.0, 8.0), resolution=0.1)
    same = mrs.OccupancyGrid(grid.cells, resolution=0.1)
    others = [
        mrs.OccupancyGrid(grid.cells, resolution=0.2),
        mrs.OccupancyGrid(grid.cells, resolution=0.1, origin=(0.0, 0.0, 0.1)),
        mrs.OccupancyGrid(grid.cells, resolution=0.1, unknown="occupied"),
        mrs.OccupancyGrid(grid.cells, resolution=0.1, occupied_threshold=50),
        mrs.OccupancyGrid(grid.cells.T.copy(), resolution=0.1),
    ]
    assert digest_of(same) == digest_of(grid) and len({digest_of(grid), *map(digest_of, others)}) == 6


def test_threads_load_a_grid_once_and_few_grids_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    sources = sources_by_split(small(splits={"train": 1}))["train"]
    loads: list[str] = []
    load = MapSource.load
    monkeypatch.setattr(MapSource, "load", lambda source: loads.append(source.name) or load(source))
    pool, found = MapPool(kept=2), []
    threads = [threading.Thread(target=lambda: found.append(pool.grid(sources[0])[0])) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(loads) == 1 and len({id(grid) for grid in found}) == 1
    for source in (sources[1], sources[2], sources[2], sources[0]):
        pool.grid(source)
    assert loads == [sources[n].name for n in (0, 1, 2, 0)]


def test_a_pattern_that_also_names_the_plan(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text("count: 10\nmaps: [{files: '*.yaml'}]\n")
    with pytest.raises(ValueError, match=r"maps: plan.yaml, which is named by '\*.yaml', is not a map: .*missing image"):
        sources_by_split(small(maps=[{"files": "*.yaml"}], splits={"train": 1}, folder=tmp_path))
