"""Options alone and together."""

import pytest

from ikde.batch.options import check_address, check_options
from ikde.errors import InputError


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((0, None, None), "threads: expected a whole number of at least 1, got 0"),
        ((None, "local", 0), "workers: expected a whole number of at least 1, got 0"),
        ((None, None, 2), "workers: the number of workers"),
        ((2, "local", None), "threads: workers of a cluster use one thread each"),
        ((None, "nowhere", None), "dask: expected 'local' or an address"),
    ],
)
def test_what_makes_no_sense_is_refused(options, words):
    with pytest.raises(InputError, match=words):
        check_options(*options)


@pytest.mark.parametrize("options", [(None, None, None), (2, None, None), (None, "local", 2), (None, "a:1", None)])
def test_what_makes_sense_is_let_through(options):
    check_options(*options)


@pytest.mark.parametrize("address", ["local", "tcp://10.0.0.5:8786", "tls://a.b:1", "localhost:8786"])
def test_an_address_is_let_through(address):
    check_address(address)
