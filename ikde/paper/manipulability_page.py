"""Dong and Zhao's manipulability as a section of the page."""

from collections.abc import Sequence

from ikde.paper.columns import Shown as ShownColumn
from ikde.paper.columns import label, make_table, mark_off, ours, published
from ikde.paper.inputs import Inputs
from ikde.paper.manipulability import (
    LENGTHS,
    SHOWN,
    FoundFigure,
    FoundLengths,
    Manipulability,
    PairOptimum,
    PrintedAngle,
    SpaceOptimum,
    UnitOptimum,
)
from ikde.paper.manipulability_claims import Claim, Shown, Singular
from ikde.paper.manipulability_figures import THETA, draw_manipulability, name_angles
from ikde.paper.optima import SPACE_STEP_DEG
from ikde.report.numbers import fixed, significant
from ikde.report.page import Cell, Column, Section, Table, Text


def show_manipulability(data: Manipulability, inputs: Inputs) -> Section:
    """What was printed beside what comes out, the claims, and the figures redrawn."""
    return Section(
        "Dong and Zhao: manipulability of a tracked manipulator",
        (
            _introduce(data),
            _make_lengths(data),
            _make_claims(data.claims),
            _make_singular(data),
            _make_rigidity(data),
            _explain_degrees(data),
            _make_angles(data.angles),
            _explain_optima(data),
            _make_optima(data),
            _make_space(data),
            _make_peaks(data),
            _make_units(data),
            _explain_found(data),
            _make_found(data),
            *draw_manipulability(data, inputs),
        ),
        anchor="manipulability",
    )


def _introduce(data: Manipulability) -> Text:
    verdicts = [claim.verdict for claim in data.claims]
    return Text(
        "A base on two tracks carries an arm, of which four joints move its end E. The paper measures how freely E can "
        "move by the base alone, w1 = det(J1 J1ᵀ), and by base and arm together, w2 = det(J2 J2ᵀ): each is the square "
        "of Yoshikawa's manipulability. Written out, **w1 = ((l_m − R cos θ1) / b)²**, the distance of E from the "
        "wheels' axle over the track, squared; R is how far E is from the arm's foot, outward. So w1 is 0 on a whole "
        "surface, l_m = R cos θ1.\n\n"
        f"Of {len(verdicts)} claims {verdicts.count('true')} hold as they stand. The equations agree with each other "
        "once (7) has l3 + l4 in z ([misprints](#misprints)), but (7) is not a rigid arm, so no robot file can hold "
        "it: `leobot`, which ships, has its joints as a rigid chain. The paper prints no length, no range of an "
        "angle, no θ1 and no value of w1 or w2, and our copy has no pictures: its figures can be drawn again, not "
        "compared. Figures 3 to 5 give one optimum each; those we compare."
    )


def _make_lengths(data: Manipulability) -> Table:
    return make_table(
        data.lengths,
        label("length", lambda row: row.name),
        ours("value", "m", lambda row: f"{row.value_m:g}"),
        label("is", lambda row: row.kind),
        label("why", lambda row: row.why),
        caption="Lengths of `leobot`, and of everything below unless it names its own",
    )


def _make_claims(claims: Sequence[Claim]) -> Table:
    return make_table(
        claims,
        label("place", lambda claim: claim.place),
        label("claim", lambda claim: _greek(claim.claim), mark="published"),
        label("verdict", lambda claim: mark_off(claim.verdict, claim.verdict == "true")),
        label("shown by", lambda claim: "; ".join(map(_say, claim.shown)), mark="ours"),
        caption="Claims of sections 3.1 and 3.2",
        note="Changes and shares over 300 random arms and postures. θ1 = 0 or 180, (7) as printed. Change of w1: of "
        "the largest value that the entries of J1 allow; of w2: of itself.",
    )


def _say(shown: Shown) -> str:
    return f"{_greek(shown.name)} {f'{100 * shown.value:.0f} %' if shown.is_share else _number(shown.value)}"


def _number(value: float) -> str:
    """Rounding errors are said to be small: their digits mean nothing."""
    return "< 1e-12" if abs(value) < 1e-12 else significant(value)


def _greek(text: str) -> str:
    return text.replace("theta", "θ")


def _make_singular(data: Manipulability) -> Table:
    return make_table(
        data.singular,
        label("listed", lambda row: "yes" if row.listed else "no"),
        *map(_show_theta, range(4)),
        ours("w1 with l_m = 0", "", lambda row: _number(row.w1_without_offset)),
        ours(f"w1 with l_m = {data.lengths[3].value_m:g} m", "", lambda row: _number(row.w1_with_offset)),
        caption="Singular configurations of the base: those that the paper lists, and two that it does not",
        note="Where the paper leaves an angle open, any value will do; these are ours. For θ1, θ3 and θ4 as in the "
        "last rows, θ2 was solved from l_m = R cos θ1: wherever the arm is long enough there is such an angle.",
    )


