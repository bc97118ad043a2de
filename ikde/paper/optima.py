"""Where the second measure of Dong and Zhao is largest: over two angles by grid, over three by grid and by search.

Angles on the outside are in deg, within 0 .. 360; theta1 is 0, as the paper's figures leave it unsaid.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.paper.evolve import evolve
from ikde.paper.tracked_arm import TrackedArm, compute_curvature, compute_slope, compute_w2

PAIR_STEP_DEG, SPACE_STEP_DEG = 1.5, 4.5  # the printed optima lie on the first; both divide the printed third angles
TURN_DEG = 360.0
FREE = (1, 2, 3)  # theta2 .. theta4 among theta1 .. theta4


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """A figure of the paper: two angles vary, the third stays; `at_deg` is the printed optimum, theta1 .. theta4."""

    figure: int
    pair: tuple[int, int]
    third: int
    at_deg: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """A largest value and where it is, theta1 .. theta4."""

    theta_deg: list[float]
    w2: float


def turn_axis(step_deg: float) -> Floats:
    """A turn in equal steps, its end left out."""
    return np.arange(0.0, TURN_DEG - 1e-9, step_deg)


def spread_pair(surface: Surface, step_deg: float = PAIR_STEP_DEG) -> Floats:
    """Rows theta [n, n, 4] in rad over a figure's plane, its first angle down the rows."""
    axis = turn_axis(step_deg)
    theta = np.empty((len(axis), len(axis), 4))
    theta[:] = surface.at_deg
    theta[..., surface.pair[0]], theta[..., surface.pair[1]] = axis[:, None], axis
    return np.radians(theta)


def find_pair_peak(arm: TrackedArm, surface: Surface, step_deg: float = PAIR_STEP_DEG) -> Peak:
    """The largest value on a figure's grid."""
    theta = spread_pair(surface, step_deg).reshape(-1, 4)
    return _name_peak(arm, theta[int(compute_w2(arm, theta).argmax())])


def fall_short(arm: TrackedArm, surface: Surface, peak: Peak | None = None, step_deg: float = PAIR_STEP_DEG) -> float:
    """How far the value at the printed optimum is below the largest of its figure, as a share of that; 0 at best.

    `peak` is that of the figure's grid, if it is known.
    """
    here = float(compute_w2(arm, np.radians(surface.at_deg)))
    return 1.0 - here / max(here, (peak or find_pair_peak(arm, surface, step_deg)).w2)


def find_peak_by_grid(arm: TrackedArm) -> tuple[Peak, dict[int, Floats]]:
    """The peak over theta2 .. theta4, climbed from the best of a grid; and the best over the two others along each."""
    axis = np.radians(turn_axis(SPACE_STEP_DEG))
    theta = np.zeros((len(axis), len(axis), 4))
    theta[..., 2], theta[..., 3] = axis[:, None], axis
    values = np.empty((len(axis),) * 3)
    for row, angle in enumerate(axis):
        theta[..., 1] = angle
        values[row] = compute_w2(arm, theta)
    best = np.unravel_index(int(values.argmax()), values.shape)
    along = {angle: values.max(axis=tuple({0, 1, 2} - {angle - 1})) for angle in FREE}
    return _name_peak(arm, climb(arm, np.array([0.0, *axis[list(best)]]), FREE)), along


def find_peak_by_evolution(arm: TrackedArm) -> Peak:
    """The same peak by differential evolution, climbed from its best."""
    found, _ = evolve(lambda x: -compute_w2(arm, np.insert(x, 0, 0.0, axis=1)), [0.0] * 3, [2.0 * np.pi] * 3)
    return _name_peak(arm, climb(arm, np.array([0.0, *found]), FREE))


def climb(arm: TrackedArm, theta: Floats, free: Sequence[int], steps: int = 30) -> Floats:
    """The top [4] of the hill that `theta` [4] in rad stands on, by Newton's steps of the `free` angles, shortened."""
    free, theta = list(free), np.array(theta, dtype=float)
    for _ in range(steps):
        move = _step_uphill(arm, theta, free)
        length, here = 1.0, float(compute_w2(arm, theta))
        while length > 1e-9:
            there = theta.copy()
            there[free] += length * move
            if compute_w2(arm, there) >= here:
                break
            length *= 0.5
        else:
            return theta
        theta = there
    return theta


def _step_uphill(arm: TrackedArm, theta: Floats, free: list[int]) -> Floats:
    values, axes = np.linalg.eigh(compute_curvature(arm, theta)[np.ix_(free, free)])
    return axes @ ((axes.T @ compute_slope(arm, theta)[free]) / np.maximum(np.abs(values), 1e-6))


def newton_step_deg(arm: TrackedArm, surface: Surface) -> float | None:
    """How far a Newton step moves the pair from the printed optimum to its top; None where there is none."""
    theta, pair = np.radians(surface.at_deg), list(surface.pair)
    curvature = compute_curvature(arm, theta)[np.ix_(pair, pair)]
    if np.linalg.eigvalsh(curvature).max() >= 0.0:
        return None
    return float(np.degrees(np.linalg.norm(np.linalg.solve(curvature, compute_slope(arm, theta)[pair]))))


def wrap_deg(theta: Floats) -> list[float]:
    """Angles in deg within a turn, to a millionth."""
    return [round(value % TURN_DEG, 6) % TURN_DEG for value in np.degrees(theta).tolist()]


def mirror_deg(theta_deg: Sequence[float] | Floats) -> list[float]:
    """The other half of a pair of equal values at theta1 = 0: theta2 .. theta4 turned the other way."""
    return [theta_deg[0], *((TURN_DEG - angle) % TURN_DEG for angle in theta_deg[1:])]


def _name_peak(arm: TrackedArm, theta: Floats) -> Peak:
    return Peak(theta_deg=wrap_deg(theta), w2=float(compute_w2(arm, theta)))


def choose_half(peak: Peak) -> Peak:
    """Of a peak over all three angles and its mirror image the one that comes first: which is found is chance."""
    return Peak(theta_deg=min(peak.theta_deg, mirror_deg(peak.theta_deg)), w2=peak.w2)
