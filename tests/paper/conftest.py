"""One tiny report for all sections, and what it is computed from."""

from contextlib import ExitStack

import pytest
from matplotlib.figure import Figure

from ikde.paper.inputs import load_inputs, load_published
from ikde.plot.pose import plot_pose
from ikde.plot.surfaces import plot_surface
from tests.substitutes import substituted
from tests.tiny_paper import TINY, compute_tiny


@pytest.fixture(scope="session")
def published():
    """The printed numbers."""
    return load_published()


@pytest.fixture(scope="session")
def inputs():
    """What the tiny report is computed from."""
    return load_inputs(TINY)


@pytest.fixture(scope="session")
def results():
    """The tiny report."""
    return compute_tiny()[0]


@pytest.fixture(autouse=True, scope="package")
def _blank_pictures():
    """Drawing a robot takes half a second; test_section.py does it. A surface takes as long: tests/plot."""
    with ExitStack() as stack:
        for plot in (plot_pose, plot_surface):
            stack.enter_context(substituted(plot, lambda *_, **__: Figure(figsize=(1, 1))))
        yield


def is_plain(section):
    """Whether a section has its three parts, and is JSON without NaN or infinity."""
    return set(section.as_json()) == {"exact", "measured", "settings"}
