"""The track file's model: every key is explained, and stands in the documentation."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from ikde.formats.entries import Entry
from ikde.track.spec import TRACK_METHODS, TrackSpec

DOCUMENTATION = (Path(__file__).parents[2] / "docs" / "track.md").read_text(encoding="utf-8")
LEAST = {"robot": "qiao2021", "dt_s": 0.1, "path": {"waypoints": [{"position": [1, 0, 1]}, {"position": [1, 1, 1]}]}}


def entries(model=Entry):
    """Every part of a track file."""
    own = [model] if model.__module__ in ("ikde.formats.entries", "ikde.track.spec") else []
    return [*own, *(found for child in model.__subclasses__() for found in entries(child))]


def test_the_least_track_file_has_defaults():
    spec = TrackSpec.model_validate(LEAST)
    assert (spec.drive, spec.method, spec.orientation, spec.seed) == (None, TRACK_METHODS[0], None, 0)
    assert (spec.limits.speed, spec.ranges, spec.start, spec.samples) == ({}, {}, None, None)


@pytest.mark.parametrize("model", entries(), ids=lambda model: model.__name__)
def test_every_key_is_explained(model):
    assert model.__doc__
    assert [name for name, field in model.model_fields.items() if not field.description] == []


@pytest.mark.parametrize("model", entries(), ids=lambda model: model.__name__)
def test_every_key_is_in_the_documentation(model):
    keys = [field.alias or name for name, field in model.model_fields.items()]
    assert [key for key in keys if f"`{key}`" not in DOCUMENTATION] == []


@pytest.mark.parametrize("change", [{"method": "ga"}, {"drive": "tank"}, {"dt_s": 0}, {"orientation": "fre"}, {"x": 1}])
def test_what_does_not_fit_is_refused(change):
    with pytest.raises(ValidationError):
        TrackSpec.model_validate({**LEAST, **change})
