"""Run every peer beside ikde, interleaved, one core each, and record how often and how fast they solve.

    python benchmarks/peers/run.py                                  # all cases, all peers: about ten minutes
    python benchmarks/peers/run.py --only ikde rtb --cases pose --targets 20 --out try.json

In each turn every peer works on its next targets for at most a slice of time, in a new order; then comes the next
turn, so that a swing of the machine's clock hits all alike. With `--rounds` all targets are asked over and over, and a
target's time is its median over the rounds; the rounds' own figures are on record beside it. All peers get the same
targets from the first on; a peer that has used up its share of time for a case stops there, so slow ones answer fewer
(the counts are on record). An answer after the time limit does not count; a peer that gives none in more than twice
that is stopped, and that is on record. What comes back is graded by ikde's plain numpy (`verify_many`) before it counts
as solved.
"""

import argparse
import json
import re
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from cases import NAMES, Case, make_case
from client import Client, Lost
from protocol import Answer, Setup
from roster import ROSTER, select

import ikde
from ikde.batch.machine import describe_machine, describe_versions
from ikde.model.collision_model import CollisionModel
from ikde.solver.verify import verify_many

RESULTS = Path(__file__).parent.parent / "results" / "peers.json"
WARM_UP = 4
CURVE_POINTS = 60
PERCENTILES = {"median": 50, "p95": 95, "p99": 99, "max": 100}
STARTED = time.perf_counter()


@dataclass
class Tally:
    """One peer's answers to one case."""

    start: dict[str, float]
    answers: list[Answer] = field(default_factory=list)
    lost: str | None = None

    @property
    def spent_s(self) -> float:
        """Time used so far."""
        return sum(seconds for seconds, _ in self.answers)


def run_case(
    case: Case, warm_up: Case, setup: Setup, clients: list[Client], options: argparse.Namespace
) -> dict[str, Any]:
    """All peers on one case, once or over and over, after a few targets that do not count."""
    order, rounds = np.random.default_rng(options.seed), []
    for _ in range(options.rounds):
        tallies = [prepare(client, case.name, setup, warm_up, options) for client in clients]
        while waiting := [k for k, tally in enumerate(tallies) if is_waiting(tally, len(case.p), options)]:
            for k in order.permutation(waiting):
                take_turn(clients[k], tallies[k], case, options)
        rounds.append(tallies)
    return {
        clients[k].entry.name: summarise(case, list(row), options) for k, row in enumerate(zip(*rounds, strict=True))
    }


def prepare(client: Client, case: str, setup: Setup, warm_up: Case, options: argparse.Namespace) -> Tally:
    """A peer with the case's robot loaded."""
    began = time.perf_counter()
    try:
        tally = Tally(client.prepare(setup, warm_up.p, warm_up.R, options.limit))
    except Lost as lost:
        tally = Tally({}, lost=str(lost))
    took_s = time.perf_counter() - began
    if took_s > 0.05:  # the robot was not at hand
        say(f"{case}: {client.entry.name}: {tally.lost or f'ready after {took_s:.1f} s'}")
    return tally


def is_waiting(tally: Tally, count: int, options: argparse.Namespace) -> bool:
    """Whether a peer has targets and time left."""
    done = len(tally.answers)
    return tally.lost is None and done < count and (done < options.least or tally.spent_s < options.share)


def take_turn(client: Client, tally: Tally, case: Case, options: argparse.Namespace) -> None:
    """One peer's next targets; the one that it was lost at is asked and not solved."""
    first = len(tally.answers)
    last = min(first + (10 * options.chunk if client.entry.batch else options.chunk), len(case.p))
    began = time.perf_counter()
    try:
        tally.answers += client.solve(case.p[first:last], case.R[first:last], options.limit, options.slice)
    except Lost as lost:
        tally.answers.append((time.perf_counter() - began, None))
        tally.lost = str(lost)
    if not is_waiting(tally, len(case.p), options):
        done = f"{len(tally.answers)} targets in {tally.spent_s:.2f} s"
        say(f"{case.name}: {client.entry.name}: {tally.lost or done}")


def write_setup(case: Case, options: argparse.Namespace, folder: Path) -> Setup:
    """The case's robot as files."""
    stem = case.name.replace(" ", "_")
    urdf, mjcf = folder / f"{stem}.urdf", folder / f"{stem}.xml"
    urdf.write_text(ikde.format_urdf(case.robot))
    mjcf.write_text(ikde.format_mjcf(case.robot))
    tolerances = {"position_tolerance_m": options.tolerance[0], "orientation_tolerance_rad": options.tolerance[1]}
    return Setup(robot=case.robot, urdf=urdf, mjcf=mjcf, kind=case.kind, seed=options.seed, **tolerances)


def grade(case: Case, answers: list[Answer], options: argparse.Namespace) -> np.ndarray:
    """Which answers [T] came in time and are accepted by plain numpy."""
    robot = case.robot
    returned = np.array([q is not None and bool(np.all(np.isfinite(q))) for _, q in answers])
    Q = np.array([q if ok else robot.home for (_, q), ok in zip(answers, returned, strict=True)])
    settings = ikde.SolveSettings(
        position_tolerance_m=options.tolerance[0], orientation_tolerance_rad=options.tolerance[1]
    )
    accepted = verify_many(CollisionModel.of(robot), case.targets()[: len(Q)], Q, settings).accepted
    return accepted & returned & np.array([seconds <= options.limit for seconds, _ in answers])


