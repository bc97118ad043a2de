"""A run from start to end, stopped in between, and in the way of trouble."""

import resource
import shutil

import pytest

import ikde
from ikde.batch.run import Progress
from ikde.batch.sources import ListSource
from ikde.batch.task import solve_task
from ikde.errors import FileError, InputError
from tests.batch.small import BLINK, FAR, ROBOT, make_arm, make_batch, make_targets, read_files
from tests.substitutes import never

ARMS = (make_arm("free", detector="none", **BLINK), make_arm("careful", **BLINK))


@pytest.fixture(scope="module")
def batch():
    return make_batch(arms=ARMS, graders=(ROBOT.detectors["typical"],))


@pytest.fixture(scope="module")
def whole(batch, tmp_path_factory):
    """The parts of a run that nobody disturbed."""
    folder = tmp_path_factory.mktemp("whole")
    ikde.run_batch(batch, folder, threads=1)
    return read_files(folder)


def stop_after(parts, error=KeyboardInterrupt):
    def tell(now):
        if now.parts_done == parts:
            raise error

    return tell


def test_a_run_is_cut_into_parts(whole):
    assert list(whole) == [f"{arm}-0000{k}.parquet" for arm in ("careful", "free") for k in range(5)]


def test_two_threads_give_the_same_bytes(batch, whole, tmp_path):
    ikde.run_batch(batch, tmp_path, threads=2)
    assert read_files(tmp_path) == whole


def test_a_run_that_was_stopped_goes_on(batch, whole, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        ikde.run_batch(batch, tmp_path, progress=stop_after(3))
    finished = {path: path.stat().st_mtime_ns for path in (tmp_path / "solutions").iterdir()}
    assert len(finished) == 3
    told = []
    ikde.run_batch(batch, tmp_path, progress=told.append)
    assert read_files(tmp_path) == whole
    assert {path: path.stat().st_mtime_ns for path in finished} == finished  # nothing was done twice
    assert told[0] == Progress(parts_done=3, parts=10, solves_done=15, solves=48, parts_found=3)
    assert told[-1] == Progress(parts_done=10, parts=10, solves_done=48, solves=48, parts_found=3)


@pytest.mark.parametrize("kind", ["solutions", "timing"])
def test_a_damaged_part_is_done_again(batch, whole, tmp_path, kind):
    ikde.run_batch(batch, tmp_path)
    part = tmp_path / kind / "free-00002.parquet"
    part.write_bytes(part.read_bytes()[:-20])
    told = []
    ikde.run_batch(batch, tmp_path, progress=told.append)
    assert told[0].parts_found == 9
    assert read_files(tmp_path) == whole
    assert len(ikde.read_batch(tmp_path, timing=True)) == 48


@pytest.mark.parametrize("share", [0.05, 0.2, 0.4, 0.6, 0.8, 0.95])
def test_a_part_with_a_flipped_bit_is_done_again(batch, whole, tmp_path, share):
    ikde.run_batch(batch, tmp_path)
    part = tmp_path / "solutions" / "free-00002.parquet"
    data = bytearray(part.read_bytes())
    data[int(share * len(data))] ^= 1
    part.write_bytes(data)
    told = []
    ikde.run_batch(batch, tmp_path, progress=told.append)
    assert told[0].parts_found == 9
    assert read_files(tmp_path) == whole


def test_a_finished_run_has_nothing_to_do(batch, tmp_path, substitute):
    first = ikde.run_batch(batch, tmp_path)
    substitute(solve_task, never)
    assert ikde.run_batch(batch, tmp_path) == first


def test_another_batch_is_refused_and_overwrites_if_told_to(batch, tmp_path):
    ikde.run_batch(batch, tmp_path)
    other = make_batch(seed=8, chunk=30)
    with pytest.raises(FileError, match=r"holds another run \(--overwrite replaces it\): seed: 7 there, 8 now"):
        ikde.run_batch(other, tmp_path)
    ikde.run_batch(other, tmp_path, overwrite=True)
    assert list(read_files(tmp_path)) == list(read_files(tmp_path, "timing")) == ["auto-00000.parquet"]


def test_a_full_disk_leaves_finished_parts_and_says_how_to_go_on(batch, whole, tmp_path):
    before = resource.getrlimit(resource.RLIMIT_FSIZE)

    def fill_disk(now):
        if now.parts_done == 2:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))

    try:
        with pytest.raises(FileError) as caught:
            ikde.run_batch(batch, tmp_path, progress=fill_disk)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    part = tmp_path / "timing" / "free-00002.parquet"
    advice = "finished parts are intact; run the same command again to resume"
    assert str(caught.value) == f"{part}: cannot be written: File too large; {advice}"
    assert len(read_files(tmp_path)) == len(read_files(tmp_path, "timing")) == 2
    ikde.run_batch(batch, tmp_path)
    assert read_files(tmp_path) == whole


def test_a_folder_that_vanishes_is_an_error_in_one_line(batch, tmp_path):
    folder = tmp_path / "run"
    with pytest.raises(FileError, match=r"free-00001.parquet: cannot be written: No such file"):
        ikde.run_batch(batch, folder, progress=lambda now: now.parts_done == 1 and shutil.rmtree(folder))


def test_an_input_that_vanishes_leaves_finished_parts(batch, tmp_path):
    class Vanishing(ListSource):
        def read(self, first, last):
            if first > 4:
                raise FileError("targets.csv", "is gone")
            return super().read(first, last)

    source = Vanishing(targets=make_targets(12))
    with pytest.raises(FileError, match=r"targets.csv: is gone"):
        ikde.run_batch(make_batch(source=source), tmp_path)
    assert len(ikde.read_batch(tmp_path)) == 10


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"threads": 0}, "threads: expected a whole number of at least 1, got 0"),
        ({"workers": -1}, "workers: expected a whole number of at least 1, got -1"),
        ({"workers": 2}, "workers: the number of workers"),
        ({"workers": 2, "dask": "tcp://a:1"}, "workers: the number of workers"),
        ({"threads": 2, "dask": "local"}, "threads: workers of a cluster use one thread each"),
    ],
)
def test_options_that_contradict_each_other_are_refused(batch, tmp_path, options, words):
    with pytest.raises(InputError, match=words):
        ikde.run_batch(batch, tmp_path / "run", **options)
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize("batch", ["x.yaml", {"robot": "qiao2021"}, None])
def test_what_is_no_batch_is_refused(batch, tmp_path):
    with pytest.raises(InputError, match=r"expected a Batch; ikde.load_batch reads files and mappings"):
        ikde.run_batch(batch, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_of_a_thousand_targets_the_ten_unreachable_are_named_with_their_reasons(tmp_path):
    blocked = [ikde.Target(FAR) if k % 100 == 50 else target for k, target in enumerate(make_targets(1000))]
    loose = make_arm(position_tolerance_m=0.05)
    source = ListSource(targets=blocked, names=tuple(f"t{k}" for k in range(1000)))
    summary = ikde.run_batch(make_batch(arms=(loose,), source=source, repeats=1, chunk=200, explain=True), tmp_path)
    assert summary.unreached == 10
    assert [(row.target, row.name) for row in summary.arms[0].listed] == [(k, f"t{k}") for k in range(50, 1000, 100)]
    assert all(row.reason.startswith("out of reach: at least") for row in summary.arms[0].listed)
