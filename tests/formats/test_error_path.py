"""Paths of errors grow from the inside to the outside."""

import pytest

from ikde.errors import FileError, InputError
from ikde.formats.error_path import prefix_errors


def test_each_level_adds_its_keys():
    with pytest.raises(InputError) as caught, prefix_errors("targets", "inline"), prefix_errors(3):
        raise InputError("wrong", ("position",))
    assert str(caught.value) == "targets.inline[3].position: wrong"


def test_an_error_of_another_file_stays_as_it_is():
    with pytest.raises(FileError) as caught, prefix_errors("targets"):
        raise FileError("points.csv", "row 2: wrong")
    assert str(caught.value) == "points.csv: row 2: wrong"
