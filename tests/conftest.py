"""What every test shares: the robots, a random generator, and a matplotlib that needs no screen."""

import os
from dataclasses import replace

os.environ.setdefault("MPLBACKEND", "Agg")
# Kernels written for a robot are compiled for that robot alone, 10 s a kind of target. What is not about them uses the
# data-driven instance of the same engine, which serves all robots; `tests/kernels/test_lm.py` compares the two.
os.environ.setdefault("IKDE_KERNELS", "tables")

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

import ikde
from tests import ahead

ROBOTS = ikde.robot_names()

# The same examples in every run, however slow the machine: a test that fails is wrong, not unlucky.
settings.register_profile("ikde", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("ikde")


@pytest.fixture(scope="session")
def qiao():
    """The 9-DoF robot of the paper."""
    return ikde.load_robot("qiao2021")


@pytest.fixture(scope="session")
def unwheeled(qiao):
    """The same robot, but nobody told of its wheels."""
    return replace(qiao, wheels=None)


@pytest.fixture(params=ROBOTS)
def any_robot(request):
    """Every robot that ships."""
    return ikde.load_robot(request.param)


@pytest.fixture
def rng():
    """Random numbers, the same in every run."""
    return np.random.default_rng(20211)


def random_q(robot, rng, count=None):
    """Uniform joint values inside the limits, [N] or [count, N]."""
    size = len(robot.joints) if count is None else (count, len(robot.joints))
    return rng.uniform(robot.lower, robot.upper, size)


def pytest_collection_finish(session):
    """Begin what takes minutes."""
    if not session.config.option.collectonly:
        ahead.begin([item.nodeid for item in session.items])


def pytest_sessionfinish():
    """Also after Ctrl-C or a failure."""
    ahead.stop()


def pytest_terminal_summary(terminalreporter):
    """Say at the end what was left out and how to run it."""
    left_out = len(terminalreporter.stats.get("deselected", []))
    if left_out and terminalreporter.config.option.markexpr == "not slow":
        terminalreporter.write_line(f"left out: {left_out} tests, the slow ones; `python -m pytest -m slow` runs them")
