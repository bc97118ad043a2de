"""Paths made from parts of a track file."""

import pytest

from ikde.errors import InputError
from ikde.track.make_path import make_path
from ikde.track.spec import TrackSpec

MM_DEG = {"length": "mm", "angle": "deg"}
LINE = {"expressions": {"x": "500 + 1000*k/N", "y": 0, "z": "900"}}


@pytest.fixture
def make(tmp_path):
    def call(path=LINE, **keys):
        data = {"robot": "qiao2021", "units": MM_DEG, "dt_s": 0.1, "samples": 10, "path": path, **keys}
        spec = TrackSpec.model_validate({key: value for key, value in data.items() if value is not None})
        return make_path(spec, "mine", tmp_path)

    return call


@pytest.fixture
def complaint(make, tmp_path):
    def call(path=LINE, **keys):
        with pytest.raises(InputError) as caught:
            make(path, **keys)
        assert "\n" not in str(caught.value)
        return str(caught.value).replace(f"{tmp_path}/", "")

    return call
