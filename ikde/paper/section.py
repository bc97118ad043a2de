"""What the sections of the report share: their three parts, printed values beside ours, and what a detector sees."""

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np

from ikde.batch.statistics import Spread
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.plot.images import to_png
from ikde.plot.pose import plot_pose
from ikde.report.numbers import significant
from ikde.report.page import Figure
from ikde.scene.drawn_pose import draw_pose
from ikde.solver.check import check

Value = TypeVar("Value")
Misprint = dict[str, Any] | None
"""What a printed entry should say, by its keys, and `see`: the place in the list of misprints; None if it is right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Computed:
    """A section as it is computed: all fields but `measured` (times) and `settings` are the same bits in every run."""

    settings: dict[str, Any]  # how it was made, for the record

    def as_json(self) -> dict[str, Any]:
        """Plain data in three parts, as it comes back from a JSON file."""
        data = asdict(self)
        parts = {"measured": data.pop("measured", {}), "settings": data.pop("settings")}
        return json.loads(json.dumps({"exact": data, **parts}, allow_nan=False))


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedOurs(Generic[Value]):
    """A printed value beside ours."""

    printed: Value
    ours: Value


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedMeant(Generic[Value]):
    """A printed value, and what it should be."""

    printed: Value
    meant: Value


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedMeantOurs(PrintedMeant[Value]):
    """A printed value, what it should be, and ours."""

    ours: Value


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What a detector says of one configuration."""

    collides: bool
    clearance_mm: float
    pair: list[str]  # the closest
    colliding_pairs: list[list[str]]


def judge(robot: Robot, q: np.ndarray, detector: str) -> Verdict:
    """The verdict of a named detector on `q` [N], in the robot's own convention."""
    pairs = check(robot, q, detector).pairs
    colliding = [[pair.a, pair.b] for pair in pairs if pair.collides]
    return Verdict(
        collides=bool(colliding),
        clearance_mm=1e3 * pairs[0].clearance_m,
        pair=[pairs[0].a, pairs[0].b],
        colliding_pairs=colliding,
    )


def make_collision(robot: Robot, spheres: str, pairs: str) -> CollisionModel:
    """An approximation over a list of pairs."""
    return CollisionModel(robot=robot, detector=replace(robot.detectors[spheres], pairs=pairs))


def name_pairs(pairs: Iterable[list[str]]) -> str:
    """`(G, L1), (G, L2)`; a dash of none."""
    return ", ".join(f"({a}, {b})" for a, b in pairs) or "–"


def format_spread(values: Spread) -> str:
    """`1.50 / 5.64 / 94.0`: median, 95th percentile, maximum."""
    return " / ".join(map(significant, (values.median, values.p95, values.max)))


def format_range(show: Callable[[float], str], middle: float, low: float, high: float) -> str:
    """`73.0 (63.6 to 80.7)`."""
    return f"{show(middle)} ({show(low)} to {show(high)})"


def draw_robot(
    collision: CollisionModel, q: Sequence[float], *, caption: str, target_mm: Sequence[float] | None = None
) -> Figure:
    """The robot at `q` as a detector sees it: arm red, platform blue, colliding components black; small for a page."""
    target = None if target_mm is None else Target(np.array(target_mm) * 1e-3)
    pose = draw_pose(collision, np.array(q), target=target)
    return Figure(image=to_png(plot_pose(pose, size_in=(6.4, 5.7)), dpi=84), alt=caption, caption=caption)
