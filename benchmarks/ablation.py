"""What each idea behind the engine `lm` buys: one is taken away at a time, the rest stays.

    python benchmarks/ablation.py [--quick]

Pose targets of qiao2021, one core, 1e-6 m and 1e-6 rad. The variants are made from the text of the generated module,
are compiled without a cache, and run interleaved; figures are medians over rounds. A second process does the same with
vectors of 512 bits, which LLVM by itself avoids on some machines. Writes benchmarks/results/ablation.json.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numba
import numpy as np
from lane_check import format_judge
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.batch.generators import ReachableSource
from ikde.kernels import lm as tables_lm
from ikde.kernels import tables
from ikde.kernels.arrays import COUNTS, SeedArrays
from ikde.kernels.clearance import judge_centres
from ikde.kernels.flat_arguments import flatten_search
from ikde.model.collision_model import CollisionModel
from ikde.model.generate import assemble as generator
from ikde.model.pack import pack_targets
from ikde.solver.engines import pool
from ikde.solver.engines.draws import draw, draw_free
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.pool import NO_BASE, make_seeds
from ikde.solver.problem import make_problem, pack_searched

RESULTS = Path(__file__).parent / "results" / "ablation.json"
LANES = tables.LANES
LIBM = "import math as _math\n\n\n@inline_kernel\ndef sin_cos(x):\n    return _math.sin(x), _math.cos(x)\n"
FREE = re.compile(r"(free\d+) = 0\.0 if .* else 1\.0")
NUMBER = re.compile(r"(?<![\w.\]])(\d+\.\d+(?:e-?\d+)?|\d+e-?\d+)(?![\w.])")


@dataclass
class Variant:
    """One way to make the kernels and the seeds."""

    name: str
    change: Callable[[str], str] = lambda text: text
    every_test: bool = False
    seeds: str = "pool and base"
    times: dict[str, list[float]] = field(default_factory=dict)
    module: Any = None


def main() -> None:
    """Measure, print, record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="1,000 targets, 3 rounds")
    parser.add_argument("--wide", action="store_true", help="only the vectors of 512 bits, in a process of its own")
    told = parser.parse_args()
    count, rounds = (1000, 3) if told.quick else (10_000, 15)
    record = measure(count, rounds, list_variants()[:1] if told.wide else list_variants())
    if told.wide:
        print(json.dumps(record))
        return
    record["wide"] = measure_wide(told.quick)
    record["machine"] = describe()
    show(record)
    if not told.quick:
        RESULTS.write_text(json.dumps(record, indent=1) + "\n")


def measure_wide(quick: bool) -> dict[str, Any]:
    """The same in a process that prefers vectors of 512 bits."""
    import llvmlite.binding as llvm

    features = llvm.get_host_cpu_features().flatten() + ",-prefer-256-bit"
    command = [sys.executable, __file__, "--wide", *(["--quick"] if quick else [])]
    own = {**os.environ, "NUMBA_CPU_FEATURES": features}
    found = subprocess.run(command, env=own, capture_output=True, text=True, check=False)
    return json.loads(found.stdout) if found.returncode == 0 else {"error": found.stderr[-500:]}


def measure(count: int, rounds: int, variants: list[Variant]) -> dict[str, Any]:
    """The variants, interleaved."""
    robot = ikde.load_robot("qiao2021")
    settings = ikde.SolveSettings(position_tolerance_m=1e-6, orientation_tolerance_rad=1e-6)
    problem = make_problem(robot, settings, collision=None, near=None, freeze=None)
    options = {"lower": robot.lower, "upper": robot.upper, "goal": "pose", "count": count, "seed": 3}
    targets = ReachableSource(collision=problem.collision, **options).read(0, count)
    seeds = make_seeds(problem, "pose")
    jobs: dict[str, dict[str, Callable[[], Any]]] = {}
    for variant in variants:
        variant.module = make_module(robot, variant)
        jobs[variant.name] = make_jobs(problem, targets, change_seeds(seeds, variant.seeds), variant)
        for job in jobs[variant.name].values():
            job()
    for _ in range(rounds):
        for variant in variants:
            for name, job in jobs[variant.name].items():
                variant.times.setdefault(name, []).append(job())
    rows = {v.name: {name: float(np.median(times)) for name, times in v.times.items()} for v in variants}
    widths = {v.name: vector_width(v.module) for v in variants if not isinstance(v.module, str)}
    return {"targets": count, "rounds": rounds, "variants": rows, "vectors": widths}


def list_variants() -> list[Variant]:
    """The whole, then the whole less one idea."""
    return [
        Variant("all ideas"),
        Variant("tables instead of generated code", seeds="tables"),
        Variant("every test: nothing implied or proved", every_test=True),
        Variant("seeds: from around the tool pose, base not set", seeds="pool"),
        Variant("seeds: drawn uniformly from the pool, not from every cell alike", seeds="even"),
        Variant("seeds: uniform", seeds="uniform"),
        Variant("limits by clipping, no active set", lambda text: FREE.sub(r"\1 = 1.0", text)),
        Variant("sine and cosine of libm", lambda text: text.replace(TRIG, LIBM)),
        Variant("fused multiply and add allowed", lambda text: text.replace(LEAF, FUSED)),
        Variant("check in lanes in single precision", single_precision),
    ]


