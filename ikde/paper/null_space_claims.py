"""What follows from the equations of [Zhang2022, sections 2 and 3] without a run: numbers that need no target."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import dead_reckon
from ikde.model.robot import Origin
from ikde.model.wheels import ground_speed, twist_by_wheels, wheels_by_twist
from ikde.paper.mecanum_arm import MecanumArm, Place, chain, links_modified, links_standard, rotation_about_z
from ikde.paper.null_space_laws import blend, closed_form_24, closed_form_25, exact, printed
from ikde.paper.null_space_runs import axis_ratio
from ikde.solver.priority import Level

SEED = 5
ARMS = 400
SPREAD_RAD = 0.5  # of random arms about the start, where no joint is near a singularity
SLIPPING = np.array([1.0, -1.0, -1.0, 1.0])
"""Mecanum wheels in this proportion move nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One number: what it is of, and whether it is published, derived, or rests on something calibrated."""

    equation: str
    what: str
    value: float
    unit: str
    kind: Origin


def compute_claims(arm: MecanumArm, start: Floats) -> list[Claim]:
    """Every number, in the order of the equations."""
    rng = np.random.default_rng(SEED)
    return [*_of_wheels(arm), *_of_table_2(arm, rng), *_of_laws(arm, start, rng), *_of_ellipsoids(arm, rng)]


def _derived(equation: str, what: str, value: float, unit: str = "") -> Claim:
    return Claim(equation=equation, what=what, value=float(value), unit=unit, kind="derived")


def _calibrated(equation: str, what: str, value: float, unit: str = "") -> Claim:
    """A number that depends on the mount and on where the wheels are."""
    return Claim(equation=equation, what=what, value=float(value), unit=unit, kind="calibrated")


def _of_wheels(arm: MecanumArm) -> list[Claim]:
    forward, inverse = twist_by_wheels(arm.wheels), wheels_by_twist(arm.wheels)
    gaps = measure_headings(dt_s=0.1)
    turned, straight = _half_a_turn()
    return [
        _derived(
            "(1)", "forward times inverse, largest difference from 1", np.abs(forward @ inverse - np.eye(3)).max()
        ),
        _derived(
            "(1)", "forward against the pseudo-inverse of inverse", np.abs(forward - np.linalg.pinv(inverse)).max()
        ),
        *(_derived("(2)", f"one turn in 600 steps by the {name}: off by", gap, "m") for name, gap in gaps.items()),
        _derived("(3)", "after half a turn, speeds added up unturned: off by", np.hypot(*(turned - straight)), "m"),
        _derived(
            "(14)", "of the rim's speed at slip 0.8: what the ground sees", ground_speed(np.ones(1), np.full(1, 0.8))[0]
        ),
        _derived("(15)", "E + S makes of it", 1.8),
    ]


TWIST = np.array([0.05, 0.02, 2.0 * np.pi / 60.0])
"""m/s and rad/s: a whole turn in 60 s."""


def measure_headings(dt_s: float) -> dict[str, float]:
    """Largest distance, m, from the exact path in one turn of 60 s, by what (2) takes for the heading of a step."""
    steps = round(60.0 / dt_s)
    truth = exact_path(np.linspace(0.0, 60.0, steps + 1))
    found = {}
    for name, share in (("heading before the step", 0.0), ("heading after it", 1.0), ("heading half-way", 0.5)):
        headings = TWIST[2] * dt_s * (np.arange(steps) + share)
        shifts = (rotation_about_z(headings) @ np.r_[TWIST[:2], 0.0])[:, :2] * dt_s
        path = np.vstack([np.zeros(2), np.cumsum(shifts, axis=0)])
        found[name] = float(np.linalg.norm(path - truth, axis=1).max())
    arcs = dead_reckon(np.zeros(3), np.tile(TWIST, (steps, 1)), dt_s)[:, :2]
    return {**found, "exact arc": float(np.linalg.norm(arcs - truth, axis=1).max())}


def exact_path(t_s: Floats) -> Floats:
    """Where the constant twist has brought the platform [..., 2] at times [...], m."""
    vx, vy, w = TWIST
    s, c = np.sin(w * t_s), 1.0 - np.cos(w * t_s)
    return np.stack([vx * s - vy * c, vx * c + vy * s], axis=-1) / w


def _half_a_turn() -> tuple[Floats, Floats]:
    """Where the platform is, and where (3) puts it: the integral of speeds in its own frame."""
    return exact_path(np.array(30.0)), 30.0 * TWIST[:2]


def _of_table_2(arm: MecanumArm, rng: np.random.Generator) -> list[Claim]:
    q = rng.uniform(-np.pi, np.pi, (ARMS, 6))
    standard = chain(links_standard(arm.a, arm.d, arm.alpha, q))[:, -1]
    row_by_row = chain(links_modified(arm.a, arm.d, arm.alpha, q))[:, -1]
    shifted = chain(links_modified(np.r_[0.0, arm.a[:-1]], arm.d, np.r_[0.0, arm.alpha[:-1]], q))[:, -1]
    last = links_standard(arm.a[-1:], np.zeros(1), arm.alpha[-1:], np.zeros(1))[0]
    gaps = np.linalg.norm(row_by_row[:, :3, 3] - standard[:, :3, 3], axis=1)
    return [
        _derived(
            "(4), (5)",
            "Table 2 as the standard convention, and as the modified one with a and alpha a row down: differ by",
            np.abs(shifted @ last - standard).max(),
            "m",
        ),
        _derived("(4), (5)", "Table 2 read row by row with (5): the tool is off by, median", np.median(gaps), "m"),
        _derived("(4), (5)", "the same, largest", gaps.max(), "m"),
    ]


def draw_levels(arm: MecanumArm, start: Floats, rng: np.random.Generator, count: int = ARMS) -> tuple[Place, Floats]:
    """Random arms near the start on random platforms, and speeds [2, count, 3] for both tasks, m/s and rad/s."""
    platform, q = rng.uniform(-1, 1, (count, 3)), start + rng.uniform(-SPREAD_RAD, SPREAD_RAD, (count, 6))
    return arm.place(platform, q), 0.1 * rng.standard_normal((2, count, 3))


def _of_laws(arm: MecanumArm, start: Floats, rng: np.random.Generator) -> list[Claim]:
    place, (x1, x2) = draw_levels(arm, start, rng)
    claims = []
    for columns, tasks in (("wheels in rad/s", arm.tasks_by_wheels), ("platform in m/s", arm.tasks_by_platform)):
        tool, platform = (Level(J, x) for J, x in zip(tasks(place), (x1, x2), strict=True))
        one, other = printed(tool, platform), printed(platform, tool)
        first = max(_measure(tool, one).max(), _measure(platform, other).max())
        second = np.median(_measure(platform, one)), np.median(_measure(tool, other))
        claims += [
            _derived("(24), (25)", f"{columns}: the first task is missed by, largest share", first),
            _calibrated("(24)", f"{columns}: the second, the platform, is missed by, median share", second[0]),
            _calibrated("(25)", f"{columns}: the second, the tool, is missed by, median share", second[1]),
        ]
    gap = max(
        _norm(_times(platform.matrix, one) - closed_form_24(tool, platform)).max(),
        _norm(_times(tool.matrix, other) - closed_form_25(tool, platform)).max(),
    )
    right, swapped = exact(tool, platform), exact(platform, tool)
    missed = max(_measure(tool, right).max(), _measure(platform, right).max())
    return [
        *claims,
        _derived("(24), (25)", "against closed forms of what the second task gets, largest", gap, "m/s"),
        _derived("exact", "both tasks are missed by, largest share", missed),
        _derived("exact", "speeds of both orders differ by, largest", np.abs(right - swapped).max(), "rad/s"),
        *_of_psi(arm, place, x1, x2, rng),
    ]


def _of_psi(arm: MecanumArm, place: Place, x1: Floats, x2: Floats, rng: np.random.Generator) -> list[Claim]:
    """What (26) makes of the tool with psi a half, and with a psi that differs between the ten actuators."""
    J1, J2 = arm.tasks_by_wheels(place)
    tool, platform = Level(J1, x1), Level(J2, x2)
    laws = {
        "the printed laws": (printed(tool, platform), printed(platform, tool)),
        "exact ones": (exact(tool, platform), exact(platform, tool)),
    }
    claims = [
        _calibrated(
            "(26)",
            f"psi = 1/2 of {name}: the tool is missed by, median share",
            np.median(_measure(tool, blend(0.5, *pair))),
        )
        for name, pair in laws.items()
    ]
    psi = rng.random(10)
    mixed = psi * laws["the printed laws"][0] + (1.0 - psi) * laws["the printed laws"][1]
    return [
        *claims,
        _calibrated(
            "(26)", "a psi for each actuator: the tool is missed by, median share", np.median(_measure(tool, mixed))
        ),
        _calibrated(
            "(26)",
            "the same: wheels against each other, median",
            np.median(np.abs(mixed[:, :4] @ SLIPPING) / 2.0),
            "rad/s",
        ),
    ]


def _of_ellipsoids(arm: MecanumArm, rng: np.random.Generator) -> list[Claim]:
    place = arm.place(np.zeros((5000, 3)), rng.uniform(-np.pi, np.pi, (5000, 6)))
    ratios = axis_ratio(place.by_joints)
    return [
        _derived("(28)", f"ratio of the axes of random arms, {share} %", np.quantile(ratios, 0.01 * share))
        for share in (1, 50, 90, 99)
    ]


def _measure(level: Level, x: Floats) -> Floats:
    """What is missing [...] as a share of what is wanted."""
    return _norm(_times(level.matrix, x) - level.wanted) / _norm(level.wanted)


def _norm(x: Floats) -> Floats:
    return np.linalg.norm(x, axis=-1)


def _times(matrix: Floats, vector: Floats) -> Floats:
    return (matrix @ vector[..., None])[..., 0]
