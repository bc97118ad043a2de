"""What every test shares: the robots, a random generator, and a matplotlib that needs no screen."""

import gc
import os
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("MPLBACKEND", "Agg")
# Kernels written for a robot are compiled for that robot alone, 10 s a kind of target. What is not about them uses the
# data-driven instance of the same engine, which serves all robots; `tests/kernels/test_lm.py` compares the two.
os.environ.setdefault("IKDE_KERNELS", "tables")
os.environ.setdefault("IKDE_COMPILE", "wait")  # tests are about what is compiled; a few say otherwise

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

import ikde
from tests import ahead
from tests.substitutes import substituted

ROBOTS = ("panda", "qiao2021", "qiao2021_dh", "ur5")
"""Robots whose files were written by hand; what is imported and ships is tried by tests/test_shipped_imports.py."""
BY_HAND = (*ROBOTS, "leobot", "ur5e_mecanum")
"""All of them: two more are tried where that costs little, since every robot has kernels of its own."""
TESTS = Path(__file__).parent
WORKERS = 2
LATE = {
    "kernels": 1,
    **dict.fromkeys(("batch", "bench", "cli", "paper", "report", "solver", "track"), 2),
    **dict.fromkeys(("test_batch_file.py", "test_docs.py", "test_regrade.py", "test_track_file.py"), 2),
    **dict.fromkeys(("test_api.py", "test_arguments.py", "test_collision_model.py", "test_fuzz_files.py"), 2),
    **dict.fromkeys(("test_pack_world.py", "test_shelves.py", "test_tools.py"), 2),
}
LEFT_OUT = pytest.StashKey[int]()

# The same examples in every run, however slow the machine: a test that fails is wrong, not unlucky.
settings.register_profile("ikde", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("ikde")


@pytest.fixture(scope="session")
def qiao():
    """The 9-DoF robot of the paper."""
    return ikde.load_robot("qiao2021")


@pytest.fixture(scope="session")
def unwheeled(qiao):
    """The same robot, but without the geometry of its wheels."""
    return replace(qiao, wheels=None)


@pytest.fixture(params=ROBOTS)
def any_robot(request):
    """Every robot whose file was written by hand."""
    return ikde.load_robot(request.param)


@pytest.fixture
def rng():
    """Random numbers, the same in every run."""
    return np.random.default_rng(20211)


@pytest.fixture
def substitute():
    """Put a function in the place of one of ikde's, wherever it was imported to, until the test ends."""
    with ExitStack() as stack:
        yield lambda function, other: stack.enter_context(substituted(function, other))


def random_q(robot, rng, count=None):
    """Uniform joint values inside the limits, within a turn where there are none, [N] or [count, N]."""
    size = len(robot.joints) if count is None else (count, len(robot.joints))
    return rng.uniform(*robot.drawn, size)


def is_whole(config):
    """Whether all tests are run, but the slow ones."""
    chosen = [Path(config.invocation_params.dir, arg) for arg in config.args]
    return (
        any(Path(__file__).is_relative_to(path.resolve()) for path in chosen)
        and config.option.markexpr == "not slow"
        and not config.option.keyword
        and not config.option.collectonly
    )


def is_worker(config):
    """Whether this process runs the tests that another hands out."""
    return hasattr(config, "workerinput")


def pytest_xdist_auto_num_workers(config):
    """A process a core for all tests; for some, starting a second one takes longer than it saves."""
    return WORKERS if is_whole(config) else 0


def pytest_sessionstart(session):
    """Compile, which takes minutes, once and first: all others wait for it in the end."""
    if is_worker(session.config):
        os.nice(5)
    elif is_whole(session.config):
        ahead.begin()


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Nobody looks for garbage among thousands of tests, now or later: that took a third of the time of small ones."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items):
    """First what needs no kernels, then what compiles its own; last what needs what `ahead` compiles meanwhile."""
    items.sort(key=lambda item: max(LATE.get(part, 0) for part in item.path.relative_to(TESTS).parts))


def pytest_deselected(items):
    """Count the slow tests that are left out."""
    stash = items[0].config.stash
    stash[LEFT_OUT] = stash.get(LEFT_OUT, 0) + sum(item.get_closest_marker("slow") is not None for item in items)


def pytest_sessionfinish(session):
    """Also after Ctrl-C or a failure."""
    ahead.stop()
    if is_worker(session.config):
        session.config.workeroutput["left_out"] = session.config.stash.get(LEFT_OUT, 0)


def pytest_testnodedown(node):
    """All workers leave out the same."""
    node.config.stash[LEFT_OUT] = getattr(node, "workeroutput", {}).get("left_out", 0)


def pytest_terminal_summary(terminalreporter, config):
    """Say at the end what was left out and how to run it."""
    left_out = config.stash.get(LEFT_OUT, 0)
    if left_out and config.option.markexpr == "not slow":
        terminalreporter.write_line(f"left out: {left_out} tests, the slow ones; `python -m pytest -m slow` runs them")
