"""Reader: opens a complete data set, and reads it in batches."""

from __future__ import annotations

import operator
import os
import random
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..quoting import quoted
from .formats import format_of, formats
from .plan import Plan
from .workspace import UNFINISHED

__all__ = ["Dataset", "Split", "identity_of", "open"]


class Split:
    """A split of a data set. Its arrays are read when they are used.

    It has a length and an item for each scan, as data loaders need them: `split[i]` is a dictionary with a row of each
    array. It can be sent to other processes, forked or spawned.

    Attributes:
        arrays: The arrays by name, as `zarr.Array`. Their attributes have units and frames.
    """

    def __init__(self, path: Path, name: str) -> None:
        from .zarr_store import arrays_of, read_rows

        self._path, self._name = path, name
        self._read: Callable[[Any, int | slice], NDArray[Any]] = read_rows
        self.arrays: Mapping[str, Any] = arrays_of(path, name)
        self._shard = int(self.arrays["ranges"].shards[0])

    def __repr__(self) -> str:
        return f"Split({self._name!r}, {len(self)} scans, {', '.join(self.arrays)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return Split, (self._path, self._name)

    def __len__(self) -> int:
        return int(self.arrays["ranges"].shape[0])

    def __getitem__(self, index: int) -> dict[str, NDArray[Any]]:
        try:
            number = operator.index(index)
        except TypeError:
            raise TypeError(f"an index must be an integer, got {quoted(index)}; batches reads many scans") from None
        if not -len(self) <= number < len(self):
            raise IndexError(f"a scan must be in 0..{len(self) - 1}, got {number}")
        return {name: self._read(array, number % len(self)) for name, array in self.arrays.items()}

    def batches(
        self,
        size: int,
        *,
        seed: int | None = None,
        worker: int = 0,
        workers: int = 1,
        columns: Collection[str] | None = None,
    ) -> Iterator[dict[str, NDArray[Any]]]:
        """Yields all scans once, in batches. One shard is in memory at a time.

        Args:
            size: Number of scans in a batch; the last one has the rest.
            seed: With a seed, the shards are in random order, and so are the scans of each shard. Give another one for each
                epoch. None keeps the order.
            worker: Number of this worker. Each gets every `workers`-th shard of the same order.
            workers: Number of workers that share the split.
            columns: Names of the arrays to read. None means all.

        Yields:
            The rows of each array by name.

        Raises:
            OSError: A file is missing.
            ValueError: A number is out of range, a column is unknown, or a file is damaged.
        """
        if size < 1:
            raise ValueError(f"size must be at least 1, got {size}")
        if not 0 <= worker < workers:
            raise ValueError(f"worker must be in 0..workers - 1, got {worker} of {workers}")
        names = self.arrays if columns is None else columns
        if isinstance(names, str) or not names:
            raise ValueError(f"columns must be a list of at least one of {', '.join(self.arrays)}, got {quoted(names)}")
        for name in names:
            if name not in self.arrays:
                raise ValueError(f"each of columns must be one of {', '.join(self.arrays)}, got {quoted(name)}")
        arrays = {name: self.arrays[name] for name in names}
        order = list(range(-(-len(self) // self._shard)))
        if seed is not None:
            dice = random.Random(f"{seed}/shards")
            order.sort(key=lambda _: dice.random())
        return self._batches(arrays, size, seed, order[worker::workers])

    def _batches(
        self, arrays: Mapping[str, Any], size: int, seed: int | None, order: list[int]
    ) -> Iterator[dict[str, NDArray[Any]]]:
        rest: dict[str, NDArray[Any]] = {}
        for shard in order:
            rows = slice(shard * self._shard, min((shard + 1) * self._shard, len(self)))
            part = {name: self._read(array, rows) for name, array in arrays.items()}
            if seed is not None:
                # The raw numbers of a bit generator are the same in all versions of NumPy.
                bits = np.random.PCG64([seed % 2**63, shard]).random_raw(rows.stop - rows.start)
                mixed = np.argsort(bits, kind="stable")
                part = {name: array[mixed] for name, array in part.items()}
            if rest:
                part = {name: np.concatenate([rest[name], array]) for name, array in part.items()}
            count = len(next(iter(part.values())))
            whole = count - count % size
            for first in range(0, whole, size):
                yield {name: array[first : first + size] for name, array in part.items()}
            rest = {name: array[whole:] for name, array in part.items()} if whole < count else {}
        if rest:
            yield rest


class Dataset(Mapping[str, Split]):
    """A complete data set: its splits by name.

    Attributes:
        path: The folder.
        plan: The plan that it was made from.
        attributes: The provenance: what it was made from, its maps with their digests, versions.
    """

    def __init__(self, path: Path, attributes: Mapping[str, Any]) -> None:
        self.path, self.attributes = path, attributes
        self.plan = Plan(**attributes["made_from"]["plan"])
        self._splits = {name: Split(path, name) for name in self.plan.splits}

    def __getitem__(self, name: str) -> Split:
        if name not in self._splits:
            raise KeyError(f"a split must be one of {', '.join(self._splits)}, got {quoted(name)}")
        return self._splits[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._splits)

    def __len__(self) -> int:
        return len(self._splits)

    def __repr__(self) -> str:
        return f"Dataset({str(self.path)!r}, {', '.join(f'{name}: {len(split)}' for name, split in self.items())})"


def open(path: str | os.PathLike[str]) -> Dataset:
    """Opens a complete data set in Zarr. Arrays are read when they are used.

    Args:
        path: Folder of the data set.

    Raises:
        ImportError: The extra `datasets` is not installed.
        OSError: The folder does not exist, or a file that describes an array is missing.
        ValueError: The folder is no complete data set, or a file that describes an array is damaged.
    """
    identity, _ = identity_of(Path(path))
    if identity["plan"]["format"] != "zarr":
        raise ValueError(f"{path}: only data sets in Zarr are opened here; open the Parquet files with pyarrow or datasets")
    from .zarr_store import attributes_of

    return Dataset(Path(path), attributes_of(Path(path)))


def identity_of(path: Path) -> tuple[dict[str, Any], Any]:
    """Returns what a complete data set was made from, and the module of its format.

    Raises:
        OSError: The folder does not exist.
        ValueError: The folder is no complete data set.
    """
    if path.exists() and not path.is_dir():
        raise NotADirectoryError(20, "this must be the folder of a data set, got a file", str(path))
    if not path.is_dir():
        raise FileNotFoundError(2, "no such folder", str(path))
    for name, complete in formats().items():
        if (path / complete).is_file():
            store = format_of(name)
            return store.identity_of(path), store
    if (path / UNFINISHED).is_dir():
        raise ValueError(f"{path}: the data set is not complete; give the command that makes it again to go on with it")
    raise ValueError(f"{path}: must be the folder of a data set, got none of {', '.join(formats().values())}")
