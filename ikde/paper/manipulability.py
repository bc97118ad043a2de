"""Dong and Zhao's tracked mobile manipulator: both measures, claims of them, their optima and what lengths allow."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ikde.model.robot import Robot
from ikde.paper.inputs import Inputs
from ikde.paper.manipulability_claims import SEED, Claim, Singular, compute_claims, compute_rigidity, list_singular
from ikde.paper.optima import (
    FREE,
    SPACE_STEP_DEG,
    Peak,
    Surface,
    choose_half,
    climb,
    fall_short,
    find_pair_peak,
    find_peak_by_evolution,
    find_peak_by_grid,
    mirror_deg,
    newton_step_deg,
    turn_axis,
    wrap_deg,
)
from ikde.paper.section import Computed
from ikde.paper.tracked_arm import CHAINS, PRINTED, RIGID, TrackedArm, compute_w2

SHOWN = (PRINTED, RIGID)
UNITS = {"m": 1.0, "dm": 10.0, "mm": 1000.0}
LENGTHS = ("l1", "l2", "l3 + l4", "l_m", "b")
PROVENANCE = {  # of every part of the record
    "lengths": "each names its own",
    "angles.printed_deg": "published",
    "angles.radians": "derived",
    "angles.undone_deg": "derived",
    "angles.steps": "derived",
    "claims": "published; what is computed of it is ours",
    "singular.listed": "published",
    "optima.printed_deg": "published",
    "else": "ours",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Length:
    """A length of the robot that ships, and where it comes from."""

    name: str
    value_m: float
    kind: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedAngle:
    """A printed angle in both readings of its degrees."""

    figure: int
    joint: str
    printed_deg: float
    radians: float  # printed * 3.14 / 180
    undone_deg: float  # those radians in deg
    steps: int  # the nearest whole number of 1.5 deg
    off_steps_deg: float  # from there, undone
    off_steps_as_printed_deg: float  # from the nearest, read with the true pi
    is_whole: bool  # whole steps to four digits of the radians


@dataclass(frozen=True, slots=True, kw_only=True)
class PairOptimum:
    """A figure's largest value for one chain, with the calibrated lengths."""

    figure: int
    chain: str
    pair: list[str]
    third: str
    third_deg: float
    printed_deg: list[float]  # as printed
    undone_deg: list[float]  # with 3.14 undone
    grid_deg: list[float]
    top_deg: list[float]  # of that hill, off the grid
    w2: float  # on the grid
    printed_below: float  # the value at the printed optimum, as a share below