def _show_theta(k: int) -> ShownColumn[Singular]:
    return ours(f"θ{k + 1}", "deg", lambda row: f"{row.theta_deg[k]:.4g}")


def _make_rigidity(data: Manipulability) -> Table:
    return make_table(
        data.rigidity,
        label("chain", lambda row: row["chain"]),
        label("links outward", lambda row: _signs(row["outward"])),
        label("links upward", lambda row: _signs(row["upward"])),
        ours("least |ME|", "mm", lambda row: fixed(1e3 * row["least_m"], 1)),
        ours("largest |ME|", "mm", lambda row: fixed(1e3 * row["largest_m"], 1)),
        label("rigid", lambda row: mark_off("yes" if row["is_rigid"] else "no", row["is_rigid"])),
        caption="Why (7) is no rigid arm: the distance of E from the arm's foot M while θ2 alone turns",
        note="θ3 = 40, θ4 = 30 deg. One joint turning cannot change a distance behind it. A chain is rigid if each "
        "link has the same sign outward and upward, or each the opposite. Which one was meant is open.",
    )


def _signs(signs: Sequence[int]) -> str:
    return " ".join("+" if sign > 0 else "−" for sign in signs)


def _explain_degrees(data: Manipulability) -> Text:
    whole = sum(angle.is_whole for angle in data.angles)
    closest = min(abs(angle.off_steps_as_printed_deg) for angle in data.angles)
    return Text(
        "**The printed degrees** were made with π = 3.14. Multiplied by 3.14 / 180 they are radians of four to seven "
        f"digits, and {whole} of {len(data.angles)} of those are whole steps of 1.5 deg to that rounding. Read as they "
        f"stand none is: the closest is {fixed(closest, 4)} deg off, hundreds of their last digit. So the paper "
        "most likely searched a grid of 1.5 deg, and meant the angles with 3.14 undone."
    )


def _make_angles(angles: Sequence[PrintedAngle]) -> Table:
    return make_table(
        angles,
        (Column("figure"), lambda row: f"{row.figure}"),
        label("angle", lambda row: THETA[row.joint]),
        published("printed", "deg", lambda row: f"{row.printed_deg:.5f}"),
        ours("printed × 3.14 / 180", "rad", lambda row: f"{row.radians:.7f}"),
        ours("3.14 undone", "deg", lambda row: f"{row.undone_deg:.4f}"),
        ours("steps of 1.5 deg", "", lambda row: f"{row.steps}"),
        ours("off them, undone", "deg", lambda row: mark_off(f"{row.off_steps_deg:+.4f}", row.is_whole)),
        ours("off them, as printed", "deg", lambda row: f"{row.off_steps_as_printed_deg:+.4f}"),
        caption="The printed optima in both readings of their degrees",
        note="≠: not a whole step to four digits of the radians. θ2 of Figure 3 stays unexplained.",
    )


def _explain_optima(data: Manipulability) -> Text:
    below = [row.printed_below for row in data.optima]
    return Text(
        "**The optima** with the calibrated lengths are elsewhere: the values at the printed ones are "
        f"{fixed(100 * min(below), 0)} to {fixed(100 * max(below), 1)} % below the largest. That alone says nothing of "
        "the paper, since its lengths may be others. By the text the largest value over each pair rises and falls with "
        "the third angle and peaks at the printed one, so that each optimum should be one of all three angles."
    )


def _make_optima(data: Manipulability) -> Table:
    return make_table(
        data.optima,
        (Column("figure"), lambda row: f"{row.figure}"),
        label("over", lambda row: f"{name_angles(row.pair)} at {THETA[row.third]} = {row.third_deg:.4g}"),
        label("chain", lambda row: row.chain),
        published("printed", "deg", lambda row: _angles(row.printed_deg, 5)),
        ours("3.14 undone", "deg", lambda row: _angles(row.undone_deg, 2)),
        ours("our grid", "deg", lambda row: mark_off(_angles(row.grid_deg, 1), _near(row))),
        ours("w2", "", lambda row: significant(row.w2)),
        ours("printed is below it", "%", lambda row: fixed(100 * row.printed_below, 1)),
        caption="The largest w2 over two angles, printed beside ours",
        note="θ1 = 0, range 0 to 360 deg in steps of 1.5, lengths calibrated and counted in m. ≠: more than half a "
        "step from the printed optimum.",
    )


def _angles(values_deg: Sequence[float], digits: int) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values_deg)


def _near(row: PairOptimum) -> bool:
    """Within half a step of the printed optimum."""
    return all(abs(a - b) <= 0.75 for a, b in zip(row.grid_deg, row.undone_deg, strict=True))


