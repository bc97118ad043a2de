"""What the tests of the paper's tables share."""

import json

import pytest

import ikde
from ikde.io.published import load_published


@pytest.fixture(scope="session")
def published():
    """The printed numbers."""
    return load_published()


@pytest.fixture(scope="session")
def classical():
    """The Denavit-Hartenberg model of the same arm."""
    return ikde.load_robot("qiao2021_dh")


def is_plain(section):
    """Whether a section has its three parts, and is JSON without NaN or infinity that reads back as it was."""
    text = json.dumps(section, allow_nan=False)
    return set(section) == {"exact", "measured", "settings"} and json.loads(text) == section
