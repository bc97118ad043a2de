"""YAML that every reader takes for the same."""

import pytest
import yaml

from ikde.io.yaml_text import format_block, format_flow

DATA = {
    "a name": {"on": [1e-05, 2.0, -0.0, 1e22, True], "deep": {"text": 'a "b" : c', "y": "no", "none": {}}},
    "balls": [{"center": [0.1, 0.0, 3e-17], "radius": 0.05}],
    "empty": [],
    "word": "base_link",
    "é 🙂": "naïve: 🙂",
}


@pytest.mark.parametrize("loader", [yaml.SafeLoader, yaml.CSafeLoader])
def test_other_readers_read_the_same(loader):
    assert yaml.load(format_flow({"a": [1e-05, 1.5e-07, 0.1], "b": "true"}), loader) == {
        "a": [1e-05, 1.5e-07, 0.1],
        "b": "true",
    }
    assert yaml.load("\n".join(format_block(DATA)), loader) == DATA


def test_a_list_of_mappings_stands_below_its_key_a_line_each():
    assert list(format_block({"link": [{"radius": 1.0}, {"radius": 0.5}]})) == [
        "link:",
        "  - {radius: 1}",
        "  - {radius: 0.5}",
    ]
