"""`ikde doctor`: versions, cores, cache folder, and how long compiling, loading and solving take here."""

import os
import platform
import time
from importlib.metadata import version
from typing import Any

from ikde.cli.options import JsonOption
from ikde.cli.output import note_compile, print_json, print_result, use_color

PACKAGES = ("numpy", "numba", "pydantic", "pyarrow", "matplotlib", "typer", "rich")


def doctor(as_json: JsonOption = False) -> None:
    """Say what ikde runs on, and time one solve."""
    from ikde.report.render import make_table, plain, render

    facts = describe_machine()
    if as_json:
        print_json(facts)
        return
    table = make_table("ikde doctor", "")
    for name, value in facts.items():
        table.add_row(name.replace("_", " "), f"{value:.3f}" if isinstance(value, float) else plain(str(value)))
    print_result(render(table, color=use_color(), width=140))


def describe_machine() -> dict[str, Any]:
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
    with note_compile():
        first = solve(robot, target)
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
