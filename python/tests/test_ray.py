"""Sweeps on a Ray cluster; asked for by TOPRISE_RAY=1, because Ray is large."""

import os
import signal
import subprocess
import sys
import time

import pytest

import toprise

if "TOPRISE_RAY" not in os.environ:
    pytest.skip("TOPRISE_RAY is not set", allow_module_level=True)

import ray
from ray.cluster_utils import Cluster

SPEC = {
    "set": {"stop.duration": 0.2},
    "over": {"friction.k": "0.01..0.1/60log", "initial.psi_dot": "100..159/100"},
}


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    """The bytes of a sweep that was computed here."""
    out = tmp_path_factory.mktemp("local") / "map.parquet"
    toprise.sweep(SPEC, out)
    return out.read_bytes()


@pytest.fixture
def cluster():
    """Two nodes on this machine."""
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    second = cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address)
    yield cluster, second
    ray.shutdown()
    cluster.shutdown()


def test_two_nodes_make_the_bytes_of_one(cluster, local, tmp_path):
    from toprise.ray import sweep

    out = tmp_path / "map.parquet"
    answer = sweep(SPEC, out)
    assert answer["stops"] == {"duration": 6000} and out.read_bytes() == local
    assert (answer["computed"], answer["kept"], answer["errors"]) == (6000, 0, 0)
    # It is there: nothing is left to do.
    again = sweep(SPEC, out)
    assert (again["computed"], again["kept"]) == (0, 6000)


def test_a_node_may_die(cluster, local, tmp_path):
    from threading import Timer

    from toprise.ray import sweep

    nodes, second = cluster
    out = tmp_path / "map.parquet"
    death = Timer(3.0, lambda: nodes.remove_node(second, allow_graceful=False))
    death.start()
    sweep(SPEC, out)
    death.join()
    assert out.read_bytes() == local


def test_a_worker_may_die(cluster, local, tmp_path):
    from threading import Timer

    from toprise.ray import sweep

    killed = []

    def kill():
        """Kills the first worker that computes a part."""
        listed = subprocess.run(["ps", "-eo", "pid,args"], capture_output=True, text=True).stdout
        for line in listed.splitlines():
            pid, _, command = line.strip().partition(" ")
            if "ray::" in command and "compute" in command:
                os.kill(int(pid), signal.SIGKILL)
                killed.append(pid)
                return

    out = tmp_path / "map.parquet"
    death = Timer(3.0, kill)
    death.start()
    sweep(SPEC, out)
    death.join()
    assert killed and out.read_bytes() == local


def test_a_driver_may_die(local, tmp_path):
    out = tmp_path / "map.parquet"
    program = f"import toprise.ray\ntoprise.ray.sweep({SPEC!r}, {str(out)!r})"
    driver = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.DEVNULL)
    parts = tmp_path / "map.parquet.parts"
    deadline = time.monotonic() + 120
    while not list(parts.glob("*.parquet")):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    driver.kill()
    driver.wait()
    assert not out.exists()
    subprocess.run([sys.executable, "-c", program], check=True, stderr=subprocess.DEVNULL)
    assert out.read_bytes() == local
