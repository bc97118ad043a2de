"""The runs of the section on [Zhang2022]: targets, gains, ways and times, all of them ours."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.wheels import ground_speed
from ikde.paper.mecanum_arm import MecanumArm, rotation_about_z
from ikde.paper.null_space_runs import Run, Scene, Way, after, always, by_axis_ratio, by_distance, simulate

SOFTEST = 0.05
SWITCH_S, TAKES_S = 8.0, 1.0
TARGET, NEAR, FAR = np.array([2.6, 0.4, 0.8]), np.array([1.95, 0.1, 0.25]), np.array([1.2, 0.1, 0.25])
"""m: of the tool; and platforms, m and rad, from which the tool reaches it, and does not."""
TURN_S, CIRCLE_S = 60.0, 300.0
STANDS = np.zeros(3)
READINGS = ("no slip", "(15): E + S", "(14): 1 - s")
LAWS = ("printed, tool first", "printed, platform first", "exact, tool first", "exact, platform first")
WAYS = (
    Way(name="printed", family="printed", share=always(1.0)),
    Way(name="printed", family="printed", share=always(0.0)),
    Way(name="exact", family="exact", share=always(1.0)),
    Way(name="exact", family="exact", share=always(0.0)),
    Way(name="printed, in m/s", family="printed in m/s", share=always(1.0)),
    Way(name="printed, in m/s", family="printed in m/s", share=always(0.0)),
)


def run_held(arm: MecanumArm, start: Floats, dt_s: float) -> Run:
    """The tool stays where it is while the platform goes 0.29 m away and turns by 0.3 rad."""
    tool, platform = arm.place(np.zeros(3), start).tool, np.array([-0.25, 0.15, 0.3])
    return simulate(arm, start, WAYS, Scene(lambda _: (tool, STANDS), lambda _: (platform, STANDS), 10.0, dt_s))


def run_circle(arm: MecanumArm, start: Floats, dt_s: float) -> Run:
    """The platform drives a circle of 0.5 m radius in a minute, the tool five of 0.1 m radius beside it."""
    begin, w = arm.place(np.zeros(3), start).tool, 2.0 * np.pi / TURN_S

    def platform(t: float) -> tuple[Floats, Floats]:
        s, c = np.sin(w * t), np.cos(w * t)
        return 0.5 * np.array([s, 1.0 - c, 0.0]), 0.5 * w * np.array([c, s, 0.0])

    def tool(t: float) -> tuple[Floats, Floats]:
        (at, v), a = platform(t), 5.0 * w
        circle, along = (0.0, np.cos(a * t) - 1.0, np.sin(a * t)), (0.0, -np.sin(a * t), np.cos(a * t))
        return begin + at + 0.1 * np.array(circle), v + 0.1 * a * np.array(along)

    return simulate(arm, start, WAYS, Scene(tool, platform, TURN_S, dt_s))


def run_conflict(arm: MecanumArm, start: Floats, dt_s: float) -> tuple[list[tuple[Way, str]], Run]:
    """A target out of reach from where the platform should be; platform first, from 8 s on tool first."""
    never, once, softly = always(0.0), after(SWITCH_S, 0.0), after(SWITCH_S, TAKES_S)
    ratio = by_axis_ratio(8.0, 12.0)
    names = {never: "never", once: "at once", softly: "smoothly", ratio: "by (28), 8 to 12"}
    ways = [
        *(Way(name="printed", family="printed", share=share) for share in (never, once, softly)),
        *(Way(name="printed, in m/s", family="printed in m/s", share=s) for s in (never, once, softly)),
        Way(name="exact, undamped", family="exact", share=never),
        *(Way(name="exact, damped", family="exact", share=s, softest=SOFTEST) for s in (never, once, softly, ratio)),
        Way(name="exact, damped: intermediate values", family="enters", share=softly, softest=SOFTEST),
        Way(name="the same inside speed limits", family="enters in limits", share=softly, softest=SOFTEST),
        Way(name="the same, and of acceleration", family="enters smoothly", share=softly, softest=SOFTEST),
        Way(name="two weights inside speed limits", family="weights in limits", share=softly),
    ]
    scene = Scene(lambda _: (TARGET, STANDS), lambda _: (FAR, STANDS), 20.0, dt_s, (1.5, 1.0), (0.3, 0.4))
    return [(way, names[way.share]) for way in ways], simulate(arm, start, ways, scene)


def run_near(arm: MecanumArm, start: Floats, dt_s: float) -> tuple[list[tuple[Way, str]], Run]:
    """Both tasks can be met; the platform is first until the target is near (27)."""
    shapes = {shape: by_distance(0.8, 1.0, shape) for shape in ("at once", "linear", "smooth")}
    ways = [
        *((Way(name="printed", family="printed", share=share), shape) for shape, share in shapes.items()),
        *((Way(name="printed, in m/s", family="printed in m/s", share=s), shape) for shape, s in shapes.items()),
        *(
            (Way(name="exact, damped", family="exact", share=shapes[shape], softest=SOFTEST), shape)
            for shape in ("at once", "smooth")
        ),
        (Way(name="intermediate values", family="enters", share=shapes["smooth"], softest=SOFTEST), "smooth"),
    ]
    scene = Scene(lambda _: (TARGET, STANDS), lambda _: (NEAR, STANDS), 12.0, dt_s, (1.5, 1.0), (0.3, 0.4))
    return ways, simulate(arm, start, [way for way, _ in ways], scene)


def run_slip(arm: MecanumArm, start: Floats, dt_s: float, slip: Mapping[str, Any]) -> Run:
    """The platform drives a circle of 1 m radius in 300 s, the tool one of 0.1 m six times; wheels slip as printed."""
    begin, w = arm.place(np.zeros(3), start).tool, 2.0 * np.pi / CIRCLE_S
    seen = np.array([1.0, 1.0 + slip["ratio"], ground_speed(np.ones(1), slip["ratio"])[0]])

    def platform(t: float) -> tuple[Floats, Floats]:
        s, c = np.sin(w * t), np.cos(w * t)
        return np.array([s, 1.0 - c, w * t]), w * np.array([c, s, 1.0])

    def tool(t: float) -> tuple[Floats, Floats]:
        (at, v), a = platform(t), 6.0 * w
        R = rotation_about_z(at[2])
        own = R @ (begin + 0.1 * np.array([0.0, np.cos(a * t) - 1.0, np.sin(a * t)]))
        along = R @ (0.1 * a * np.array([0.0, -np.sin(a * t), np.cos(a * t)]))
        carried = w * np.array([-own[1], own[0], 0.0])
        return np.r_[at[:2], 0.0] + own, np.r_[v[:2], 0.0] + carried + along

    def rolling(t: float) -> Floats:
        slips = any(first <= t < last for first, last in slip["seconds"])
        return np.tile(seen if slips else np.ones(3), 2)[:, None]

    feedback = np.repeat([0.0, 1.0], 3)[:, None]
    ways = [Way(name=name, family="exact", share=always(1.0), softest=SOFTEST) for name in 2 * READINGS]
    return simulate(arm, start, ways, Scene(tool, platform, CIRCLE_S, dt_s, (2.0 * feedback, feedback)), rolling)
