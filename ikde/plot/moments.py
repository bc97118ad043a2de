"""The robot at moments of a motion, with its path: spheres as circles seen from afar, collisions black.

Seen from far away a sphere is a circle of its radius, so a few hundred of them are drawn in no time, far ones first.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import show_as_text
from ikde.plot.pose import ARM, BASE, COLLIDING, TARGET, base_components, compute_bones
from ikde.solver.plain import compute_components
from ikde.track.summary import TrackSummary

MOMENTS = 8
NAMED = 2  # colliding parts in a title
COLUMNS = 4
ELEVATION_DEG, AZIMUTH_DEG = 22.0, -55.0
PATH, BONES, GROUND = "0.55", "#202020", "0.75"
MARGIN_M = 0.05
GRID_M = 0.5


def choose_moments(motion: TrackSummary, count: int = MOMENTS) -> list[int]:
    """Samples from the first to the last, evenly; where one nearby collides the worst of those is shown instead."""
    last = len(motion.trajectory.q) - 1
    even = np.unique(np.linspace(0, last, count).round().astype(int))
    edges = np.concatenate([[0], (even[1:] + even[:-1] + 1) // 2, [last + 1]])
    gaps = motion.verification.gaps_m.min(axis=1, initial=np.inf)
    chosen = []
    for sample, first, end in zip(even, edges[:-1], edges[1:], strict=True):
        wrong = [k for k in range(first, end) if motion.colliding[k]]
        chosen.append(int(min(wrong, key=lambda k: gaps[k])) if wrong else int(sample))
    return chosen


def plot_moments(motion: TrackSummary, samples: Sequence[int] | None = None) -> Any:
    """Small views of the robot at `samples`, all from the same place and at one scale."""
    from matplotlib.figure import Figure

    samples = choose_moments(motion) if samples is None else samples
    rows = -(-len(samples) // COLUMNS)
    view = _look()
    box = _window(motion, samples, view)
    width, height = 2.4, 2.4 * min(1.5, max(0.55, float(box[1, 1] - box[0, 1]) / float(box[1, 0] - box[0, 0]))) + 0.28
    columns = min(len(samples), COLUMNS)
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    for number, sample in enumerate(samples, 1):
        axes = figure.add_subplot(rows, columns, number)
        _draw_ground(axes, motion, samples, view)
        _draw_path(axes, motion, sample, view)
        _draw_robot(axes, motion, sample, view)
        time = motion.trajectory.times_s[sample]
        told = _tell_collision(motion.colliding[sample])
        axes.set_title(f"t = {time:.2f} s{told}", fontsize=8, color="#b00000" if told else COLLIDING)
        axes.set(xlim=box[:, 0], ylim=box[:, 1], aspect="equal")
        axes.set_axis_off()
    return show_as_text(figure)


def _tell_collision(names: set[str]) -> str:
    """What collides, in few words: there is little room above a view."""
    if not names:
        return ""
    return f": {', '.join(sorted(names)) if len(names) <= NAMED else f'{len(names)} parts'} collide"


def _look() -> Floats:
    """Rows [3, 3]: right, up and towards the eye, in the world."""
    elevation, azimuth = np.radians([ELEVATION_DEG, AZIMUTH_DEG])
    eye = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.array([right, np.cross(eye, right), eye])


def _window(motion: TrackSummary, samples: Sequence[int], view: Floats) -> Floats:
    """Lower and upper corner [2, 2] of what all views show."""
    path = motion.trajectory.path.p_world_tool @ view[:2].T
    lows, highs = [path.min(axis=0)], [path.max(axis=0)]
    for centres, radii in _spheres(motion, motion.trajectory.q[list(samples)]).values():
        flat = centres @ view[:2].T
        lows.append((flat - radii[:, None]).min(axis=(0, 1)))
        highs.append((flat + radii[:, None]).max(axis=(0, 1)))
    chain = compute_bones(motion.robot, motion.trajectory.q[list(samples)]) @ view[:2].T
    lows.append(chain.min(axis=(0, 1)))
    highs.append(chain.max(axis=(0, 1)))
    return np.array([np.min(lows, axis=0) - MARGIN_M, np.max(highs, axis=0) + MARGIN_M])


def _spheres(motion: TrackSummary, q: Floats) -> dict[str, tuple[Floats, Floats]]:
    return compute_components(motion.collision, q)


def _draw_ground(axes: Any, motion: TrackSummary, samples: Sequence[int], view: Floats) -> None:
    """A grid on the floor below path and robot."""
    bases = compute_bones(motion.robot, motion.trajectory.q[list(samples)])[:, 0, :2]
    around = np.concatenate([motion.trajectory.path.p_world_tool[:, :2], bases])
    low, high = (GRID_M * np.floor(around.min(axis=0) / GRID_M), GRID_M * np.ceil(around.max(axis=0) / GRID_M))
    lines = [[(x, low[1], 0.0), (x, high[1], 0.0)] for x in np.arange(low[0], high[0] + 1e-9, GRID_M)]
    lines += [[(low[0], y, 0.0), (high[0], y, 0.0)] for y in np.arange(low[1], high[1] + 1e-9, GRID_M)]
    for line in lines:
        axes.plot(*(np.array(line) @ view[:2].T).T, color=GROUND, linewidth=0.4, zorder=0)


def _draw_path(axes: Any, motion: TrackSummary, sample: int, view: Floats) -> None:
    """The whole path, what was run of it, and where the tool should be."""
    path = motion.trajectory.path.p_world_tool @ view[:2].T
    axes.plot(*path.T, color=PATH, linewidth=0.8, zorder=1)
    axes.plot(*path[: sample + 1].T, color=TARGET, linewidth=1.4, zorder=900)
    axes.plot(*path[sample], marker="o", markersize=3, color=TARGET, zorder=901)


def _draw_robot(axes: Any, motion: TrackSummary, sample: int, view: Floats) -> None:
    from matplotlib.patches import Circle

    q, black = motion.trajectory.q[sample], motion.colliding[sample]
    base = base_components(motion.collision)
    circles = []
    for name, (centres, radii) in _spheres(motion, q).items():
        color = COLLIDING if name in black else BASE if name in base else ARM
        circles += [(*(centre @ view.T), radius, color) for centre, radius in zip(centres, radii, strict=True)]
    for order, (x, y, _, radius, color) in enumerate(sorted(circles, key=lambda circle: circle[2])):
        look = {"facecolor": color, "edgecolor": "white", "linewidth": 0.35, "alpha": 0.62}
        axes.add_patch(Circle((x, y), radius, zorder=2 + order, **look))
    bones = compute_bones(motion.robot, q) @ view[:2].T
    axes.plot(*bones.T, "o-", color=BONES, linewidth=1.0, markersize=1.6, zorder=800)
