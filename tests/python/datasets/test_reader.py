"""reader: every scan comes once, in an order that the seed decides, also in forked and spawned workers."""

from __future__ import annotations

import copy
import errno
import multiprocessing
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("zarr", reason="the extra `datasets` is not installed, or has no Zarr for this Python")

import zarr

from datasets.small_plans import load, small
from mobile_robot_simulator.datasets import Dataset, generate, open, verify


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    out = tmp_path_factory.mktemp("reader") / "data"
    generate(small(), out=out)
    return open(out)


def test_arrays_rows_and_plan(data: Dataset) -> None:
    assert {name: len(split) for name, split in data.items()} == {"train": 133, "test": 67} and data.plan == small()
    train = data["train"]
    assert sorted(train.arrays) == ["drawn", "map", "poses", "ranges", "scene"]
    assert isinstance(train.arrays["ranges"], zarr.Array)
    row = train[-1]
    assert row["ranges"].shape == (31,) and np.array_equal(row["poses"], train.arrays["poses"][132]) and row["scene"] == 16
    assert repr(train) == "Split('train', 133 scans, drawn, map, poses, ranges, scene)"
    for index in (133, -134):
        with pytest.raises(IndexError, match=r"a scan must be in 0..132, got"):
            train[index]


def test_batches_in_order(data: Dataset) -> None:
    train = data["train"]
    batches = list(train.batches(50))
    assert [len(batch["ranges"]) for batch in batches] == [50, 50, 33]
    for name, array in train.arrays.items():
        assert np.array_equal(np.concatenate([batch[name] for batch in batches]), array[:])
    assert {*next(train.batches(5, columns=["poses"]))} == {"poses"}


@pytest.mark.parametrize("workers", [1, 2, 3, 9])
def test_shuffled_batches_have_every_scan_once(workers: int, data: Dataset) -> None:
    train = data["train"]
    poses = [
        batch["poses"] for worker in range(workers) for batch in train.batches(7, seed=3, worker=worker, workers=workers)
    ]
    found, whole = np.concatenate(poses), train.arrays["poses"][:]
    assert not np.array_equal(found, whole)
    assert np.array_equal(found[np.lexsort(found.T)], whole[np.lexsort(whole.T)])


def test_the_seed_decides_the_order(data: Dataset) -> None:
    def order(seed: int) -> list[float]:
        return [float(x) for batch in data["train"].batches(10, seed=seed) for x in batch["poses"][:, 0]]

    assert order(1) == order(1) != order(2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"size": 0}, "size must be at least 1, got 0"),
        ({"size": 4, "columns": "ranges"}, "columns must be a list of at least one of drawn, map, .*, scene, got 'ranges'"),
        ({"size": 4, "columns": []}, r"columns must be a list of at least one of drawn, map, .*, scene, got \[\]"),
        ({"size": 4, "columns": ["poses", "x"]}, "each of columns must be one of drawn, map, .*, scene, got 'x'"),
        ({"size": 1, "worker": 2, "workers": 2}, r"worker must be in 0..workers - 1, got 2 of 2"),
    ],
)
def test_wrong_arguments_of_batches(arguments: dict[str, Any], message: str, data: Dataset) -> None:
    with pytest.raises(ValueError, match=message):
        data["train"].batches(**arguments)


@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning")
@pytest.mark.parametrize("start_method", [m for m in ("fork", "spawn") if m in multiprocessing.get_all_start_methods()])
def test_workers_read_what_their_parent_reads(start_method: str, data: Dataset) -> None:
    train, context = data["train"], multiprocessing.get_context(start_method)
    expected = {
        worker: (
            [batch["ranges"].tobytes() for batch in train.batches(16, seed=1, worker=worker, workers=2)],
            [train[index]["ranges"].tobytes() for index in range(worker, 40, 2)],
        )
        for worker in range(2)
    }
    results = context.Queue()
    workers = [context.Process(target=load, args=(train, worker, results), daemon=True) for worker in range(2)]
    for process in workers:
        process.start()
    found = {worker: (shuffled, rows) for worker, shuffled, rows in (results.get(timeout=60) for _ in workers)}
    for process in workers:
        process.join(60)
        assert process.exitcode == 0
    assert found == expected


def test_copies_read_the_same(data: Dataset) -> None:
    train = data["train"]
    for other in (pickle.loads(pickle.dumps(train)), copy.copy(train), copy.deepcopy(train)):
        assert np.array_equal(other.arrays["ranges"][:], train.arrays["ranges"][:])
    assert len(pickle.dumps(train)) < 1000


