"""What is made of an array is made once, and goes with it."""

import gc

import numpy as np

from ikde.model.per_array import PerArray


def test_it_is_made_once_as_long_as_the_array_is_there():
    made = []
    sizes = PerArray(lambda array: made.append(array.size) or array.size)
    kept, other = np.zeros(3), np.zeros(3)
    for array in (kept, other):
        array.setflags(write=False)
    assert [sizes.find(array) for array in (kept, kept, other, kept)] == [3, 3, 3, 3]
    assert made == [3, 3]
    assert len(sizes) == 2
    del kept, array
    gc.collect()
    assert len(sizes) == 1
    sizes.clear()
    assert sizes.find(other) == 3
    assert made == [3, 3, 3]


def test_of_what_may_be_written_to_it_is_made_anew():
    sums, array = PerArray(lambda array: float(array.sum())), np.zeros(3)
    assert sums.find(array) == 0.0
    array[1] = 2.0
    assert sums.find(array) == 2.0
    assert not len(sums)
