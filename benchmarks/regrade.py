"""A million answers graded by code of the tests' own: random robot files, random targets, every call that solves.

    python -m benchmarks.regrade                             # 200 robots, 5,000 targets each
    python -m benchmarks.regrade --robots 20 --targets 500   # smaller: writes no record
    python -m benchmarks.regrade --first 17 --robots 1       # one robot again

`tests/robot_texts.py` draws the robots, `tests/asking.py` the questions, and `tests/regrade.py`, which knows the robot
file and nothing of ikde, grades every answer and accounts for every pair of components. One robot in three is solved by
kernels written for it, the default; the others by table kernels, which need no compiling. Each process keeps to one
core. The run has a cache folder of its own, unless `$IKDE_CACHE_DIR` names one. Exit code 1 if anything is wrong.
Writes benchmarks/results/regrade.json.
"""

import argparse
import json
import os
import sys
import time
from collections import Counter
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from benchmarks.machine import describe
from tests.asking import KINDS, account_for_pairs, ask_and_regrade
from tests.regrade import Grader
from tests.robot_files import load_text
from tests.robot_texts import random_robot_text

RESULTS = Path(__file__).parent / "results" / "regrade.json"
ROBOTS, TARGETS = 200, 5_000
WRITTEN = 3  # one robot in so many has kernels of its own
SMALL = 5  # joints: kernels for every kind of target
ROBOTS_A_PROCESS = 6  # compiled code is never let go of


def regrade_robot(seed: int, targets: int) -> dict[str, Any]:
    """Everything about one robot: what was asked, what came back, and what is wrong with it."""
    is_written = seed % WRITTEN == 0
    os.environ.pop("IKDE_KERNELS", None)
    os.environ.update({} if is_written else {"IKDE_KERNELS": "tables"})
    started, text = time.perf_counter(), random_robot_text(seed)
    grader, robot = Grader.of_text(text), load_text(text)
    rng, pairs = np.random.default_rng(seed), account_for_pairs(robot, grader)
    options = choose_written(grader, rng) if is_written else {}
    answers = ask_and_regrade(robot, grader, rng, targets, threads=1, **options)
    return {
        "seed": seed,
        "kernels": "written" if is_written else "tables",
        "joints": len(grader.joints),
        "pairs": dict(pairs.counts),
        "answers": dict(answers.counts),
        "largest_gap": answers.largest_gap,
        "faults": pairs.faults + answers.faults,
        "seconds": time.perf_counter() - started,
    }


def choose_written(grader: Grader, rng: np.random.Generator) -> dict[str, Any]:
    """What is asked of kernels that are written for each detector and kind of target, and take seconds to compile."""
    kinds = KINDS if len(grader.joints) <= SMALL else (str(rng.choice(KINDS)),)
    return {"kinds": kinds, "detectors": (None,)}


def run(seeds: range, targets: int) -> list[dict[str, Any]]:
    """All robots, on all cores, told one by one."""
    done = []
    with get_context("spawn").Pool(len(os.sched_getaffinity(0)), maxtasksperchild=ROBOTS_A_PROCESS) as pool:
        for robot in pool.imap(partial(regrade_robot, targets=targets), seeds):
            done.append(robot)
            show(robot)
    return done


def show(robot: dict[str, Any]) -> None:
    """One line, and one for each of the first faults."""
    asked, faults = robot["answers"], len(robot["faults"])
    what = f"robot {robot['seed']}: {robot['joints']} joints, {robot['kernels']} kernels, {robot['seconds']:.1f} s"
    print(f"{what}, {asked.get('reached', 0)} of {asked['targets']} reached, {faults} faults", flush=True)
    for fault in robot["faults"][:3]:
        print(f"  {json.dumps(fault)}", flush=True)


def summarise(robots: list[dict[str, Any]]) -> dict[str, Any]:
    """The record."""
    faults = [{"robot": robot["seed"], **fault} for robot in robots for fault in robot["faults"]]
    return {
        "robots": len(robots),
        "kernels": Counter(robot["kernels"] for robot in robots),
        "robots_of_so_many_joints": dict(sorted(Counter(robot["joints"] for robot in robots).items())),
        "robots_that_reach_nothing": sum(not robot["answers"].get("reached") for robot in robots),
        "answers": _add(robot["answers"] for robot in robots),
        "answers_of_written_kernels": _add(r["answers"] for r in robots if r["kernels"] == "written"),
        "pairs": _add(robot["pairs"] for robot in robots),
        "largest_gap_of_figures": max(robot["largest_gap"] for robot in robots),
        "violations": Counter(fault["fault"] for fault in faults),
        "first_violations": faults[:20],
        "processor_seconds": sum(robot["seconds"] for robot in robots),
    }


def _add(counts: Any) -> dict[str, int]:
    return dict(sum((Counter(each) for each in counts), Counter()))


def main() -> None:
    """Ask, grade, print, write the record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=ROBOTS)
    parser.add_argument("--targets", type=int, default=TARGETS, help="of each robot")
    parser.add_argument("--first", type=int, default=0, help="seed of the first robot")
    told = parser.parse_args()
    started = time.perf_counter()
    with TemporaryDirectory(prefix="regrade_") as cache:
        os.environ.setdefault("IKDE_CACHE_DIR", cache)
        robots = run(range(told.first, told.first + told.robots), told.targets)
    record = {"machine": describe(), **summarise(robots), "seconds": time.perf_counter() - started}
    print(json.dumps({name: value for name, value in record.items() if name != "first_violations"}, indent=1))
    if told.robots * told.targets >= ROBOTS * TARGETS:
        RESULTS.write_text(json.dumps(record, indent=1) + "\n")
    sys.exit(bool(record["violations"]))


if __name__ == "__main__":
    main()