def summarise(case: Case, tallies: list[Tally], options: argparse.Namespace) -> dict[str, Any]:
    """Shares and times of one peer in one case over all rounds; times over all targets it was asked, solved or not."""
    answers = [answer for tally in tallies for answer in tally.answers]
    record: dict[str, Any] = {k: round(v, 4) for k, v in tallies[0].start.items()}
    record |= {"asked": len(answers), "rounds": len(tallies)}
    if lost := [tally.lost for tally in tallies if tally.lost]:
        record["lost"] = lost[0]
    if not answers:
        return record
    asked = [tally for tally in tallies if tally.answers]
    solved = np.concatenate([grade(case, tally.answers, options) for tally in asked])
    record["solved"] = int(solved.sum())
    record["returned"] = sum(q is not None for _, q in answers)
    rounds = [[seconds * 1e3 for seconds, _ in tally.answers] for tally in asked]
    record["ms"] = take_figures(take_medians(rounds))
    if len(rounds) > 1:
        record["ms_of_rounds"] = [take_figures(ms) for ms in rounds]
    ms = np.array([seconds for seconds, _ in answers]) * 1e3
    times = np.sort(ms[solved])
    if times.size:
        picks = np.unique(np.linspace(0, times.size - 1, CURVE_POINTS).astype(int))
        record["curve"] = [[shorten(times[k]), round((k + 1) / len(ms), 6)] for k in picks]
    return record


def take_figures(ms: Sequence[float]) -> dict[str, float]:
    """Median, tails and mean."""
    return {name: shorten(np.percentile(ms, p)) for name, p in PERCENTILES.items()} | {"mean": shorten(np.mean(ms))}


def take_medians(rounds: list[list[float]]) -> list[float]:
    """Of each target that was asked in every round its median over them."""
    return np.median([ms[: min(map(len, rounds))] for ms in rounds], axis=0).tolist()


def shorten(value: float) -> float:
    """Four digits."""
    return float(f"{value:.4g}")


def say(text: str) -> None:
    """Progress on stderr."""
    print(f"[{time.perf_counter() - STARTED:4.0f} s] {text}", file=sys.stderr, flush=True)


def read_options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", type=int, default=500, help="targets a case")
    parser.add_argument("--cases", nargs="+", choices=NAMES, default=NAMES)
    parser.add_argument("--only", nargs="+", default=None, metavar="WORD", help="peers by name or a word of it")
    parser.add_argument("--tolerance", nargs=2, type=float, default=(1e-4, 1e-3), metavar=("M", "RAD"))
    parser.add_argument("--rounds", type=int, default=1, help="times that a case is gone through")
    parser.add_argument("--limit", type=float, default=5.0, help="seconds a target")
    parser.add_argument("--share", type=float, default=3.0, help="seconds a peer and case")
    parser.add_argument("--least", type=int, default=3, help="targets that even a slow peer is asked")
    parser.add_argument("--slice", type=float, default=1.0, help="seconds a turn")
    parser.add_argument("--chunk", type=int, default=100, help="targets a turn, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS)
    return parser.parse_args()


def start_workers(words: list[str] | None) -> tuple[list[Client], dict[str, str]]:
    """A worker a peer; why some have none."""
    clients, missing = [], {}
    for index in select(words):
        try:
            clients.append(Client(index))
        except Lost as lost:
            missing[ROSTER[index].name] = str(lost)
            say(f"left out: {ROSTER[index].name}: {lost}")
    return clients, missing


def run_cases(clients: list[Client], record: dict[str, Any], options: argparse.Namespace, folder: Path) -> None:
    """One case after the other into the record, which is written after each; like ones share their set-up."""
    setups: dict[tuple[str, bytes], Setup] = {}
    for name in options.cases:
        drawn, n = make_case(name, options.targets + WARM_UP), options.targets
        case, warm_up = (replace(drawn, p=drawn.p[rows], R=drawn.R[rows]) for rows in (slice(n), slice(n, None)))
        key = case.kind, np.array([case.robot.lower, case.robot.upper]).tobytes()
        if key not in setups:
            setups[key] = write_setup(case, options, folder)
        record["cases"][name] = run_case(case, warm_up, setups[key], clients, options)
        print_case(name, record["cases"][name])
        options.out.parent.mkdir(parents=True, exist_ok=True)
        options.out.write_text(format_record(record))


def main() -> None:
    """Run, print a line a peer, write the record."""
    options = read_options()
    clients, missing = start_workers(options.only)
    facts = {c.entry.name: {"import_s": c.import_s, "versions": c.versions, "use": c.entry.use} for c in clients}
    record = {
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": {**describe_machine(), **describe_versions()},
        "options": {k: v for k, v in vars(options).items() if k not in ("out", "only", "cases")},
        "peers": facts,
        "missing": missing,
        "cases": {},
    }
    record["machine"].pop("cpu_flags")
    try:
        with tempfile.TemporaryDirectory() as folder:
            run_cases(clients, record, options, Path(folder))
    finally:
        for client in clients:
            client.close()


def format_record(record: dict[str, Any]) -> str:
    """JSON with a line a curve."""
    text = json.dumps(record, indent=1, default=str)
    return re.sub(r"\[\s+\[[^{}]*?\]\s+\]", lambda match: "".join(match[0].split()), text) + "\n"


def print_case(name: str, peers: dict[str, Any]) -> None:
    """A line a peer."""
    print(f"\n{name}: solved of asked, ms median / p95 / p99 / max / mean")
    for peer, row in sorted(peers.items(), key=lambda item: item[1].get("ms", {}).get("median", np.inf)):
        if "ms" in row:
            times = " / ".join(f"{row['ms'][k]:.4g}" for k in (*PERCENTILES, "mean"))
            print(f"  {peer:42} {row['solved']:6} of {row['asked']:6}  {times}  {row.get('lost', '')}")
        else:
            print(f"  {peer:42} {row.get('lost')}")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
