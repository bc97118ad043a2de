"""What a benchmark ran on, for the record beside its figures."""

from typing import Any

from ikde.batch.machine import describe_machine, describe_versions


def describe() -> dict[str, Any]:
    """Processor, cores, Python and the versions that matter."""
    machine, versions = describe_machine(), describe_versions()
    return {
        "cpu": machine["processor"],
        "cores": machine["cores"],
        "avx512": "avx512f" in machine["cpu_flags"],
        **{name: versions[name] for name in ("python", "ikde", "numpy", "numba")},
    }
