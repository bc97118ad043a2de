"""What a caller may say about where a run is solved."""

import re

from ikde.errors import InputError

LOCAL = "local"
ADDRESS = re.compile(r"((tcp|tls|ws|wss|ucx)://)?[^/\s]+:\d+")


def check_options(threads: int | None, dask: str | None, workers: int | None) -> None:
    """Refuse options that make no sense, alone or together; raises `InputError`."""
    for name, value in (("threads", threads), ("workers", workers)):
        if value is not None and value < 1:
            raise InputError(f"expected a whole number of at least 1, got {value}", (name,))
    if dask is not None:
        check_address(dask)
    if workers is not None and dask != LOCAL:
        raise InputError("the number of workers can be set for a local cluster only (dask local)", ("workers",))
    if threads is not None and dask is not None:
        raise InputError("workers of a cluster use one thread each; set workers instead", ("threads",))


def check_address(dask: str) -> None:
    """Refuse what can be no address of a cluster; raises `InputError`."""
    if dask != LOCAL and not ADDRESS.fullmatch(dask):
        raise InputError(f"expected {LOCAL!r} or an address such as tcp://10.0.0.5:8786, got {dask!r}", ("dask",))
