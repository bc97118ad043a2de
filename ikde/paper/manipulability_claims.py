"""What Dong and Zhao say of both measures, each with figures that hold or a counter-example."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Literal

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.paper.optima import mirror_deg
from ikde.paper.tracked_arm import (
    TrackedArm,
    compute_base_jacobian,
    compute_jacobian,
    compute_reach,
    compute_w1,
    compute_w2,
)

Verdict = Literal["true", "half true", "only for l_m = 0", "false", "too strong"]
SEED, ARMS, HEADINGS, TURNS = 2012, 300, 12, 720
EXAMPLE_DEG = (30.0, 20.0, 60.0, -45.0)  # any posture: theta2 is solved for where it is to be singular
HELD_DEG = (40.0, 30.0)  # theta3, theta4 while theta2 turns


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """A number that shows it; a share of cases is one of 1."""

    name: str
    value: float
    is_share: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A sentence of the paper, what is to be said of it, and the numbers that show it."""

    place: str
    claim: str
    verdict: Verdict
    shown: list[Shown]


@dataclass(frozen=True, slots=True, kw_only=True)
class Singular:
    """A configuration, whether the paper lists it, and w1 there without and with the arm's offset."""

    theta_deg: list[float]
    listed: bool
    w1_without_offset: float
    w1_with_offset: float


def compute_claims(arm: TrackedArm) -> list[Claim]:
    """Every claim of sections 3.1 and 3.2 that can be tested without the pictures."""
    return [*_claim_heading(arm), *_claim_theta1(arm), *_claim_singular(arm), _claim_rank(arm), _claim_mirror(arm)]


def draw_arms(arm: TrackedArm, offset_m: float, count: int = ARMS) -> list[tuple[TrackedArm, Floats]]:
    """Random arms of that chain, each with a posture [4] in rad."""
    rng = np.random.default_rng(SEED)
    drawn = []
    for _ in range(count):
        l1, l2, l3 = rng.uniform(0.05, 0.6, 3).tolist()
        track, theta = float(rng.uniform(0.2, 0.6)), rng.uniform(-np.pi, np.pi, 4)
        drawn.append((replace(arm, links_m=(l1, l2, l3), arm_offset_m=offset_m, track_m=track), theta))
    return drawn


def measure(jacobian: Floats) -> Floats:
    """det(J J^T) [...]."""
    return np.linalg.det(jacobian @ np.swapaxes(jacobian, -1, -2))


def _claim_heading(arm: TrackedArm) -> list[Claim]:
    """Change of both determinants with the heading: w2 of its size, w1 of the largest that its J1 could give."""
    headings, changes = np.linspace(-np.pi, np.pi, HEADINGS), []
    for one, theta in draw_arms(arm, arm.arm_offset_m):
        J1, J2 = (f(one, np.tile(theta, (HEADINGS, 1)), headings) for f in (compute_base_jacobian, compute_jacobian))
        w1, w2, size = measure(J1), measure(J2), np.trace(J1[0] @ J1[0].T) ** 2
        changes.append((np.ptp(w1) / size, np.ptp(w2) / w2[0]))
    worst1, worst2 = (Shown(name="largest change", value=float(worst)) for worst in np.max(changes, axis=0))
    said = "has nothing to do with the course angle"
    return [
        Claim(place="below (13)", claim=f"w1 {said}", verdict="true", shown=[worst1]),
        Claim(place="below (15)", claim=f"w2 {said}", verdict="true", shown=[worst2]),
    ]