def test_a_data_set_that_is_not_complete(tmp_path: Path) -> None:
    def stop(progress: object) -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        generate(small(), out=tmp_path, progress=stop)
    with pytest.raises(ValueError, match="the data set is not complete; give the command that makes it again"):
        open(tmp_path)


@pytest.mark.parametrize("damage", ["missing", "empty", "a folder"])
@pytest.mark.parametrize("name", ["ranges/c.1.0", "map/c.1"])
def test_a_missing_chunk_is_no_zeros(name: str, damage: str, tmp_path: Path) -> None:
    generate(small(splits={"train": 1}, maps=[{"floor_plan": "maze", "size": [10, 8]}]), out=tmp_path)
    file, train = tmp_path / "train" / name, open(tmp_path)["train"]
    # A chunk that has nothing but the value that Zarr fills in is there, and is read.
    assert not train.arrays["map"][:].any()
    file.unlink()
    if damage == "empty":
        file.touch()
    elif damage == "a folder":
        file.mkdir()
    assert train[31]["ranges"].any() and len(next(train.batches(32))["map"]) == 32
    for read in (lambda: train[32], lambda: [*train.batches(8)], lambda: train.arrays[name.partition("/")[0]][:]):
        with pytest.raises(FileNotFoundError, match=r"give the command that made the data set again: .*c\.1") as error:
            read()
        assert (error.value.errno, error.value.filename) == (errno.ENOENT, str(file))


@pytest.mark.parametrize(
    ("index", "shown"), [(slice(0, 3), r"slice\(0, 3, None\)"), (np.arange(3), r"array\("), (1.0, "1.0")]
)
def test_an_index_is_an_integer(index: Any, shown: str, data: Dataset) -> None:
    with pytest.raises(TypeError, match=f"an index must be an integer, got {shown}.*; batches reads many scans"):
        data["train"][index]
    assert np.array_equal(data["train"][np.int64(3)]["ranges"], data["train"][3]["ranges"])


def test_an_unknown_split(data: Dataset) -> None:
    with pytest.raises(KeyError, match="a split must be one of train, test, got 'validation'"):
        data["validation"]
    assert "validation" not in data and data.get("validation") is None


def test_a_file_is_no_data_set(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text("count: 1")
    with pytest.raises(NotADirectoryError, match=r"this must be the folder of a data set, got a file: .*plan.yaml"):
        open(tmp_path / "plan.yaml")


@pytest.mark.parametrize("compression", ["none", "lz4", "zstd"])
@pytest.mark.parametrize("damage", ["short", "changed"])
def test_the_error_of_a_damaged_chunk_names_its_file(damage: str, compression: str, tmp_path: Path) -> None:
    generate(small(compression=compression), out=tmp_path)
    file, train = tmp_path / "train/poses/c.2.0", open(tmp_path)["train"]
    data = bytearray(file.read_bytes())
    data[-1] ^= 1  # Of the sum of the index.
    if compression != "none":
        data[:16] = b"x" * 16
    file.write_bytes(data if damage == "changed" else data[: len(data) // 2])
    for read in (lambda: train[64], lambda: [*train.batches(50)]):
        with pytest.raises(ValueError) as error:
            read()
        assert str(error.value).startswith(f"{file}: this file of the data set is damaged: ")
        assert str(error.value).endswith("; remove this file and give the command that made the data set again")


DESCRIPTIONS = ["", "{}", "[]", '{"zarr_format": 3}', '{"zarr_format": 3, "node_type": "group"}', "\xff", "missing"]


@pytest.mark.parametrize("text", DESCRIPTIONS)
@pytest.mark.parametrize("name", ["zarr.json", "train/zarr.json", "train/ranges/zarr.json"])
def test_the_error_of_a_bad_description_names_its_file(name: str, text: str, tmp_path: Path) -> None:
    generate(small(count=32), out=tmp_path)
    file = tmp_path / name
    file.write_bytes(text.encode("latin1"))
    if text == "missing":
        file.unlink()
    reads: list[Callable[[], Any]] = [lambda: open(tmp_path)]
    if name == "zarr.json":
        if text == "missing":
            return  # Without it, the folder is not complete.
        reads.append(lambda: generate(small(count=32), out=tmp_path))
    if name == "train/ranges/zarr.json":
        assert f"{file}" in verify(tmp_path).differences[0].problem
    else:
        reads.append(lambda: verify(tmp_path))
    for read in reads:
        with pytest.raises((ValueError, OSError)) as error:
            read()
        assert f"{file}" in str(error.value), error.value
        says_what_to_do = "make the data set again in a new folder" in str(error.value)
        assert says_what_to_do or "is not a data set of this package, or is damaged" in str(error.value)