@dataclass(frozen=True, slots=True, kw_only=True)
class SpaceOptimum:
    """The largest value over three angles, by two searches; and where it is largest along each angle alone."""

    chain: str
    grid: Peak
    evolution: Peak
    mirror_deg: list[float]
    mirror_w2: float
    largest_at_deg: dict[str, list[float]]  # by angle: where the best over the two others is largest
    along: dict[str, list[float]]  # by angle: the best over the two others, a step of the grid each


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitOptimum:
    """Figure 3's optimum where lengths are counted in a unit."""

    chain: str
    unit: str
    grid_deg: list[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundFigure:
    """How a set of lengths does at one printed optimum."""

    figure: int
    is_sought: bool
    below: float
    largest_at_deg: list[float]
    newton_step_deg: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class FoundLengths:
    """Lengths that a search found for one printed optimum, or for all."""

    chain: str
    range: str
    lengths_m: list[float]  # l1, l2, l3 + l4, l_m, b
    figures: list[FoundFigure]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manipulability(Computed):
    """All of it; `settings` names the provenance of every part."""

    lengths: list[Length]
    angles: list[PrintedAngle]
    claims: list[Claim]
    singular: list[Singular]
    rigidity: list[dict[str, Any]]  # by chain: its signs, and how long |ME| is while theta2 alone turns
    optima: list[PairOptimum]
    space: list[SpaceOptimum]
    units: list[UnitOptimum]
    found: list[FoundLengths]


def compute_manipulability(inputs: Inputs) -> Manipulability:
    """Claims, singular configurations, optima in both readings, and what lengths allow."""
    printed, robot = inputs.dong_zhao, inputs.tracked
    surfaces = read_surfaces(printed)
    arms = [read_arm(robot, chain) for chain in SHOWN]
    return Manipulability(
        lengths=_list_lengths(robot),
        angles=read_angles(printed),
        claims=compute_claims(arms[0]),
        singular=list_singular(arms[0]),
        rigidity=[compute_rigidity(replace(arms[0], chain=chain)) for chain in CHAINS],
        optima=[_compute_pair(arm, surface, printed) for surface in surfaces for arm in arms],
        space=[_compute_space(arm) for arm in arms],
        units=[_compute_unit(arm, unit, surfaces[0]) for arm in arms for unit in UNITS],
        found=[_judge_found(entry, surfaces) for entry in printed["found"]],
        settings={
            "source": "[DongZhao]",
            "robot": robot.name,
            "seed": SEED,
            "theta1_deg": 0.0,
            "pair_step_deg": printed["step_deg"],
            "space_step_deg": SPACE_STEP_DEG,
            "printed_pi": printed["printed_pi"],
            "length_unit": "m",
            "ranges_m": printed["ranges_m"],
            "provenance": PROVENANCE,
        },
    )


def read_arm(robot: Robot, chain: Any = RIGID) -> TrackedArm:
    """The lengths of the robot that ships, with the signs of a chain."""
    frames = {frame.name: frame for frame in robot.frames}
    l1, l2, l3 = (float(frames[name].p_parent_frame[0]) for name in ("link_2", "link_3", "E"))
    offset, wheels = -float(frames["M"].p_parent_frame[0]), robot.wheels
    if wheels is None:
        raise ValueError(f"{robot.name} has no wheels")
    return TrackedArm(links_m=(l1, l2, l3), arm_offset_m=offset, track_m=2.0 * wheels.half_track_m, chain=chain)


def read_surfaces(printed: Mapping[str, Any]) -> list[Surface]:
    """Figures 3 to 5 with their optima, 3.14 undone."""
    found = []
    for entry in printed["optima"]:
        third = int(entry["third"][-1]) - 1
        first, second = (k for k in FREE if k != third)
        t2, t3, t4 = (_undo(printed, entry[f"theta{k + 1}"]) for k in FREE)
        found.append(Surface(figure=entry["figure"], pair=(first, second), third=third, at_deg=(0.0, t2, t3, t4)))
    return found


def _undo(printed: Mapping[str, Any], angle_deg: float) -> float:
    return float(np.degrees(angle_deg * printed["printed_pi"] / 180.0))


def read_angles(printed: Mapping[str, Any]) -> list[PrintedAngle]:
    """Every printed angle of the optima in both readings."""
    return [
        _read_angle(printed, entry["figure"], f"theta{k + 1}", entry[f"theta{k + 1}"])
        for entry in printed["optima"]
        for k in FREE
    ]


def _read_angle(printed: Mapping[str, Any], figure: int, joint: str, angle_deg: float) -> PrintedAngle:
    step, undone = printed["step_deg"], _undo(printed, angle_deg)
    steps = round(undone / step)
    return PrintedAngle(
        figure=figure,
        joint=joint,
        printed_deg=angle_deg,
        radians=float(np.radians(undone)),
        undone_deg=undone,
        steps=steps,
        off_steps_deg=undone - steps * step,
        off_steps_as_printed_deg=angle_deg - round(angle_deg / step) * step,
        is_whole=abs(float(np.radians(undone - steps * step))) <= printed["rounding_rad"],
    )


def _list_lengths(robot: Robot) -> list[Length]:
    arm, sources = read_arm(robot), robot.provenance
    places = [("frames", "link_2"), ("frames", "link_3"), ("frames", "E"), ("frames", "M"), ("wheels", "half_track")]
    values = (*arm.links_m, arm.arm_offset_m, arm.track_m)
    rows = []
    for name, value, place in zip(LENGTHS, values, places, strict=True):
        source = sources.get(place) or sources.get(place[:1]) or sources[(*place, "xyz")]
        rows.append(Length(name=name, value_m=value, kind=source.kind, why=source.text))
    return rows


def _compute_pair(arm: TrackedArm, surface: Surface, printed: Mapping[str, Any]) -> PairOptimum:
    pair = list(surface.pair)
    peak = find_pair_peak(arm, surface)
    entry = next(entry for entry in printed["optima"] if entry["figure"] == surface.figure)
    top = wrap_deg(climb(arm, np.radians(peak.theta_deg), pair))
    return PairOptimum(
        figure=surface.figure,
        chain=arm.chain.name,
        pair=[f"theta{k + 1}" for k in pair],
        third=f"theta{surface.third + 1}",
        third_deg=surface.at_deg[surface.third],
        printed_deg=[entry[f"theta{k + 1}"] for k in pair],
        undone_deg=[surface.at_deg[k] for k in pair],
        grid_deg=[peak.theta_deg[k] for k in pair],
        top_deg=[top[k] for k in pair],
        w2=peak.w2,
        printed_below=fall_short(arm, surface, peak),
    )


def _compute_space(arm: TrackedArm) -> SpaceOptimum:
    peak, along = find_peak_by_grid(arm)
    grid, evolution = choose_half(peak), choose_half(find_peak_by_evolution(arm))
    mirror, axis = mirror_deg(grid.theta_deg), turn_axis(SPACE_STEP_DEG)
    return SpaceOptimum(
        chain=arm.chain.name,
        grid=grid,
        evolution=evolution,
        mirror_deg=mirror,
        mirror_w2=float(compute_w2(arm, np.radians(mirror))),
        largest_at_deg={f"theta{k + 1}": axis[v >= v.max() * (1.0 - 1e-12)].tolist() for k, v in along.items()},
        along={f"theta{k + 1}": v.tolist() for k, v in along.items()},
    )


def _compute_unit(arm: TrackedArm, unit: str, surface: Surface) -> UnitOptimum:
    """The arm's numbers in another unit: w2 adds 1/2, which has none, to squares of lengths."""
    peak = find_pair_peak(scale_arm(arm, UNITS[unit]), surface)
    return UnitOptimum(chain=arm.chain.name, unit=unit, grid_deg=[peak.theta_deg[k] for k in surface.pair])


def scale_arm(arm: TrackedArm, factor: float) -> TrackedArm:
    """All lengths times a factor."""
    l1, l2, l3 = (factor * length for length in arm.links_m)
    return replace(arm, links_m=(l1, l2, l3), arm_offset_m=factor * arm.arm_offset_m, track_m=factor * arm.track_m)


def _judge_found(entry: Mapping[str, Any], surfaces: Sequence[Surface]) -> FoundLengths:
    l1, l2, l3, offset, track = entry["lengths_m"]
    chain = next(chain for chain in CHAINS if chain.name == entry["chain"])
    arm = TrackedArm(links_m=(l1, l2, l3), arm_offset_m=offset, track_m=track, chain=chain)
    figures = []
    for surface in surfaces:
        peak = find_pair_peak(arm, surface)
        figures.append(
            FoundFigure(
                figure=surface.figure,
                is_sought=surface.figure in entry["figures"],
                below=fall_short(arm, surface, peak),
                largest_at_deg=[peak.theta_deg[k] for k in surface.pair],
                newton_step_deg=newton_step_deg(arm, surface),
            )
        )
    return FoundLengths(chain=chain.name, range=entry["range"], lengths_m=entry["lengths_m"], figures=figures)
