"""What a benchmark ran on, for the record beside its figures."""

import timeit
from typing import Any

import numpy as np

from ikde.batch.machine import describe_machine, describe_versions


def describe() -> dict[str, Any]:
    """Processor, cores, Python, the versions that matter, and how quick the machine is at this moment."""
    machine, versions = describe_machine(), describe_versions()
    return {
        "cpu": machine["processor"],
        "cores": machine["cores"],
        "avx512": "avx512f" in machine["cpu_flags"],
        "empty_array_us": round(min(timeit.repeat(lambda: np.empty(9), number=20_000, repeat=5)) / 20_000 * 1e6, 3),
        **{name: versions[name] for name in ("python", "ikde", "numpy", "numba")},
    }