def _make_space(data: Manipulability) -> Table:
    return make_table(
        data.space,
        label("chain", lambda row: row.chain),
        ours("grid, then climbed", "deg", lambda row: _angles(row.grid.theta_deg[1:], 2)),
        ours("differential evolution", "deg", lambda row: _angles(row.evolution.theta_deg[1:], 2)),
        ours("mirror image", "deg", lambda row: _angles(row.mirror_deg[1:], 2)),
        ours("w2", "", lambda row: f"{row.grid.w2:.6f}"),
        caption="The largest w2 over θ2, θ3, θ4 together, by two searches",
        note="θ1 = 0. The rigid arm is best stretched level to the rear, its own mirror image.",
    )


def _make_peaks(data: Manipulability) -> Table:
    """A row an angle: where the text has its peak, and where ours is."""
    third = {row.third: row for row in data.optima}
    return make_table(
        third.values(),
        label("angle", lambda row: THETA[row.third]),
        ours("peak by the text, 3.14 undone", "deg", lambda row: f"{row.third_deg:.4g}"),
        *map(_show_peaks, data.space),
        caption="Where the largest w2 over the two other angles peaks",
        note=f"On a grid of {SPACE_STEP_DEG:g} deg, θ1 = 0; two angles where both are as large.",
    )


def _show_peaks(space: SpaceOptimum) -> ShownColumn[PairOptimum]:
    return ours(space.chain, "deg", lambda row: _angles(space.largest_at_deg[row.third], 1))


def _make_units(data: Manipulability) -> Table:
    units = list(dict.fromkeys(row.unit for row in data.units))
    by_chain = {chain.name: [row for row in data.units if row.chain == chain.name] for chain in SHOWN}
    return make_table(
        by_chain.items(),
        label("chain", lambda row: row[0]),
        *(_show_unit(k, unit) for k, unit in enumerate(units)),
        caption="The same arm, its lengths counted in another unit: the optimum (θ2, θ3) of Figure 3 moves",
        note="w2 adds 1/2, from speeds of the tracks, to squares of lengths, from speeds of joints in rad/s. w1 has "
        "lengths over b alone and keeps its optimum. Columns scaled by speed limits would end that.",
    )


def _show_unit(k: int, unit: str) -> ShownColumn[tuple[str, list[UnitOptimum]]]:
    return ours(f"lengths in {unit}", "deg", lambda row: _angles(row[1][k].grid_deg, 1))


def _explain_found(data: Manipulability) -> Text:
    chains = [chain.name for chain in SHOWN]
    worst = {(c, r): _find_least(data, c, r) for c in chains for r in ("wide", "believable")}
    printed, rigid = ([f"{fixed(100 * worst[c, r], 0)} %" for r in ("wide", "believable")] for c in chains)
    return Text(
        "**What lengths allow.** A search for lengths at which the printed angles have the largest value of their "
        "figure. Alone, each optimum can be had or nearly had with some lengths, most of them absurd; with lengths "
        "that a robot may have only that of Figure 4, and only by (7) as printed. **No lengths were found that give "
        f"all three**: with the best set the worst of them is {printed[0]} below the largest of its figure ({rigid[0]} "
        f"for the rigid arm), with believable lengths {printed[1]} ({rigid[1]}). Found by search at θ1 = 0, no proof; "
        "tops that are not the largest of their figure do not count. And one optimum is two "
        "equations for five lengths, and nothing tells l3 from l4: it leaves a family, so the lengths of `leobot` stay "
        "calibrated."
    )


def _find_least(data: Manipulability, chain: str, reach: str) -> float:
    """The worst of the three optima, at the lengths that were sought for all three."""
    rows = [row for row in data.found if (row.chain, row.range) == (chain, reach)]
    return min(max(figure.below for figure in row.figures) for row in rows)


def _make_found(data: Manipulability) -> Table:
    return make_table(
        data.found,
        label("chain", lambda row: row.chain),
        label("range", lambda row: row.range),
        label("sought", _name_sought),
        ours(", ".join(LENGTHS), "m", lambda row: ", ".join(f"{x:.4g}" for x in row.lengths_m)),
        *(_show_below(k, figure.figure) for k, figure in enumerate(data.found[0].figures)),
        caption="Lengths that were found, and how far each printed optimum is below the largest of its figure",
        note="Wide: 2 cm to 50 m. Believable: links of 5 to 60 cm, l_m up to 30 cm, b of 20 to 60 cm. ≠: sought, and "
        "not the largest on the grid. `python -m benchmarks.dong_zhao_lengths` searches again, also for the other "
        "rigid chains.",
    )


def _name_sought(row: FoundLengths) -> str:
    sought = [figure.figure for figure in row.figures if figure.is_sought]
    return f"Figure {sought[0]}" if len(sought) == 1 else "all"


def _show_below(k: int, figure: int) -> ShownColumn[FoundLengths]:
    return ours(f"Figure {figure}", "%", lambda row: _say_below(row.figures[k]), "value below its largest")


def _say_below(figure: FoundFigure) -> str | Cell:
    return mark_off(fixed(100 * figure.below, 2), figure.below < 5e-5 or not figure.is_sought)
