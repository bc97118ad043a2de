"""What a run was made on, for the record beside its answers."""

import os
import platform
import socket
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ikde.batch.recipe import ikde_version

PACKAGES = ("numpy", "numba", "pyarrow")


def describe_versions() -> dict[str, str]:
    """Versions of ikde, Python and the packages that have a hand in the answers."""
    return {
        "ikde": ikde_version(),
        "python": platform.python_version(),
        **{package: version(package) for package in PACKAGES},
    }


def describe_machine() -> dict[str, Any]:
    """Host, system, processor, cores and the processor's flags."""
    facts = _read_cpuinfo()
    return {
        "host": socket.gethostname(),
        "system": f"{platform.system()} {platform.release()}",
        "processor": facts.get("model name") or platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "cpu_flags": (facts.get("flags") or facts.get("Features") or "").split(),
    }


def _read_cpuinfo() -> dict[str, str]:
    """The first processor of Linux's list; nothing elsewhere."""
    path = Path("/proc/cpuinfo")
    if not path.exists():
        return {}
    first = path.read_text(encoding="utf-8", errors="replace").split("\n\n")[0]
    pairs = (line.split(":", 1) for line in first.splitlines() if ":" in line)
    return {key.strip(): value.strip() for key, value in pairs}
