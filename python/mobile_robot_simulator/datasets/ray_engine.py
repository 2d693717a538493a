"""Ray engine: makes shards on a Ray cluster. The workers make them, and this process writes them."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from functools import cache
from typing import Any

from .engines import MadeShard, made
from .formats import format_of
from .job import Job, Shard, versions_of
from .map_pool import MapPool

__all__ = ["make_on_ray"]

RETRIES = 20
"""Number of times that a shard is made again because its worker died."""

_POLL = 0.1
"""Longest time without a look at whether to end [s]."""


def make_on_ray(
    job: Job, shards: Sequence[Shard], write: Callable[[MadeShard], None], address: str | None
) -> Generator[Shard, None, None]:
    """Makes shards on a Ray cluster, and yields each when it is written.

    Each shard is a task with one CPU. Twice as many tasks wait or run as there are CPUs, so memory does not grow with the
    number of shards. If a worker or its node dies, Ray makes its shards elsewhere. The workers need this package in the same
    version, and map files at the same paths.

    After an error, tasks that wait or run are not cancelled, because Ray can end this process if a task finishes while it is
    cancelled. They end with the connection if this call has made it. Otherwise, they finish, and their shards are dropped.

    Args:
        job: The job.
        shards: The shards to make.
        write: Writes a shard.
        address: Address of the cluster, as for `ray.init`. None starts one on this machine for the time of the call, unless
            this process is connected to one.

    Raises:
        ImportError: Ray is not installed.
        ConnectionError: There is no cluster at the address.
    """
    try:
        import ray
    except ImportError as error:
        raise ImportError(f"the engine ray needs pip install 'mobile-robot-simulator[ray]': {error}") from error
    is_own = not ray.is_initialized()
    if is_own:
        ray.init(address=address, log_to_driver=False, **({} if address else {"include_dashboard": False}))
    try:
        task = ray.remote(num_cpus=1, max_retries=RETRIES)(_make)
        shared, waiting = ray.put(job), iter(shards)
        running: dict[Any, Shard] = {}
        while True:
            limit = 2 * max(1, int(ray.cluster_resources().get("CPU", 1)))
            while len(running) < limit and (shard := next(waiting, None)):
                running[task.remote(shared, shard)] = shard
            if not running:
                return
            done, _ = ray.wait(list(running), num_returns=1, timeout=_POLL)
            for result in done:
                try:
                    write(ray.get(result))
                except ray.exceptions.RayTaskError as error:
                    raise error.cause from None
                yield running.pop(result)
    finally:
        if is_own:
            ray.shutdown()


@cache
def _pool() -> MapPool:
    """Returns the maps of this worker, which stay for its next shard."""
    return MapPool()


def _make(job: Job, shard: Shard) -> MadeShard:
    """Makes a shard on a worker."""
    own = versions_of(format_of(job.plan.format).versions())
    if own != job.versions:
        raise ValueError(f"the workers must have the versions {dict(job.versions)}, got {own}")
    return made(job, shard, _pool())
