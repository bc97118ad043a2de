"""Parts solved by a real Dask cluster of two processes, one of which gets killed."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import dask.config
import distributed
import pytest
from distributed import LocalCluster

import ikde
from ikde.batch import cluster as module
from ikde.batch.cluster import SILENT, open_cluster, solve_remotely
from ikde.batch.parts import Part
from ikde.batch.task import make_task
from ikde.errors import InputError
from ikde.model.generate.module import describe_kernels
from tests.batch.small import BLINK, ROBOT, make_arm, make_batch, read_files

SLOWLY = """
import time
from ikde.batch import cluster, task
def solve_task(part, threads):
    time.sleep(0.2)
    return task.solve_task(part, threads)
cluster.solve_task = solve_task
"""  # what workers run first: those that are to be killed at work have to be found at it


@pytest.fixture(scope="module")
def batch():
    arms = (make_arm("free", detector="none", population=20, generations=30, restarts=1), make_arm("careful", **BLINK))
    return make_batch(arms=arms, graders=(ROBOT.detectors["typical"],), explain=True)


@pytest.fixture(scope="module")
def whole(batch, tmp_path_factory):
    """The parts of a run in this process, on one thread."""
    folder = tmp_path_factory.mktemp("whole")
    ikde.run_batch(batch, folder, threads=1)
    return read_files(folder)


@pytest.fixture(scope="module")
def cluster():
    """Two workers, and a scheduler that gives up a part as soon as one dies of it."""
    facts = {"threads_per_worker": 1, "dashboard_address": ":0", "memory_limit": None}
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        LocalCluster(2, silence_logs=SILENT, preload=SLOWLY, **facts) as started,
    ):
        yield started


def kill_a_busy_worker(cluster, after):
    """What to tell progress to: after so many parts, a worker process with work is no more."""

    def tell(now):
        if now.parts_done == after:
            busy = next(worker.address for worker in cluster.scheduler.workers.values() if worker.processing)
            os.kill(next(w.pid for w in cluster.workers.values() if w.worker_address == busy), signal.SIGKILL)

    return tell


def test_a_cluster_gives_the_same_bytes(batch, whole, cluster, tmp_path):
    ikde.run_batch(batch, tmp_path, dask=cluster.scheduler_address)
    assert read_files(tmp_path) == whole


def test_a_local_cluster_gives_the_same_bytes_and_says_nothing(batch, whole, tmp_path, capfd):
    ikde.run_batch(batch, tmp_path, dask="local", workers=1)
    assert read_files(tmp_path) == whole
    assert capfd.readouterr() == ("", "")


def test_a_worker_that_dies_is_replaced(batch, whole, cluster, tmp_path, capfd):
    ikde.run_batch(batch, tmp_path, dask=cluster.scheduler_address, progress=kill_a_busy_worker(cluster, 2))
    assert read_files(tmp_path) == whole
    assert capfd.readouterr().err == ""


def test_a_part_that_kills_its_workers_is_given_up(batch, cluster, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "TRIES", 1)
    # Dask blames all parts that the worker held, those that waited there too: which comes back first is chance.
    told = r"workers keep dying of part \d of arm (free|careful).*run the same command again"
    with pytest.raises(InputError, match=told):
        ikde.run_batch(batch, tmp_path, dask=cluster.scheduler_address, progress=kill_a_busy_worker(cluster, 1))


def test_a_scheduler_that_dies_is_one_line(batch, tmp_path):
    told = tmp_path / "scheduler.json"
    options = ["--port", "0", "--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", str(told)]
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", *options]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as scheduler:
        try:
            while not (told.exists() and told.read_text()):
                time.sleep(0.05)
            address = json.loads(told.read_text())["address"]
            with open_cluster(address) as solve:
                answers = solve(make_task(batch, Part("careful", k, 5 * k, 5 * k + 5)) for k in range(4))
                threading.Timer(0.5, scheduler.kill).start()  # no worker: the answers are waited for
                with pytest.raises(InputError, match=r"^dask: the cluster has gone away; finished parts are intact"):
                    next(answers)
        finally:
            scheduler.kill()


@pytest.mark.parametrize("call", ["submit", "nthreads"])
def test_a_connection_that_breaks_is_one_line(batch, cluster, monkeypatch, call):
    def refuse(*arguments, **options):
        raise OSError("Timed out trying to connect\nafter 30 s")

    monkeypatch.setattr(distributed.Client, call, refuse)
    with (
        open_cluster(cluster.scheduler_address) as solve,
        pytest.raises(InputError, match=r"^dask: the cluster has gone away; [^\n]* \(Timed out trying to connect\)$"),
    ):
        next(solve([make_task(batch, Part("careful", 0, 0, 5))]))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"code": "0123456789ab"}, "the workers have another version of ikde"),
        ({"kind": "written"}, "the workers run tables kernels, this run written ones"),
    ],
)
def test_a_worker_with_other_kernels_is_refused(batch, change, words):
    with pytest.raises(InputError, match=words):
        solve_remotely(make_task(batch, Part("careful", 0, 0, 5)), describe_kernels() | change)


@pytest.mark.parametrize("address", ["", "nowhere", "127.0.0.1", "ftp://127.0.0.1:21", "a b:1", "tcp://127.0.0.1:x"])
def test_what_is_no_address_is_refused(address):
    with pytest.raises(InputError, match=r"expected 'local' or an address such as tcp://10.0.0.5:8786"):
        open_cluster(address).__enter__()


def test_a_cluster_that_does_not_answer_is_one_line(monkeypatch, capfd):
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
    monkeypatch.setattr(module, "PATIENCE", "0.5s")
    with pytest.raises(InputError, match=rf"^dask: no cluster answers at tcp://127.0.0.1:{port} \([^\n]*\)$"):
        open_cluster(f"tcp://127.0.0.1:{port}").__enter__()
    assert capfd.readouterr() == ("", "")


def test_without_dask_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"dask: Dask is not installed: pip install 'ikde\[cluster\]'"):
        open_cluster("local").__enter__()


def test_a_cluster_that_cannot_be_reached_leaves_no_folder(batch, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match="Dask is not installed"):
        ikde.run_batch(batch, tmp_path / "run", dask="local")
    assert not (tmp_path / "run").exists()
