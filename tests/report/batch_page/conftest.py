"""Two runs, made once: two arms with everything that can be kept, and one arm with nothing of it."""

import shutil

import pytest

import ikde
from ikde.batch.sources import ListSource
from ikde.report.batch_page.answers import gather_answers
from tests.batch.small import BLINK, FAR, ROBOT, make_arm, make_batch
from tests.batch.test_worlds import KEYS, KITCHEN

LOOSE = {"position_tolerance_m": 0.02, "restarts": 3, "generations": 60, "population": 20}
ARMS = (make_arm("free", detector="none", **LOOSE), make_arm("careful", method="de", **LOOSE))
POINTS = [(0.5, 0.2, 0.8), FAR, (0.3, 0.0, 0.5), (0.6, -0.3, 1.0)]
NAMES = ("shelf", "<far|away>", "low", "high")


@pytest.fixture(scope="package")
def folder(tmp_path_factory):
    """Four targets eight times by two arms, graded twice; target 1 is out of reach."""
    folder = tmp_path_factory.mktemp("page") / "run"
    source = ListSource(targets=[ikde.Target(point) for point in POINTS], names=NAMES)
    graders = (ROBOT.detectors["typical"], ROBOT.detectors["improved"])
    ikde.run_batch(make_batch(arms=ARMS, source=source, repeats=8, chunk=6, graders=graders, explain=True), folder)
    return folder


@pytest.fixture(scope="package")
def answers(folder):
    """What the page of that run shows."""
    return gather_answers(folder)


@pytest.fixture(scope="package")
def rows(folder):
    """Its table, a dict a row."""
    return ikde.read_batch(folder).to_pylist()


@pytest.fixture(scope="package")
def bare(tmp_path_factory):
    """Twelve targets once by one arm that finds nothing and keeps nothing."""
    folder = tmp_path_factory.mktemp("page") / "bare"
    ikde.run_batch(make_batch(arms=(make_arm(**BLINK),), columns=(), repeats=1), folder)
    return gather_answers(folder)


@pytest.fixture
def unfinished(folder, tmp_path):
    """The first run, of which the second arm has not begun."""
    copy = shutil.copytree(folder, tmp_path / "stopped")
    for path in (copy / "solutions").glob("careful-*"):
        path.unlink()
    return gather_answers(copy)


@pytest.fixture(scope="package")
def in_worlds(tmp_path_factory):
    """A run of one arm in no world and in one, whose page is made where it ran."""
    folder = tmp_path_factory.mktemp("worlds")
    (folder / "kitchen.yaml").write_text(KITCHEN, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        ikde.run_batch(ikde.load_batch(KEYS | {"worlds": ["none", "kitchen.yaml"]}), "run")
    return folder


@pytest.fixture
def placed(in_worlds, monkeypatch):
    """Answers in two worlds, and the current folder where it ran."""
    monkeypatch.chdir(in_worlds)
    return gather_answers("run")
