"""Engines: what makes shards in parallel. Each gives the same bytes, because a shard depends on the job only."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any, NamedTuple

from .job import Files, Job, Shard, digests_of
from .map_pool import MapPool

__all__ = ["MadeShard", "Stopped", "made", "make_on_threads"]


class Stopped(Exception):
    """The work was given up before it was complete."""


class MadeShard(NamedTuple):
    """A shard as it is written."""

    shard: Shard
    files: Files
    record: dict[str, Any]
    """What is known about the shard, as JSON has it."""


def made(job: Job, shard: Shard, pool: MapPool, check: Callable[[], None] = lambda: None) -> MadeShard:
    """Makes a shard.

    Args:
        job: The job.
        shard: The shard.
        pool: Maps that are in memory.
        check: Called many times a second. An exception of it ends the work.

    Raises:
        OSError: A map cannot be read.
        ValueError: A map has changed, or a scene is not possible.
    """
    from .formats import format_of

    arrays, maps = job.make(shard, pool, check)
    digests = digests_of(arrays)
    check()
    record = {
        "split": shard.split,
        "first": shard.first,
        "count": shard.count,
        "seed": f"{job.plan.seed}/{shard.split}/{shard.first // job.plan.scans_per_scene}",
        "maps": {f"{index}": digest for index, digest in sorted(maps.items())},
        "blake3": digests,
    }
    return MadeShard(shard, format_of(job.plan.format).shard_files(job.plan, shard, arrays), record)


def make_on_threads(
    job: Job, shards: Sequence[Shard], write: Callable[[MadeShard], None], threads: int | None
) -> Generator[Shard, None, None]:
    """Makes shards on threads of this process, and yields each when it is written.

    As many shards are made at a time as there are threads. As many others may wait for the disk; while it is slower, no new
    one is begun. So memory does not grow with the number of shards.

    Args:
        job: The job.
        shards: The shards to make.
        write: Writes a shard; called on several threads.
        threads: Number of threads; None means one per core.
    """
    count = threads or os.cpu_count() or 1
    pool, stop, casting = MapPool(), threading.Event(), threading.Semaphore(count)

    def check() -> None:
        if stop.is_set():
            raise Stopped

    def work(shard: Shard) -> Shard:
        with casting:
            result = made(job, shard, pool, check)
        write(result)
        return shard

    waiting = iter(shards)
    with ThreadPoolExecutor(2 * count, thread_name_prefix="dataset") as executor:
        running: set[Future[Shard]] = set()
        try:
            while True:
                while len(running) < 2 * count and (shard := next(waiting, None)):
                    running.add(executor.submit(work, shard))
                if not running:
                    return
                done, running = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        finally:
            # Also after an error, Ctrl-C, or when the caller does not go on.
            stop.set()
            executor.shutdown(wait=True, cancel_futures=True)
