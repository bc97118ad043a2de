"""Numbers in words stay true: rounded to the safe side, with the digits that a reader needs."""

import numpy as np
import pytest

from ikde.solver.digits import at_least, round_up


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.2226, "0.222"), (127277.1549, "127277.154"), (0.00041299, "0.000412"), (3.1999e-9, "3.19e-09"), (1.0, "1.000")],
)
def test_at_least_is_rounded_down(value, text):
    assert at_least(value) == text


def test_no_number_is_rounded_to_the_wrong_side(rng):
    for value in np.exp(rng.uniform(-30.0, 12.0, 2000)).tolist():
        assert 0.98 * value <= float(at_least(value)) <= value
        assert value <= round_up(value) <= 1.1 * value
        assert float(f"{round_up(value):.2g}") == round_up(value)
