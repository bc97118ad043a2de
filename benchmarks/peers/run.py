"""Run every peer beside ikde, interleaved, one core each, and record how often and how fast they solve.

    python benchmarks/peers/run.py                                  # all cases, all peers
    python benchmarks/peers/run.py --only ikde rtb --cases pose --targets 20 --out try.json

In each round every peer works on its next targets for at most a slice of time, in a new order; then comes the next
round, so that a swing of the machine's clock hits all alike. All peers get the same targets from the first on; a peer
that has used up its share of time for a case stops there, so slow ones answer fewer (the counts are on record). What
comes back is graded by ikde's plain numpy (`verify_many`) before it counts as solved.
"""

import argparse
import json
import re
import tempfile
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from cases import NAMES, Case, make_case
from client import Client, Lost, list_peers
from protocol import Setup

import ikde
from ikde.batch.machine import describe_machine, describe_versions
from ikde.solver.verify import verify_many

RESULTS = Path(__file__).parent.parent / "results" / "peers.json"
WARM_UP = 4
CURVE_POINTS = 60


@dataclass
class Tally:
    """One peer's answers to one case."""

    start: dict[str, float]
    seconds: list[float] = field(default_factory=list)
    answers: list[np.ndarray | None] = field(default_factory=list)
    lost: str | None = None

    @property
    def spent_s(self) -> float:
        """Time used so far."""
        return sum(self.seconds)


def run_case(
    case: Case, warm_up: Case, clients: list[Client], options: argparse.Namespace, folder: Path
) -> dict[str, Any]:
    """All peers on one case, after a few targets that do not count."""
    setup = write_setup(case, options, folder)
    tallies = {}
    for client in clients:
        try:
            tallies[client.name] = Tally(client.prepare(setup, warm_up.p, warm_up.R, options.limit))
        except Lost as lost:
            tallies[client.name] = Tally({}, lost=str(lost))
        say(case, client, tallies[client.name].lost or "ready")
    order = np.random.default_rng(options.seed)
    while waiting := [c for c in clients if is_waiting(tallies[c.name], len(case.p), options)]:
        for index in order.permutation(len(waiting)):
            take_turn(waiting[index], tallies[waiting[index].name], case, options)
    return {name: summarise(case, tally, options) for name, tally in tallies.items()}


def is_waiting(tally: Tally, count: int, options: argparse.Namespace) -> bool:
    """Whether a peer has targets and time left."""
    done = len(tally.answers)
    return tally.lost is None and done < count and (done < options.least or tally.spent_s < options.share)


def take_turn(client: Client, tally: Tally, case: Case, options: argparse.Namespace) -> None:
    """One peer's next targets."""
    first = len(tally.answers)
    last = min(first + (options.chunk if not client.batch else 10 * options.chunk), len(case.p))
    try:
        answers = client.solve(case.p[first:last], case.R[first:last], options.limit, options.slice)
    except Lost as lost:
        tally.lost = str(lost)
        say(case, client, tally.lost)
        return
    tally.seconds += [seconds for seconds, _ in answers]
    tally.answers += [q for _, q in answers]


def write_setup(case: Case, options: argparse.Namespace, folder: Path) -> Setup:
    """The case's robot as files."""
    stem = case.name.replace(" ", "_")
    urdf, mjcf = folder / f"{stem}.urdf", folder / f"{stem}.xml"
    urdf.write_text(ikde.format_urdf(case.robot))
    mjcf.write_text(ikde.format_mjcf(case.robot))
    tolerances = {"position_tolerance_m": options.tolerance[0], "orientation_tolerance_rad": options.tolerance[1]}
    return Setup(robot=case.robot, urdf=urdf, mjcf=mjcf, kind=case.kind, seed=options.seed, **tolerances)


def grade(case: Case, answers: list[np.ndarray | None], options: argparse.Namespace) -> np.ndarray:
    """Which answers [T] plain numpy accepts; no answer is none."""
    robot = case.robot
    Q = np.array([robot.home if q is None or not np.all(np.isfinite(q)) else q for q in answers])
    settings = ikde.SolveSettings(
        position_tolerance_m=options.tolerance[0], orientation_tolerance_rad=options.tolerance[1]
    )
    accepted = verify_many(robot, case.targets()[: len(Q)], Q, settings, robot.detector(None)).accepted
    return accepted & np.array([q is not None for q in answers])