def find_best_theta1_deg(arm: TrackedArm, theta: Floats) -> float:
    """Where w2 is largest as theta1 turns: 0, 180, or the angle between, in half degrees."""
    firsts = np.radians(np.arange(TURNS) * 360.0 / TURNS)
    rows = np.tile(theta, (TURNS, 1))
    rows[:, 0] = firsts
    values = compute_w2(arm, rows)
    ends = {0.0: values[0], 180.0: values[TURNS // 2]}
    end = max(ends, key=lambda angle: ends[angle])
    return end if values.max() <= ends[end] * (1.0 + 1e-9) else float(np.degrees(firsts[int(values.argmax())]))


def _claim_theta1(arm: TrackedArm) -> list[Claim]:
    shown1, shown2 = [], []
    for name, offset in (("l_m = 0", 0.0), (f"l_m = {arm.arm_offset_m:g} m", arm.arm_offset_m)):
        drawn = draw_arms(arm, offset)
        ends = np.array([[compute_w1(one, [at, *theta[1:]]) for at in (0.0, np.pi)] for one, theta in drawn]).T
        ties, best = np.isclose(*ends, rtol=1e-9, atol=0.0), [find_best_theta1_deg(*pair) for pair in drawn]
        elsewhere = float(np.mean([at not in (0.0, 180.0) for at in best]))
        shown1.append(Shown(name=f"{name}: as large at 180 in", value=float(ties.mean()), is_share=True))
        shown1.append(Shown(name="larger there in", value=float((~ties & (ends[1] > ends[0])).mean()), is_share=True))
        shown2.append(Shown(name=f"{name}: largest neither at 0 nor at 180 in", value=elsewhere, is_share=True))
    return [
        Claim(place="below (14)", claim="w1 is largest at theta1 = 0", verdict="half true", shown=shown1),
        Claim(place="section 3.2", claim="so is w2 (implied: it names no theta1)", verdict="half true", shown=shown2),
    ]


def _claim_singular(arm: TrackedArm) -> list[Claim]:
    rows = list_singular(arm)
    sideward = [row for row in rows if row.listed and abs(row.theta_deg[0]) == 90.0]
    upright = [row for row in rows if row.listed and row not in sideward]
    unlisted = [row for row in rows if not row.listed]
    claims = []
    for place, claim, chosen in (
        ("below (14), 1", "w1 = 0 at theta1 = ±90", sideward),
        ("below (14), 2", "w1 = 0 at theta2 = 90, theta3 and theta4 each 0 or ±180", upright),
    ):
        shown = [
            Shown(name="l_m = 0: largest w1 there", value=max(row.w1_without_offset for row in chosen)),
            Shown(name="with l_m: least", value=min(row.w1_with_offset for row in chosen)),
            Shown(name="which is (l_m / b)² =", value=(arm.arm_offset_m / arm.track_m) ** 2),
        ]
        claims.append(Claim(place=place, claim=claim, verdict="only for l_m = 0", shown=shown))
    zeros = max(min(row.w1_without_offset, row.w1_with_offset) for row in unlisted)
    shown = [Shown(name="two that are not listed: w1", value=zeros)]
    return [*claims, Claim(place="below (14)", claim="these are all (implied)", verdict="false", shown=shown)]


def list_singular(arm: TrackedArm) -> list[Singular]:
    """The listed configurations, and one on the surface l_m = R cos theta1 that is not, for each of both offsets."""
    without = replace(arm, arm_offset_m=0.0)
    upright = [[EXAMPLE_DEG[0], 90.0, t3, t4] for t3, t4 in product((0.0, 180.0, -180.0), repeat=2)]
    sideward = [[side, *EXAMPLE_DEG[1:]] for side in (90.0, -90.0)]
    unlisted = [[EXAMPLE_DEG[0], solve_singular_deg(one), *EXAMPLE_DEG[2:]] for one in (without, arm)]
    return [
        Singular(
            theta_deg=theta,
            listed=listed,
            w1_without_offset=float(compute_w1(without, np.radians(theta))),
            w1_with_offset=float(compute_w1(arm, np.radians(theta))),
        )
        for rows, listed in ((sideward, True), (upright, True), (unlisted, False))
        for theta in rows
    ]


def solve_singular_deg(arm: TrackedArm, theta_deg: tuple[float, float, float, float] = EXAMPLE_DEG) -> float:
    """The theta2 in deg that makes w1 = 0 with the other angles: R = A cos theta2 + B sin theta2 = l_m / cos theta1.

    Raises ValueError where the arm is too short for that.
    """
    first, _, third, fourth = np.radians(theta_deg)
    A, B = (float(compute_reach(arm, np.array([first, at, third, fourth])).outward) for at in (0.0, 0.5 * np.pi))
    wanted, longest = arm.arm_offset_m / np.cos(first), np.hypot(A, B)
    if abs(wanted) > longest:
        raise ValueError(f"E reaches {longest:g} m outward, {wanted:g} are wanted")
    return float(np.degrees(np.arctan2(B, A) + np.arccos(wanted / longest)))


def _claim_rank(arm: TrackedArm) -> Claim:
    singular = np.radians(next(row.theta_deg for row in reversed(list_singular(arm)) if not row.listed))
    largest, least = np.linalg.svd(compute_base_jacobian(arm, singular))[1].tolist()
    return Claim(
        place="below (14)",
        claim="where w1 = 0 the platform contributes nothing to E in the plane",
        verdict="too strong",
        shown=[
            Shown(name="singular values of J1 there:", value=largest),
            Shown(name="and", value=least),
        ],
    )


def _claim_mirror(arm: TrackedArm) -> Claim:
    """Not in the paper, but of every optimum in it."""

    def change(offset_m: float, moved: Callable[[Floats], Any]) -> float:
        worst = 0.0
        for one, theta in draw_arms(arm, offset_m):
            theta[0] = 0.0
            other = compute_w2(one, np.radians(moved(np.degrees(theta))))
            worst = max(worst, float(abs(other / compute_w2(one, theta) - 1.0)))
        return worst

    def turn(theta_deg: Floats) -> Floats:
        return theta_deg + np.array([0.0, 180.0, 0.0, 0.0])

    offset = arm.arm_offset_m
    return Claim(
        place="section 3.2",
        claim="there is one optimum (implied)",
        verdict="false",
        shown=[
            Shown(name="theta1 = 0: w2 changes, at −theta2, −theta3, −theta4, by", value=change(offset, mirror_deg)),
            Shown(name="at theta2 + 180, l_m = 0, by", value=change(0.0, turn)),
            Shown(name="with l_m by a factor of up to", value=1.0 + change(offset, turn)),
        ],
    )


def compute_rigidity(arm: TrackedArm) -> dict[str, Any]:
    """How long |ME| is while theta2 alone turns: of a rigid arm it stays."""
    theta = np.zeros((TURNS, 4))
    theta[:, 1] = np.radians(np.arange(TURNS) * 360.0 / TURNS)
    theta[:, 2:] = np.radians(HELD_DEG)
    reach = compute_reach(arm, theta)
    length = np.hypot(reach.outward, reach.upward)
    return {
        "chain": arm.chain.name,
        "outward": list(arm.chain.outward),
        "upward": list(arm.chain.upward),
        "least_m": float(length.min()),
        "largest_m": float(length.max()),
        "is_rigid": arm.chain.is_rigid,
    }
