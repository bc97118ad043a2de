"""One tiny report for all sections."""

import pytest
from matplotlib.figure import Figure

from ikde.plot.pose import plot_pose
from tests.substitutes import substituted
from tests.tiny_paper import compute_tiny, load_sources


@pytest.fixture(scope="session")
def results():
    """What `compute_paper` gives."""
    return compute_tiny()[0]


@pytest.fixture(scope="session")
def robots():
    """Both models."""
    sources = load_sources()
    return {"key_point": sources.key_point, "classical": sources.classical}


@pytest.fixture(autouse=True, scope="package")
def _blank_pictures():
    """Drawing a robot takes half a second; tests/report/paper/test_pictures.py does it."""
    with substituted(plot_pose, lambda *_, **__: Figure(figsize=(1, 1))):
        yield
