"""The run file's model: it knows every setting of a search and explains every key."""

import re
from dataclasses import fields
from pathlib import Path

import pytest
import yaml
from pydantic import ValidationError

from ikde.batch.spec import COLUMN_GROUPS, BatchSpec, DeEntry, SettingsEntry, TargetsEntry
from ikde.formats.entries import Entry
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.solver.settings import DeSettings, SolveSettings

DOCUMENTATION = (Path(__file__).parents[2] / "docs" / "batch.md").read_text(encoding="utf-8")
LEAST = {"robot": "qiao2021", "targets": {"inline": [{"position": [1, 2, 3]}]}}


def entries(model=Entry):
    """Every part of a run file."""
    own = [model] if model.__module__ in ("ikde.formats.entries", "ikde.batch.spec") else []
    return [*own, *(found for child in model.__subclasses__() for found in entries(child))]


def test_the_least_run_file_has_defaults():
    spec = BatchSpec.model_validate(LEAST)
    assert (spec.repeats, spec.chunk, spec.seed, spec.explain) == (1, None, 0, True)
    assert tuple(spec.output.columns) == COLUMN_GROUPS
    assert spec.solve.method == "auto"


def test_every_setting_of_a_search_can_be_written():
    written = {field.name.removesuffix("_m").removesuffix("_rad") for field in fields(SolveSettings)}
    assert {"method", *SettingsEntry.model_fields} == written  # the method stands beside the settings
    assert set(DeEntry.model_fields) == {field.name for field in fields(DeSettings)}


def test_editors_are_told_the_choices():
    properties = DeEntry.model_json_schema()["properties"]
    assert tuple(properties["strategy"]["enum"][:-1]) == STRATEGIES
    assert tuple(properties["bounds"]["enum"][:-1]) == REPAIRS


@pytest.mark.parametrize("model", entries(), ids=lambda model: model.__name__)
def test_every_key_is_explained(model):
    assert model.__doc__
    assert [name for name, field in model.model_fields.items() if not field.description] == []


@pytest.mark.parametrize("model", entries(), ids=lambda model: model.__name__)
def test_every_key_is_in_the_documentation(model):
    keys = [field.alias or name for name, field in model.model_fields.items()]
    assert [key for key in keys if f"`{key}`" not in DOCUMENTATION] == []


def test_the_examples_of_the_documentation_are_run_files():
    example, *files = re.findall(r"```yaml\n(.*?)```", DOCUMENTATION, flags=re.DOTALL)
    assert BatchSpec.model_validate(yaml.safe_load(example)).repeats == 100
    for line in files[0].splitlines():
        assert TargetsEntry.model_validate(yaml.safe_load(line)).file


@pytest.mark.parametrize("key", ["reapeats", "Robot"])
def test_unknown_keys_are_errors(key):
    with pytest.raises(ValidationError, match="extra_forbidden"):
        BatchSpec.model_validate({**LEAST, key: 1})