def summarise(case: Case, tally: Tally, options: argparse.Namespace) -> dict[str, Any]:
    """Shares and times of one peer in one case; times over all targets it was asked, solved or not."""
    record: dict[str, Any] = {**{k: round(v, 4) for k, v in tally.start.items()}, "asked": len(tally.answers)}
    if tally.lost:
        record["lost"] = tally.lost
    if not tally.answers:
        return record
    solved = grade(case, tally.answers, options)
    ms = np.array(tally.seconds) * 1e3
    record["solved"] = int(solved.sum())
    record["returned"] = sum(q is not None for q in tally.answers)
    record["ms"] = {
        **{name: shorten(np.percentile(ms, p)) for name, p in (("median", 50), ("p95", 95), ("p99", 99), ("max", 100))},
        "mean": shorten(ms.mean()),
    }
    times = np.sort(ms[solved])
    if times.size:
        picks = np.unique(np.linspace(0, times.size - 1, CURVE_POINTS).astype(int))
        record["curve"] = [[shorten(times[k]), round((k + 1) / len(ms), 6)] for k in picks]
    return record


def shorten(value: float) -> float:
    """Four digits."""
    return float(f"{value:.4g}")


def say(case: Case, client: Client, text: str) -> None:
    """Progress on stdout."""
    print(f"{case.name}: {client.name}: {text}", flush=True)


def read_options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", type=int, default=1000, help="targets a case")
    parser.add_argument("--cases", nargs="+", choices=NAMES, default=NAMES)
    parser.add_argument("--only", nargs="+", default=None, metavar="WORD", help="peers whose name holds a word")
    parser.add_argument("--tolerance", nargs=2, type=float, default=(1e-4, 1e-3), metavar=("M", "RAD"))
    parser.add_argument("--limit", type=float, default=10.0, help="seconds a target")
    parser.add_argument("--share", type=float, default=60.0, help="seconds a peer and case")
    parser.add_argument("--least", type=int, default=20, help="targets that even a slow peer is asked")
    parser.add_argument("--slice", type=float, default=1.0, help="seconds a turn")
    parser.add_argument("--chunk", type=int, default=100, help="targets a turn, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS)
    return parser.parse_args()


def main() -> None:
    """Run, print a line a peer, write the record."""
    options = read_options()
    words = options.only
    described = [d for d in list_peers() if words is None or any(w in f"{d.adapter} {d.name}" for w in words)]
    missing, clients = {}, []
    for description in described:
        try:
            clients.append(Client(description))
        except Lost as lost:
            missing[description.name] = str(lost)
            print(f"left out: {description.name}: {lost}", flush=True)
    record = {
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": {**describe_machine(), **describe_versions()},
        "options": {k: v for k, v in vars(options).items() if k not in ("out", "only", "cases")},
        "peers": {c.name: {"import_s": c.import_s, "versions": c.versions, "use": c.use} for c in clients},
        "missing": missing,
        "cases": {},
    }
    record["machine"].pop("cpu_flags")
    with tempfile.TemporaryDirectory() as folder:
        for name in options.cases:
            drawn, n = make_case(name, options.targets + WARM_UP), options.targets
            case, warm_up = (replace(drawn, p=drawn.p[rows], R=drawn.R[rows]) for rows in (slice(n), slice(n, None)))
            record["cases"][name] = run_case(case, warm_up, clients, options, Path(folder))
            print_case(name, record["cases"][name])
            options.out.parent.mkdir(parents=True, exist_ok=True)
            options.out.write_text(format_record(record))
    for client in clients:
        client.close()


def format_record(record: dict[str, Any]) -> str:
    """JSON with a line a curve."""
    text = json.dumps(record, indent=1, default=str)
    return re.sub(r"\[\s+\[[^{}]*?\]\s+\]", lambda match: "".join(match[0].split()), text) + "\n"


def print_case(name: str, peers: dict[str, Any]) -> None:
    """A line a peer."""
    print(f"\n{name}: solved of asked, ms median / p95 / p99 / max")
    for peer, row in sorted(peers.items(), key=lambda item: item[1].get("ms", {}).get("median", np.inf)):
        if "ms" in row:
            times = " / ".join(f"{row['ms'][k]:.4g}" for k in ("median", "p95", "p99", "max"))
            print(f"  {peer:42} {row['solved']:6} of {row['asked']:6} ({row['returned']} returned)  {times}")
        else:
            print(f"  {peer:42} {row.get('lost')}")


if __name__ == "__main__":
    main()
