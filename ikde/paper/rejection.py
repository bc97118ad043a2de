"""Table 4: how many solutions of a plain search each detector rejects; what of it is spheres, and what is pairs."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import product
from typing import Any

import numpy as np

from ikde.batch.statistics import Z_95, Rate, Spread, compute_spread
from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.paper.detection import check_centres_many, compare_pairs
from ikde.paper.inputs import APPROXIMATIONS, PAIR_LISTS, Inputs
from ikde.paper.plain_search import SEED, Setup, Solutions, collides, solve_plainly
from ikde.paper.section import Computed, make_collision
from ikde.paper.timing import clock, quartiles
from ikde.report.numbers import with_interval

READINGS: dict[str, dict[str, str]] = {
    "equal": {"typical": "formula_22", "improved": "formula_22"},
    "unequal": {"typical": "non_adjacent", "improved": "formula_22_printed"},
}
"""Which pairs each detector compares. `equal` compares the spheres alone. `unequal` is the one reading found that meets
all four printed rates: the typical detector compares every pair, the improved one those of Formula 22 to the letter."""
PAPERS_SAMPLE = 100
Grades = Mapping[tuple[str, str], np.ndarray]  # (spheres, pairs) -> whether each solution is rejected


@dataclass(frozen=True, slots=True, kw_only=True)
class RejectionRate:
    """CN of SN solutions are rejected."""

    CN: int
    SN: int
    rejected_pct: float | None  # None of nothing
    interval_pct: list[float]  # 95 %

    @property
    def text(self) -> str:
        """In % with its interval: `73.0 (63.6–80.7)`; a dash of nothing."""
        return "–" if self.rejected_pct is None else with_interval(self.rejected_pct, self.interval_pct)

    def contains(self, other: "RejectionRate") -> bool:
        """Whether another rate lies in this one's interval."""
        low, high = self.interval_pct
        return low <= other.percent <= high

    @property
    def percent(self) -> float:
        """The rate, NaN of nothing."""
        return float("nan") if self.rejected_pct is None else self.rejected_pct


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedRate(RejectionRate):
    """A cell of Table 4."""

    SR: float
    AT_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ListRate(RejectionRate):
    """Of one detector over one list of pairs."""

    spheres: str
    pairs: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PairedVerdicts:
    """Both detectors on the same solutions, in one reading."""

    reading: str
    both_free: int
    only_improved_free: int
    only_typical_free: int
    both_reject: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Gain:
    """By how many points fewer solutions are rejected, with the 95 % interval."""

    points: float
    interval_points: list[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class GainOrder:
    """A gain's two steps, the named one first."""

    first: str
    steps: list[Gain]


@dataclass(frozen=True, slots=True, kw_only=True)
class GainSplit:
    """From the typical detector over all pairs to the improved one over Formula 22 as printed, in points of the rate.

    In both orders, since spheres and pairs interact: what a step brings depends on what was changed before it.
    """

    total: Gain
    orders: list[GainOrder]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """The first so many solves of a target: what each detector over each list of pairs rejects of the solutions."""

    solves: int
    solved: int
    rates: list[ListRate]
    paired: list[PairedVerdicts]
    gain: GainSplit

    def rate(self, spheres: str, pairs: str) -> ListRate:
        """Of one detector over one list of pairs."""
        return next(rate for rate in self.rates if (rate.spheres, rate.pairs) == (spheres, pairs))


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetRates:
    """One target: the print, a sample as small as the paper's, and the whole one."""

    target: str
    position_mm: list[float]
    printed: dict[str, PrintedRate]
    printed_gain: Gain
    samples: list[Sample]


@dataclass(frozen=True, slots=True, kw_only=True)
class VerdictTime:
    """Microseconds of a mean verdict by centres, one after the other: median and quartiles of the rounds."""

    median: float
    quartiles: list[float]
    rounds: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectionTime:
    """The printed AT of a detector, and one verdict of ours."""

    spheres: str
    printed_AT_s: float
    verdict_us: VerdictTime


@dataclass(frozen=True, slots=True, kw_only=True)
class SolveTimes:
    """AT split: a solve's search, and one verdict on its solution, by centres."""

    target: str
    search_ms: Spread
    evaluations: Spread
    detection: list[DetectionTime]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rejection(Computed):
    """Both targets."""

    targets: list[TargetRates]
    measured: list[SolveTimes]


def compute_rejection(inputs: Inputs) -> Rejection:
    """Table 4, both targets: one set of solutions a target, graded by every detector."""
    robot, table, setup, count = inputs.robot, inputs.published["table_4"], Setup(), inputs.budget.solves
    dropped, added = compare_pairs(robot, *READINGS["unequal"].values())
    solutions = {
        name: solve_plainly(inputs, setup, target, count, first_stream=k * count)
        for k, (name, target) in enumerate(inputs.targets.items())
    }
    return Rejection(
        targets=[
            TargetRates(
                target=name,
                position_mm=inputs.published["targets_mm"][name],
                printed=read_print(table[name]),
                printed_gain=_unpaired_gain(*(Rate(row["CN"], row["SN"]) for row in table[name].values())),
                samples=[_grade_sample(robot, found.first(n), n) for n in sorted({min(PAPERS_SAMPLE, count), count})],
            )
            for name, found in solutions.items()
        ],
        measured=[_time_solves(inputs, name, found) for name, found in solutions.items()],
        settings={"lists": {"dropped": dropped, "added": added}, "readings": READINGS, **describe_setup(setup)},
    )


def describe_setup(setup: Setup) -> dict[str, Any]:
    """A setup, for the record."""
    settings = setup.settings
    tolerances = {name: getattr(settings, name) for name in ("position_tolerance_m", "orientation_tolerance_rad")}
    return {
        "source": "[Qiao2021, Table 4]",
        "seed": SEED,
        "base_half_width_mm": setup.base_half_width_m * 1e3,
        "limits": setup.limits,
        "search": {**tolerances, "restarts": settings.restarts, **asdict(settings.evolution)},
    }


def read_print(printed: Mapping[str, Any]) -> dict[str, PrintedRate]:
    """A target's printed cells by detector, with their rates."""
    return {
        spheres: PrintedRate(SR=row["SR"], AT_s=row["AT_s"], **rate_fields(row["CN"], row["SN"]))
        for spheres, row in printed.items()
    }


def rate_fields(CN: int, SN: int) -> dict[str, Any]:
    """Fields of a `RejectionRate`."""
    rate = Rate(CN, SN)
    return {
        "CN": CN,
        "SN": SN,
        "rejected_pct": 100 * rate.share if rate.total else None,
        "interval_pct": [100 * bound for bound in rate.interval],
    }


def _grade_sample(robot: Robot, Q: Floats, solves: int) -> Sample:
    rejected = {key: collides(make_collision(robot, *key), Q) for key in product(APPROXIMATIONS, PAIR_LISTS)}
    return Sample(
        solves=solves,
        solved=len(Q),
        rates=[ListRate(spheres=s, pairs=p, **rate_fields(int(v.sum()), len(Q))) for (s, p), v in rejected.items()],
        paired=[_pair_verdicts(name, rejected) for name in READINGS],
        gain=_split_gain(rejected),
    )


def _pair_verdicts(reading: str, rejected: Grades) -> PairedVerdicts:
    typical, improved = (rejected[key] for key in READINGS[reading].items())
    return PairedVerdicts(
        reading=reading,
        both_free=int((~typical & ~improved).sum()),
        only_improved_free=int((typical & ~improved).sum()),
        only_typical_free=int((~typical & improved).sum()),
        both_reject=int((typical & improved).sum()),
    )


def _split_gain(rejected: Grades) -> GainSplit:
    start, end = rejected["typical", "non_adjacent"], rejected["improved", "formula_22_printed"]
    between = {"spheres": rejected["improved", "non_adjacent"], "pairs": rejected["typical", "formula_22_printed"]}
    return GainSplit(
        total=paired_gain(start, end),
        orders=[
            GainOrder(first=first, steps=[paired_gain(start, middle), paired_gain(middle, end)])
            for first, middle in between.items()
        ],
    )


def paired_gain(before: np.ndarray, after: np.ndarray) -> Gain:
    """Of the same solutions: the 95 % interval is that of paired proportions."""
    count = max(len(before), 1)
    freed, lost = int((before & ~after).sum()), int((~before & after).sum())
    return _make_gain((freed - lost) / count, (freed + lost - (freed - lost) ** 2 / count) / count**2)


def _unpaired_gain(before: Rate, after: Rate) -> Gain:
    """Of two independent samples, as the print gives them."""
    variance = sum(rate.share * (1.0 - rate.share) / rate.total for rate in (before, after))
    return _make_gain(before.share - after.share, variance)


def _make_gain(share: float, variance: float) -> Gain:
    margin = Z_95 * variance**0.5
    return Gain(points=100 * share, interval_points=[100 * (share - margin), 100 * (share + margin)])


def _time_solves(inputs: Inputs, name: str, solutions: Solutions) -> SolveTimes:
    printed = inputs.published["table_4"][name]
    return SolveTimes(
        target=name,
        search_ms=spread_of(1e3 * solutions.seconds),
        evaluations=spread_of(solutions.evaluations),
        detection=[
            DetectionTime(spheres=s, printed_AT_s=printed[s]["AT_s"], verdict_us=_time_verdicts(inputs, s, solutions.Q))
            for s in APPROXIMATIONS
        ],
    )


def _time_verdicts(inputs: Inputs, spheres: str, Q: Floats) -> VerdictTime:
    collision, rounds = make_collision(inputs.robot, spheres, "formula_22"), inputs.budget.timing_rounds
    check_centres_many(collision, Q)  # compiles, or warms up
    seconds = [clock(lambda: check_centres_many(collision, Q)) / len(Q) for _ in range(rounds)]
    median, spread = quartiles(1e6 * np.array(seconds))
    return VerdictTime(median=median, quartiles=spread, rounds=rounds)


def spread_of(values: np.ndarray) -> Spread:
    """Median, 95th percentile and maximum of at least one number."""
    spread = compute_spread(values)
    assert spread is not None
    return spread
