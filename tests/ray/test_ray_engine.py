"""ray_engine: a real Ray cluster on this machine gives the bytes of one thread, also when a node is killed."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import ray
from ray.cluster_utils import Cluster

from datasets.small_plans import files_of, small
from mobile_robot_simulator.datasets import Progress, generate

pytestmark = [
    pytest.mark.filterwarnings("ignore::FutureWarning", "ignore::ResourceWarning", "ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning", "ignore::UserWarning"),
]

# Long enough that both nodes work when one of them is killed.
PLAN = small(count=20_000, scans_per_shard=512, scanner={"beam_count": 181, "max_range": 6.0})


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("threads") / "data"
    generate(PLAN, out=out, threads=1)
    return files_of(out)


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    """A cluster with a head that makes no shards, and two nodes with one CPU each."""
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    cluster.workers = [cluster.add_node(num_cpus=1) for _ in range(2)]
    cluster.wait_for_nodes()
    yield cluster
    ray.shutdown()
    cluster.shutdown()


def wait_for_nodes(count: int) -> None:
    """Waits until the cluster has noticed that it has so many nodes, head included, which all but the head bring a CPU."""
    end = time.monotonic() + 120.0
    while sum(node["Alive"] for node in ray.nodes()) != count or ray.cluster_resources().get("CPU") != count - 1:
        assert time.monotonic() < end, ray.nodes()
        time.sleep(0.1)


def test_a_node_is_killed_and_the_same_bytes_come_out(cluster: Cluster, expected: dict[str, bytes], tmp_path: Path) -> None:
    ray.init(address=cluster.address, log_to_driver=False)
    wait_for_nodes(3)
    seen: list[int] = []

    def kill_one(progress: Progress) -> None:
        seen.append(progress.shards)
        if progress.shards == 10:
            cluster.remove_node(cluster.workers[0], allow_graceful=False)

    report = generate(PLAN, out=tmp_path, engine="ray", progress=kill_one)
    assert report.made == report.shards == 41 and seen == [*range(42)]
    wait_for_nodes(2)
    assert files_of(tmp_path) == expected


MAKE = """
import sys
from mobile_robot_simulator.datasets import Plan, generate
plan, out, address = sys.argv[1:]
generate(
    Plan.model_validate_json(plan), out=out, engine="ray", address=address,
    progress=lambda progress: print(progress.shards, flush=True),
)
"""


def test_the_writer_is_killed_and_threads_go_on_to_the_same_bytes(
    cluster: Cluster, expected: dict[str, bytes], tmp_path: Path
) -> None:
    command = [sys.executable, "-W", "ignore", "-c", MAKE, json.dumps(PLAN.content), str(tmp_path), cluster.address]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout
        while int(process.stdout.readline()) < 7:
            pass
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL and not (tmp_path / "zarr.json").exists()
    report = generate(PLAN, out=tmp_path)
    assert 0 < report.made <= 34 and files_of(tmp_path) == expected


def test_an_error_of_a_worker_is_an_error_here(cluster: Cluster, tmp_path: Path) -> None:
    ray.init(address=cluster.address, log_to_driver=False)
    with pytest.raises(ValueError, match=r"maze \d, 10 x 8 m.*, scene \d+ of train: "):
        generate(small(poses={"clearance": 5.0}), out=tmp_path, engine="ray")


def test_without_an_address_a_cluster_starts_here(tmp_path: Path) -> None:
    plan = small()
    generate(plan, out=tmp_path / "threads")
    generate(plan, out=tmp_path / "ray", engine="ray")
    assert files_of(tmp_path / "ray") == files_of(tmp_path / "threads") and not ray.is_initialized()