def single_precision(text: str) -> str:
    """`judge_lanes` of single-precision numbers, with a sine and cosine to match; the rest stays."""
    begin = text.index("@leaf_kernel\ndef judge_lanes")
    end = text.index("\n\n\n", begin)
    names: dict[str, str] = {}
    judge = NUMBER.sub(lambda found: names.setdefault(found[0], f"F{len(names)}"), SINGLE_TRIG + text[begin:end])
    constants = "\n".join(f"{name} = np.float32({value})" for value, name in names.items())
    judge = judge.replace("sin_cos(", "sin_cos_single(")
    return f"{text[:begin]}{constants}\nONE, TWO = np.int32(1), np.int32(2)\n\n\n{judge}{text[end:]}"


SINGLE_TRIG = """@inline_kernel
def sin_cos(x):
    k = np.rint(x * 0.6366197723675814)
    r = ((x - k * 1.5703125) - k * 4.837512969970703e-04) - k * 7.549789948768648e-08
    u = r * r
    s = r + r * u * (-0.16666654611 + u * (8.3321608736e-03 - u * 1.9515295891e-04))
    c = 1.0 - 0.5 * u + u * u * (4.166664568298827e-02 + u * (-1.388731625493765e-03 + u * 2.443315711809948e-05))
    quadrant = np.int32(k)
    if quadrant & ONE:
        s, c = c, s
    return s * np.float32(ONE - (quadrant & TWO)), c * np.float32(ONE - ((quadrant + ONE) & TWO))


"""


TRIG = "from ikde.kernels.trig import sin_cos\n"
LEAF = "from ikde.kernels.jit import leaf_kernel\n"
FUSED = """from numba import njit as _njit


def leaf_kernel(function):
    return _njit(error_model="numpy", nogil=True, _nrt=False, fastmath={"contract"})(function)


"""


def make_module(robot: ikde.Robot, variant: Variant) -> Any:
    """Compile a variant's text, without a cache."""
    if variant.seeds == "tables":
        return tables_lm
    kept = generator.drop_implied, generator.drop_proved
    if variant.every_test:
        generator.drop_implied = lambda tests: tests
        generator.drop_proved = lambda robot, tests, margin, lower, upper: tests
    find = generator.format_find
    generator.format_find = lambda arrays, tests, *ends: "\n\n".join(
        [find(arrays, tests, *ends), format_judge(arrays, tests)]
    )
    text = generator.format_module(CollisionModel.of(robot), "pose")
    generator.drop_implied, generator.drop_proved, generator.format_find = *kept, find
    made = ModuleType(re.sub(r"\W", "_", variant.name))
    text = (
        variant.change(text).replace("from ikde.kernels.jit import inline_kernel, kernel\n", PLAIN).replace(LEAF, BARE)
    )
    exec(compile(text, variant.name, "exec"), made.__dict__)
    return made


BARE = """from numba import njit as _njit


def leaf_kernel(function):
    return _njit(error_model="numpy", nogil=True, _nrt=False)(function)


"""
PLAIN = """from numba import njit as _njit


def kernel(function):
    return _njit(error_model="numpy", nogil=True)(function)


def inline_kernel(function):
    return _njit(error_model="numpy", forceinline=True, _nrt=False)(function)


"""


def change_seeds(seeds: SeedArrays, how: str) -> SeedArrays:
    """The pool without the base's help, or none."""
    if how == "uniform":
        return seeds._replace(q=seeds.q[:0], T_world_tool=seeds.T_world_tool[:0], base=NO_BASE)
    if how == "pool":
        return draw_whole_pool(seeds)
    return draw_evenly(len(seeds.q)) if how == "even" else seeds


def draw_whole_pool(seeds: SeedArrays) -> SeedArrays:
    """The same arms, the bases drawn from their ranges."""
    robot, rng = ikde.load_robot("qiao2021"), np.random.default_rng(0)
    q = seeds.q.copy()
    q[:, seeds.base] = rng.uniform(robot.lower, robot.upper, q.shape)[:, seeds.base]
    return pool.sort_pool(robot, q, NO_BASE, np.array(pool.GRIDS["pose"]))


def draw_evenly(count: int) -> SeedArrays:
    """As many as are kept of each cell, but from the first that are free."""
    collision = CollisionModel.of(ikde.load_robot("qiao2021"))
    whole = pool.make_whole_pool(collision, "pose")
    numbers = draw_free(*pack_searched(collision), *whole.drawn, count)
    return pool.sort_pool(collision.robot, draw(numbers, *whole.drawn), whole.base, whole.grid)


