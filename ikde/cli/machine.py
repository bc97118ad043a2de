"""Facts about this machine and this installation."""

import os
import platform
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

PACKAGES = ("numpy", "numba", "pydantic", "pyarrow", "matplotlib", "typer", "rich")


def describe_machine(announce: Callable[[], None]) -> dict[str, Any]:
    """Versions, cores, cache folder, and the seconds of importing, compiling or loading, and solving."""
    started = time.perf_counter()
    import ikde
    from ikde.kernels.cache_folder import CACHE_FOLDER, CACHE_IS_WRITABLE
    from ikde.solver.search import usable_cores
    from ikde.solver.solve import solve

    imported = time.perf_counter()
    robot = ikde.load_robot("qiao2021")
    target = ikde.Target(p_world_tool=(0.8, 0.5, 1.0))
    before = time.perf_counter()
    first = solve(robot, target, announce_compile=announce)
    first_call = time.perf_counter() - before
    second = solve(robot, target)
    return {
        "ikde": ikde.__version__,
        "python": platform.python_version(),
        "machine": f"{platform.machine()}, {platform.system()} {platform.release()}",
        "cores": os.cpu_count(),
        "usable_cores": usable_cores(),
        **{package: version(package) for package in PACKAGES},
        "cache_folder": str(CACHE_FOLDER),
        "cache_is_writable": CACHE_IS_WRITABLE,
        "import_seconds": imported - started,
        "compile_seconds": first.compile_seconds,
        "load_seconds": first_call - first.compile_seconds - first.solve_seconds,
        "solve_seconds": second.solve_seconds,
        "solve_reached": second.reached,
    }
