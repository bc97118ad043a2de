"""`ikde doctor`: versions, cores, cache folder, and how long compiling, loading and solving take here."""

import os
import platform
import time
from collections.abc import Mapping
from typing import Any

from ikde.cli.options import JsonOption
from ikde.cli.output import layout, print_json, print_result

PACKAGES = ("numpy", "numba", "pydantic", "pyarrow", "matplotlib", "typer", "rich")


def doctor(as_json: JsonOption = False) -> None:
    """Say whether ikde works here, what it runs on, and how long a solve takes.

    Example: ikde doctor
    """
    from ikde.report.render import make_table, plain, render

    facts = describe_machine()
    if as_json:
        print_json(facts)
        return
    table = make_table("ikde doctor", "")
    for name, value in facts.items():
        table.add_row(name.removesuffix("_seconds").replace("_", " "), plain(_write_fact(value)))
    print_result(render(judge(facts), table, **layout(140)))


def _write_fact(value: Any) -> str:
    from ikde.report.numbers import seconds

    if isinstance(value, bool):
        return "yes" if value else "no"
    return seconds(value) if isinstance(value, float) else str(value)


def judge(facts: Mapping[str, Any]) -> str:
    """One line: whether ikde works here, and what to wait for."""
    from ikde.report.numbers import seconds

    if not facts["solve_reached"]:
        return "not good: a target within easy reach was not reached; please report it, with what stands below"
    if not facts["cache_is_writable"]:
        return "not good: the cache folder cannot be used, so every process compiles anew; set IKDE_CACHE_DIR"
    if facts["compiling"] == "never":
        took = seconds(facts["solve_seconds"])
        return f"good, but slow: IKDE_COMPILE=never, so nothing is compiled, and a solve in plain Python takes {took}"
    compiled = "is compiled now, and need not be again" if facts["compile_seconds"] else "was compiled before"
    return f"all good: what this solve needs {compiled}, and the next one takes {seconds(facts['solve_seconds'])}"


def describe_machine() -> dict[str, Any]:
    """Versions, cores, cache folder, and the seconds of importing, compiling or loading, and solving."""
    started = time.perf_counter()
    from importlib.metadata import version

    import ikde
    from ikde.kernels.cache_folder import CACHE_FOLDER, CACHE_IS_WRITABLE
    from ikde.model.collision_model import CollisionModel
    from ikde.solver.background import WAIT, choose_way, compile_way
    from ikde.solver.compile_note import name_work, note_compile
    from ikde.solver.search import usable_cores
    from ikde.solver.solve import solve

    imported = time.perf_counter()
    robot = ikde.load_robot("qiao2021")
    target = ikde.Target(p_world_tool=(0.8, 0.5, 1.0))
    before = time.perf_counter()
    with compile_way(WAIT), note_compile(lambda: name_work("position targets", CollisionModel.of(robot))):
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
        "compiling": choose_way(),
        "cache_folder": str(CACHE_FOLDER),
        "cache_is_writable": CACHE_IS_WRITABLE,
        "import_seconds": imported - started,
        "compile_seconds": first.compile_seconds,
        "load_seconds": first_call - first.compile_seconds - first.solve_seconds,
        "solve_seconds": second.solve_seconds,
        "solve_reached": second.reached,
    }