def make_jobs(problem: Any, targets: ikde.Targets, seeds: SeedArrays, variant: Variant) -> dict[str, Callable[[], Any]]:
    """What is timed: each gives its figure."""
    models = pack_searched(problem.collision)
    is_table = variant.seeds == "tables"
    count, joints = len(targets), len(problem.lower)
    q, score = np.empty((count, joints)), np.empty((count, 2))
    counts = np.empty((count, COUNTS), dtype=np.int64)
    pairs = np.zeros((count, len(problem.collision.pairs)), dtype=np.int64)
    settings = (make_ranges(problem), make_descent(problem, "pose"), seeds, np.uint64(3))
    few = min(count, 1000) if is_table else count
    attempts = np.tile([0, 1000], (few, 1))
    lane = (np.arange(count), attempts, q, score, counts, pairs)

    def solve_lanes() -> float:
        score[:], counts[:] = np.inf, 0
        began = time.perf_counter()
        with np.errstate(over="ignore"):
            block = flatten_search(*models, *settings[:3])
            variant.module.solve_targets(*block, *pack_targets(targets), np.array([0, few]), settings[3], *lane)
        return (time.perf_counter() - began) / few * 1e6

    def solve_singly() -> float:
        score[:], counts[:] = np.inf, 0
        began = time.perf_counter()
        single(
            *(*pack_targets(targets), few, *flatten_search(*models, *settings[:3])),
            *(settings[3], q, score, counts, pairs),
        )
        return (time.perf_counter() - began) / few * 1e6

    solve_target = variant.module.solve_target

    @numba.njit
    def single(kinds, T, few, numbers, whole, pool, pool_T, seed, q, score, counts, pairs):
        for k in range(few):
            question = (numbers, whole, pool, pool_T, kinds, T, k)
            solve_target(*question, seed, k, 0, 1000, q[k], score[k], counts[k], pairs[k])

    jobs: dict[str, Callable[[], Any]] = {"lanes us": solve_lanes, "singly us": solve_singly}
    jobs |= {"steps": lambda: float(counts[:few, 2].mean()), "attempts": lambda: float(counts[:few, 1].mean())}
    return jobs | make_check_jobs(problem, variant, models)


def make_check_jobs(problem: Any, variant: Variant, models: tuple[Any, ...]) -> dict[str, Callable[[], Any]]:
    """Nanoseconds of forward kinematics and the yes/no check, configuration by configuration and in lanes."""
    robot = problem.robot
    qs = np.random.default_rng(1).uniform(robot.lower, robot.upper, (16_384, len(robot.joints)))
    hits = np.empty(len(qs), dtype=bool)
    judge_centres(*models, qs, hits)
    sets = {"all": qs, "free": qs[~hits][: len(qs[~hits]) // LANES * LANES].copy()}
    find, make_buffers = variant.module.find_collision, variant.module.make_buffers
    jobs: dict[str, Callable[[], Any]] = {}

    @numba.njit
    def loop(robot, collision, rows):
        buffers, found = make_buffers(robot, collision, rows.shape[1]), 0
        for k in range(rows.shape[0]):
            found += find(robot, collision, rows[k], buffers) >= 0
        return found

    for name, rows in sets.items():
        jobs[f"check {name} ns"] = lambda rows=rows: timed(lambda: loop(*models, rows)) / len(rows)
    if hasattr(variant.module, "judge_lanes"):
        judge = variant.module.judge_lanes

        @numba.njit
        def loop_lanes(collision, rows, free):
            for k in range(rows.shape[0]):
                judge(collision, rows[k], free[k])

        single = "ONE" in vars(variant.module)
        real = np.float32 if single else np.float64
        by_lane = qs.astype(real).reshape(-1, LANES, qs.shape[1]).transpose(0, 2, 1)
        packed = np.ascontiguousarray(by_lane).reshape(len(qs) // LANES, -1)
        collision = models[1]._replace(safe_distance=real(models[1].safe_distance))
        free = np.empty((len(packed), LANES), dtype=np.bool_)
        jobs["check lanes ns"] = lambda: timed(lambda: loop_lanes(collision, packed, free)) / len(qs)
        loop_lanes(collision, packed, free)
        wrong = float((free.ravel() == hits).mean())
        assert wrong == 0.0 or single
        if single:
            jobs["wrong in single precision"] = lambda: wrong
    assert loop(*models, qs) == hits.sum()
    return jobs


def timed(job: Callable[[], Any]) -> float:
    """Nanoseconds."""
    began = time.perf_counter()
    job()
    return (time.perf_counter() - began) * 1e9


def vector_width(module: Any) -> dict[str, int]:
    """How often the widest registers stand in the machine code of what runs in lanes."""
    found = {}
    for name in ("take_steps", "judge_lanes"):
        if hasattr(module, name):
            code = "".join(getattr(module, name).inspect_asm().values())
            found[name] = {"zmm": code.count("%zmm"), "ymm": code.count("%ymm"), "lines": code.count("\n")}
    return found


def show(record: dict[str, Any]) -> None:
    """Print the table."""
    columns = list(record["variants"]["all ideas"])
    table = Table("variant", *columns)
    for part, rows in (("", record["variants"]), (" (512 bits)", record["wide"].get("variants", {}))):
        for name, figures in rows.items():
            if not part or name == "all ideas":
                table.add_row(name + part, *(f"{figures[c]:.3g}" if c in figures else "" for c in columns))
    Console(width=180).print(table)
    print(json.dumps(record["vectors"]))


if __name__ == "__main__":
    main()
