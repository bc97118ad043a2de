"""Sections 2.1, 2.2 and 3 of [Zhang2022]: two tasks at once, in conflict, near a singularity, and with slip."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from ikde.io.yaml_file import read_yaml
from ikde.kernels.arrays import Floats
from ikde.model.robot import Origin
from ikde.paper.inputs import FOLDER, Inputs
from ikde.paper.mecanum_arm import MecanumArm
from ikde.paper.null_space_claims import ARMS, SEED, SPREAD_RAD, Claim, compute_claims
from ikde.paper.null_space_runs import ACCELERATIONS, LIMITS, STRETCHES, Run, Way, stretch
from ikde.paper.null_space_scenes import (
    FAR,
    LAWS,
    NEAR,
    READINGS,
    SOFTEST,
    SWITCH_S,
    TAKES_S,
    TARGET,
    WAYS,
    run_circle,
    run_conflict,
    run_held,
    run_near,
    run_slip,
)
from ikde.paper.section import Computed

CURVE_POINTS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """One law in one run."""

    run: str
    law: str
    first: str  # which task has priority
    tool_mm: float  # largest error
    platform_mm: float  # largest in X, Y and heading, a rad as 1000
    platform_end_mm: float
    kind: Origin


@dataclass(frozen=True, slots=True, kw_only=True)
class Switched:
    """One way to change which task is first: errors at the end, and what jumps from sample to sample."""

    law: str
    switch: str
    tool_m: float | None  # None where rounding decides, as below
    platform_m: float
    fastest_joint: float | None  # rad/s
    jump_joint: float | None  # rad/s in a sample
    jump_platform: float  # m/s, rad/s
    jump_wheel: float  # rad/s
    kind: Origin


@dataclass(frozen=True, slots=True, kw_only=True)
class Singular:
    """One way to invert the Jacobian of an arm that is drawn out of reach."""

    law: str
    fastest_joint: float | None  # rad/s; None where rounding decides
    error_mm: float  # after 3 s, where the arm is regular
    kind: Origin


@dataclass(frozen=True, slots=True, kw_only=True)
class Slipped:
    """One reading of the published slip, with or without feedback."""

    reading: str
    feedback: bool
    tool_mm: float  # largest error
    platform_mm: float
    after_50_s_mm: float  # error of the tool 50 s after the first slip
    end_mm: float
    kind: Origin


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """One quantity over time."""

    figure: str
    name: str
    t_s: list[float]
    values: list[float]
    kind: Origin


@dataclass(frozen=True, slots=True, kw_only=True)
class Undamped:
    """The fastest joint where nothing is damped, rad/s: rounding decides how far it is from infinite."""

    conflict: float
    conflict_tool_m: float
    stretched: float


@dataclass(frozen=True, slots=True, kw_only=True)
class NullSpace(Computed):
    """Everything that sections 2.1, 2.2 and 3 let one compute."""

    published: dict[str, Any]  # numbers as they are printed
    claims: list[Claim]
    together: list[Outcome]
    conflict: list[Switched]
    switching: list[Switched]
    singular: list[Singular]
    slipping: list[Slipped]
    curves: list[Curve]
    measured: Undamped


@cache
def load_zhang() -> dict[str, Any]:
    """Printed numbers of [Zhang2022], and those that were chosen (`zhang2022.yaml`)."""
    return dict(read_yaml(FOLDER / "zhang2022.yaml").data or {})


def compute_null_space(inputs: Inputs) -> NullSpace:
    """Claims, runs and curves; the same in every run."""
    numbers = load_zhang()
    arm, start = MecanumArm.of(numbers), np.array(numbers["calibrated"]["start_rad"])
    dt_s = 1.0 / inputs.budget.run_steps_per_s
    held, circle = run_held(arm, start, 0.5 * dt_s), run_circle(arm, start, dt_s)
    ways, conflict = run_conflict(arm, start, dt_s)
    near_ways, near = run_near(arm, start, dt_s)
    drawn = stretch(arm, start, round(9.0 / dt_s), dt_s)
    slipped = run_slip(arm, start, min(10.0 * dt_s, 0.5), numbers["published"]["slip"])
    third = min(round(3.0 / dt_s), len(drawn.t_s) - 1)
    undamped = next(k for k, (way, _) in enumerate(ways) if way.name == "exact, undamped")
    return NullSpace(
        published=numbers["published"],
        claims=compute_claims(arm, start),
        together=[*_tell_together("tool held", held), *_tell_together("circles", circle)],
        conflict=_tell_switched(ways, conflict, SWITCH_S - 0.05, SWITCH_S + TAKES_S + 0.1),
        switching=_tell_switched(near_ways, near, 0.0, np.inf),
        singular=[
            Singular(
                law=name,
                fastest_joint=None if name == "undamped" else float(drawn.speed[:, k].max()),
                error_mm=float(1e3 * drawn.error_m[third, k]),
                kind="calibrated",
            )
            for k, name in enumerate(STRETCHES)
        ],
        slipping=_tell_slipped(slipped),
        curves=[
            *(_curve("held", name, held.t_s, 1e3 * held.tool_m[:, k]) for k, name in enumerate(LAWS)),
            *(
                _window("conflict", f"{way.name}, {switch}", conflict.t_s, conflict.twist[:, k, 0])
                for k, (way, switch) in enumerate(ways)
                if way.name == "exact, damped" or way.family == "enters"
            ),
            *(_curve("singular", name, drawn.t_s, drawn.speed[:, k]) for k, name in enumerate(STRETCHES[1:], 1)),
            *(_curve("slip", name, slipped.t_s, 1e3 * slipped.tool_m[:, 3 + k]) for k, name in enumerate(READINGS)),
        ],
        measured=Undamped(
            conflict=float(np.abs(conflict.joints[:, undamped]).max()),
            conflict_tool_m=float(conflict.tool_m[-1, undamped]),
            stretched=float(drawn.speed[:, 0].max()),
        ),
        settings={
            "seed": SEED,
            "dt_s": dt_s,
            "softest": SOFTEST,
            "calibrated": numbers["calibrated"],
            "derived": numbers["derived"],
            "random_arms": {"count": ARMS, "spread_rad": SPREAD_RAD},
            "targets": {"tool_m": TARGET.tolist(), "near": NEAR.tolist(), "far": FAR.tolist()},
            "limits": {"speed": LIMITS.tolist(), "acceleration": ACCELERATIONS.tolist()},
        },
    )


def _tell_together(name: str, run: Run) -> list[Outcome]:
    return [
        Outcome(
            run=name,
            law=way.name,
            first=("tool", "platform")[k % 2],
            tool_mm=float(1e3 * run.tool_m[:, k].max()),
            platform_mm=float(1e3 * run.platform_m[:, k].max()),
            platform_end_mm=float(1e3 * run.platform_m[-1, k]),
            kind="calibrated",
        )
        for k, way in enumerate(WAYS)
    ]


def _tell_switched(ways: Sequence[tuple[Way, str]], run: Run, begin: float, end: float) -> list[Switched]:
    some = (run.t_s > begin) & (run.t_s < end)

    def jump(values: Floats) -> float:
        return float(np.abs(np.diff(values[some], axis=0)).max())

    rows = []
    for k, (way, switch) in enumerate(ways):
        wild = way.name == "exact, undamped"
        rows.append(
            Switched(
                law=way.name,
                switch=switch,
                tool_m=None if wild else float(run.tool_m[-1, k]),
                platform_m=float(run.platform_m[-1, k]),
                fastest_joint=None if wild else float(np.abs(run.joints[:, k]).max()),
                jump_joint=None if wild else jump(run.joints[:, k]),
                jump_platform=jump(run.twist[:, k]),
                jump_wheel=jump(run.wheels[:, k]),
                kind="calibrated",
            )
        )
    return rows


def _tell_slipped(run: Run) -> list[Slipped]:
    later = int(np.argmin(np.abs(run.t_s - 150.0)))
    return [
        Slipped(
            reading=READINGS[k % 3],
            feedback=k >= 3,
            tool_mm=float(1e3 * run.tool_m[:, k].max()),
            platform_mm=float(1e3 * run.platform_m[:, k].max()),
            after_50_s_mm=float(1e3 * run.tool_m[later, k]),
            end_mm=float(1e3 * run.tool_m[-1, k]),
            kind="calibrated",
        )
        for k in range(6)
    ]


def _window(figure: str, name: str, t_s: Floats, values: Floats) -> Curve:
    """A curve round the moment of the switch."""
    some = (t_s >= SWITCH_S - 0.5) & (t_s <= SWITCH_S + TAKES_S + 0.5)
    return _curve(figure, name, t_s[some], values[some])


def _curve(figure: str, name: str, t_s: Floats, values: Floats) -> Curve:
    some = np.unique(np.linspace(0, len(t_s) - 1, CURVE_POINTS).astype(int))
    rounded = [float(f"{value:.6g}") for value in values[some]]
    return Curve(figure=figure, name=name, t_s=t_s[some].tolist(), values=rounded, kind="calibrated")
