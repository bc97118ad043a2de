"""`kill -9` at random moments: the same command goes on, and the answers are those of a run that nobody killed."""

import random
import subprocess
import sys
import time

import pytest

import ikde
from tests.batch.small import read_files

SPEC = """
robot: qiao2021
targets: {box: {from: [-1, -1, 0.3], to: [1, 1, 1.2], count: 1200}}
seed: 3
chunk: 5
explain: false
solve: {method: de, settings: {restarts: 1, de: {population: 6, generations: 1}}}
grade: [typical]
"""
PARTS = 240


@pytest.fixture(scope="module")
def spec(tmp_path_factory):
    path = tmp_path_factory.mktemp("spec") / "kills.yaml"
    path.write_text(SPEC)
    return path


@pytest.fixture(scope="module")
def whole(spec, tmp_path_factory):
    """The parts of a run that nobody killed, in this process."""
    folder = tmp_path_factory.mktemp("whole")
    ikde.run_batch(ikde.load_batch(spec), folder)
    return read_files(folder)


def start(spec, folder):
    command = [sys.executable, "-m", "ikde", "batch", str(spec), "--out", str(folder)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def count_parts(folder):
    return len(list(folder.glob("solutions/*.parquet")))


def stamp(folder):
    """Name -> which file it is, and of when."""
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in folder.glob("solutions/*.parquet")}


def kill_at(process, folder, parts, delay):
    """Kill -9 some milliseconds after so many parts are finished."""
    while process.poll() is None and count_parts(folder) < parts:
        time.sleep(0.001)
    time.sleep(delay)
    process.kill()
    process.wait()


@pytest.mark.parametrize("kills", [2, pytest.param(20, marks=pytest.mark.slow)])
def test_a_killed_run_goes_on_to_the_same_bytes(spec, whole, tmp_path, kills):
    dice = random.Random(kills)
    moments = sorted(dice.sample(range(PARTS // 4), kills))  # long before the end, however late we look
    for parts in moments:
        process = start(spec, tmp_path)
        kill_at(process, tmp_path, parts, dice.uniform(0.0, 0.01))
        assert process.returncode == -9
    finished = stamp(tmp_path)
    assert start(spec, tmp_path).wait(timeout=120) == 1
    assert read_files(tmp_path) == whole
    assert len(read_files(tmp_path, "timing")) == PARTS
    assert finished.items() <= stamp(tmp_path).items()  # nothing was done twice
