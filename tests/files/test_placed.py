"""Paths of errors grow from the inside to the outside."""

import pytest

from ikde.errors import FileError, InputError
from ikde.files.placed import placed


def test_each_level_adds_its_keys():
    with pytest.raises(InputError) as caught, placed("targets", "inline"), placed(3):
        raise InputError("wrong", ("position",))
    assert str(caught.value) == "targets.inline[3].position: wrong"


def test_an_error_of_another_file_stays_as_it_is():
    with pytest.raises(FileError) as caught, placed("targets"):
        raise FileError("points.csv", "row 2: wrong")
    assert str(caught.value) == "points.csv: row 2: wrong"
