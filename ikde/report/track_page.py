"""A motion as a page: what was measured, figures, and the robot moving."""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ikde import __version__
from ikde.plot.animation import make_animation
from ikde.plot.images import find_boxes, to_png, to_svg
from ikde.plot.moments import plot_moments
from ikde.plot.motion import (
    NEGLIGIBLE_M,
    plot_base,
    plot_errors,
    plot_joint_speeds,
    plot_joints,
    plot_margins,
    plot_path,
)
from ikde.report.markup import code, verbatim
from ikde.report.numbers import count_of, length, seconds
from ikde.report.page import (
    Animation,
    Block,
    Code,
    Column,
    Facts,
    Figure,
    Gallery,
    Notice,
    Number,
    Numbers,
    Page,
    Section,
    Table,
    Text,
)
from ikde.report.track import FIXED, gap_mm, list_figures
from ikde.scene.drawn_motion import MAX_OBSTACLES, choose_frames, choose_moments, draw_motion
from ikde.track.summary import TrackSummary

MOMENTS, MOMENTS_DPI = 8, 110
MAX_FRAMES = 251
MAX_LISTED = 12  # obstacles in the table of what comes nearest


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure of a motion: how it is made, and what is to be said about it."""

    make: Callable[[TrackSummary], Any]
    alt: str
    caption: str
    over_time: bool = True


PATH = Drawing(
    plot_path, "path in space", "Where the tool was asked to go and went, and where the base drove.", over_time=False
)
PATH_ALONE = replace(PATH, caption="Where the tool was asked to go and went.")  # of a robot that stands still
ERRORS = Drawing(
    plot_errors,
    "tracking errors over time",
    "The tool at the samples, and how far it leaves the path half-way between them: that is what the sampling costs.",
)
JOINTS = Drawing(plot_joints, "joint values of the arm over time", "Joints of the arm, and the ends of their ranges.")
SPEEDS = Drawing(
    plot_joint_speeds, "joint speeds of the arm over time", "Their speeds from sample to sample, and their limits."
)
BASE = Drawing(plot_base, "the base over time", "The base: its place, all its speeds, and their limits.")
MARGINS = Drawing(
    plot_margins,
    "what is left before the limits, over time",
    "The least share of a joint's range that is left to either end; the largest share of a joint's speed limit that is "
    "used.",
)


def draw(drawing: Drawing, motion: TrackSummary, prefix: str = "") -> Figure | None:
    """A figure of a motion; None if it has nothing to show."""
    figure = drawing.make(motion)
    if figure is None:
        return None
    image = to_svg(figure)
    boxes = find_boxes(figure) if drawing.over_time else ()
    return Figure(image=image, alt=prefix + drawing.alt, caption=drawing.caption, time_boxes=boxes)


def draw_moments(motion: TrackSummary, prefix: str = "", dpi: float = MOMENTS_DPI) -> Figure:
    """The robot at eight moments, as a picture."""
    image = to_png(plot_moments(draw_motion(motion, choose_moments(motion, MOMENTS))), dpi=dpi)
    caption = f"Arm red, base blue; the path grey, what was followed of it orange. {_tell_black(motion)}"
    caption += tell_obstacles(motion)
    return Figure(image=image, alt=f"{prefix}the robot at moments of its motion", caption=caption)


def animate(motion: TrackSummary, frames: int = MAX_FRAMES, prefix: str = "", caption: str = "") -> Animation:
    """The motion itself."""
    moving = make_animation(draw_motion(motion, choose_frames(motion, frames)))
    data = json.dumps(moving, separators=(",", ":"), allow_nan=False)
    return Animation(
        data=data,
        alt=f"{prefix}the robot moving, from the side, from the front, from above, and in space, to be turned",
        caption=caption,
    )


def make_track_page(motion: TrackSummary, title: str, command: str) -> Page:
    """What came of a track, followed to its end or not, as a page; `command` makes it again."""
    shown = _list_sections(motion) if motion.started else []
    return Page(
        title=title,
        subtitle=_describe(motion),
        lead=(*_warn(motion), *_headline(motion)),
        sections=(*shown, _make_recipe(motion, command)),
        footer=f"Made by ikde {__version__}.",
    )


def _describe(motion: TrackSummary) -> str:
    path, trajectory = motion.trajectory.path, motion.trajectory
    asked = {"free": "any orientation", "axis": "the tool's axis given", "pose": "the whole pose given"}
    return (
        f"A tool path followed by {motion.robot.name}: {path.samples:,} points in {path.duration_s:g} s, "
        f"{asked[path.orientation]}, {_name_base(motion)}, method {trajectory.method}."
    )


def _name_base(motion: TrackSummary) -> str:
    return f"{motion.trajectory.drive} drive" if motion.trajectory.base_joints else FIXED


def _warn(motion: TrackSummary) -> list[Block]:
    stop = motion.trajectory.stop
    if stop is None:
        return []
    below = "Everything below is about what was followed." if motion.started else "Nothing was followed."
    below = f"{motion.met_points} points reached. {below}"
    return [Notice(f"**The path was not followed to its end**: {verbatim(stop.line)}. {below}")]


def _headline(motion: TrackSummary) -> list[Block]:
    if not motion.started:
        return []
    trajectory, graded = motion.trajectory, motion.grade
    items = [
        Number(f"{motion.met_points} of {trajectory.path.samples}", "points reached"),
        Number(length(graded.largest_axis_error_m), "largest error of any axis", "at the samples"),
    ]
    items.append(_make_clearance(motion))
    kinds = "all kinds" if graded.violations.collision is not None else "all other kinds"
    items.append(Number(f"{graded.violations.total}", "limits broken", f"of {kinds}, at all samples"))
    if len(trajectory.seconds):
        median_s, most_s = (float(np.quantile(trajectory.seconds, share)) for share in (0.5, 0.99))
        items.append(Number(seconds(median_s), "a step, median", f"99 % within {seconds(most_s)}"))
    return [Numbers(tuple(items))]


def _make_clearance(motion: TrackSummary) -> Number:
    """The smallest clearance, and what is certain between samples."""
    clearance_m, proof = motion.grade.clearance_m, motion.certificate
    if clearance_m is None:
        return Number("not checked", "self-collision", "no detector")
    certain = f"{length(proof.clearance_m)} certified between" if proof else ""
    if not motion.collision.obstacles or motion.closest_pair is None or motion.closest_place is None:
        return Number(length(clearance_m), "smallest clearance at samples", certain)
    asked_m = motion.collision.limit_m + motion.collision.extra_m(motion.closest_place)
    apart = f" {length(clearance_m)} apart, {length(asked_m)} asked for" if asked_m else ""
    where = " and ".join(motion.closest_pair) + apart
    spare = length(clearance_m - asked_m)
    return Number(spare, "least to spare at samples", "; ".join(filter(None, (where, certain))))


def _tell_black(motion: TrackSummary) -> str:
    if not motion.collision.pairs:
        return "Self-collision was not checked."
    return "What collides is black, white on a dark page."


def tell_obstacles(motion: TrackSummary) -> str:
    """What is drawn of a world, and what the ring is; nothing without one."""
    count = len(motion.collision.obstacles)
    held = ", ".join(thing.name for thing in motion.collision.world.attached)
    held = f" What the robot holds is brown: {verbatim(held)}." if held else ""
    if not count:
        return held
    shown = f"The {MAX_OBSTACLES} nearest of {count:,} obstacles are" if count > MAX_OBSTACLES else "Obstacles are"
    moved = "; those that move are drawn where they are at each moment" * bool(motion.trajectory.moving)
    ring = "; the green ring is where there is the least room" if motion.closest_obstacle is not None else ""
    return f" {shown} grey, violet where anything is too near{moved}{ring}.{held}"


def _list_sections(motion: TrackSummary) -> list[Section]:
    moving = animate(
        motion,
        caption=f"Play it, drag the slider, or drag in a chart below; turn the view in space. {_tell_black(motion)}"
        + tell_obstacles(motion),
    )
    path = PATH if motion.trajectory.base_joints else PATH_ALONE
    groups = [
        ("Motion", [moving, draw_moments(motion)]),
        ("Clearance and limits", [draw(replace(MARGINS, caption=_tell_margins(motion)), motion), list_near(motion)]),
        ("Figures", [_make_measured(motion)]),
        ("Path and error", [*_tell_error(motion), _beside(draw(path, motion), draw(ERRORS, motion))]),
        ("Joints", [_beside(draw(JOINTS, motion), draw(SPEEDS, motion))]),
        ("Base", [draw(BASE, motion)]),
    ]
    sections = [(title, tuple(block for block in blocks if block is not None)) for title, blocks in groups]
    return [Section(title, blocks) for title, blocks in sections if blocks]


def _tell_margins(motion: TrackSummary) -> str:
    """What the figure shows: a clearance only if one was checked, and a bound only if there is one."""
    if motion.grade.clearance_m is None:
        return MARGINS.caption
    between = " and certified between them" if motion.certificate is not None else ""
    pairs = "any pair" if not motion.collision.obstacles else "any pair of components, and to any obstacle"
    return f"The smallest clearance of {pairs}, at the samples{between}. {MARGINS.caption}"


def list_near(motion: TrackSummary) -> Table | None:
    """The obstacles that come nearest, and which component, when, and how near; None without a world."""
    collision, own = motion.collision, len(motion.collision.pairs)
    if motion.closest_obstacle is None:
        return None
    count = len(collision.obstacles)
    room = motion.grade.gaps_m[:, own:].reshape(len(motion.trajectory.q), -1, count)
    least = room.min(axis=(0, 1))
    nearest = [k for k in np.argsort(least, kind="stable").tolist() if np.isfinite(least[k])][:MAX_LISTED]
    rows = []
    for k in nearest:
        sample, component = np.unravel_index(int(np.argmin(room[:, :, k])), room.shape[:2])
        extra_m = collision.extra_m(own + int(component) * count + k)
        time = f"{motion.trajectory.times_s[sample]:.2f} s, sample {sample}"
        name, asked = collision.components[component], gap_mm(collision.limit_m + extra_m)
        rows.append((collision.obstacles[k].name, name, gap_mm(float(least[k]) + extra_m), asked, time))
    more = f" Of {count:,} obstacles." if count > len(nearest) else ""
    return Table(
        columns=(
            *Column.of("obstacle", "component"),
            Column("clearance", "mm"),
            Column("asked for", "mm"),
            Column("when"),
        ),
        rows=tuple(rows),
        caption="What of the world comes nearest",
        note=f"At the samples, by plain numpy; what has the least room beyond what is asked for comes first.{more}",
    )


def _beside(*figures: Figure | None) -> Gallery | None:
    """Those figures that there are, side by side."""
    there = tuple(figure for figure in figures if figure is not None)
    return Gallery(there) if there else None


def _tell_error(motion: TrackSummary) -> list[Block]:
    """In words, what would be a curve of rounding."""
    graded = motion.grade
    if graded.largest_axis_error_m >= NEGLIGIBLE_M:
        return []
    asked = length(motion.limits.position_error_m)
    return [
        Text(f"At every sample the tool is on the path: less than 1 nm off along each axis, {asked} being allowed.")
    ]


def _make_measured(motion: TrackSummary) -> Table:
    columns = Column("figure", align="left"), Column("measured", mark="ours"), Column("asked for", align="left")
    caption = "Measured by plain numpy, not by the kernels that search"
    return Table(columns=columns, rows=tuple(list_figures(motion)), caption=caption)


def tell_world(motion: TrackSummary) -> str:
    """The world, what is kept from it, and how it is drawn, in words; nothing without one."""
    facts = _list_world(motion)
    kept = ", ".join(f"{name} of {value}" for name, value in facts)
    return f"In a {kept}.{tell_obstacles(motion)}" if facts else ""


def _list_world(motion: TrackSummary) -> list[tuple[str, str]]:
    """The world and what is kept from it, if there is one."""
    collision = motion.collision
    if not collision.obstacles:
        return []
    margins = [f"{1e3 * collision.margin_m:.6g} mm"]
    margins += [f"{name} {1e3 * margin_m:.6g} mm" for name, margin_m in collision.margins_m]
    digest = f"{count_of(len(collision.obstacles), 'obstacle')}, digest {code(collision.world.digest[:12])}"
    moving = verbatim(", ".join(sorted(motion.trajectory.moving)))
    return [("world", digest), ("margin", verbatim(", ".join(margins))), *([("what moves", moving)] if moving else [])]


def _make_recipe(motion: TrackSummary, command: str) -> Section:
    facts = [
        ("robot", verbatim(motion.robot.name)),
        ("base", _name_base(motion)),
        ("method", code(motion.trajectory.method)),
        ("detector", verbatim(motion.collision.name)),
        *_list_world(motion),
        ("time between samples", f"{1e3 * motion.trajectory.path.dt_s:g} ms"),
    ]
    return Section("How it was made", (Facts(tuple(facts)), Code(command, "The same again")))
