"""The whole page of a run."""

from collections.abc import Sequence

from ikde.batch.manifest import Manifest
from ikde.batch.statistics import Rate, compute_spread
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.batch_page.clearance import make_clearance
from ikde.report.batch_page.cost import make_cost
from ikde.report.batch_page.difference import tell_difference
from ikde.report.batch_page.graders import make_graders
from ikde.report.batch_page.missed import make_missed
from ikde.report.batch_page.places import make_places
from ikde.report.batch_page.recipe import make_again, make_recipe, run_command
from ikde.report.batch_page.success import make_success
from ikde.report.batch_page.worlds import make_worlds
from ikde.report.batch_page.worst import make_worst
from ikde.report.markup import code, verbatim
from ikde.report.numbers import count_of, fixed, length, seconds
from ikde.report.page import Block, Notice, Number, Numbers, Page, Text

MAX_NUMBERS = 4  # arms that get large type


def make_batch_page(run: RunAnswers) -> Page:
    """What came of a run, finished or not, as a page."""
    manifest = run.manifest
    sections = [
        make_success(run),
        make_worlds(run),
        make_places(run),
        make_worst(run),
        make_cost(run),
        make_clearance(run),
        make_graders(run),
        make_missed(run),
    ]
    shown = [section for section in sections if section] if run.parts_done else []
    return Page(
        title=manifest.name,
        subtitle=_describe(manifest),
        lead=(*_warn(run), *_headline(run)),
        sections=(*shown, make_recipe(run), make_again(run)),
        footer=f"Made by ikde {verbatim(manifest.versions.get('ikde', ''))} from the answers in "
        f"{code(str(run.folder))}.",
    )


def _describe(manifest: Manifest) -> str:
    arms = f"{len(manifest.arms)} arms, " if len(manifest.arms) > 1 else ""
    repeats = f", {manifest.repeats:,} solves each" if manifest.repeats > 1 else ""
    asked = f"{arms}{count_of(manifest.targets, 'target')}{repeats}, seed {manifest.seed}"
    return f"A batch of inverse kinematics: robot {manifest.robot}, {asked}."


def _warn(run: RunAnswers) -> list[Block]:
    """Say so if parts are missing."""
    if run.finished:
        return []
    solves = sum(arm.solves for arm in run.arms)
    asked = run.manifest.solves * len(run.manifest.arms)
    return [
        Notice(
            f"**This run is not finished**: {run.parts_done:,} of {run.manifest.parts:,} parts are there, {solves:,} "
            f"of {asked:,} solves. Everything below is about these. {say_how_to_go_on(run)}"
        )
    ]


def say_how_to_go_on(run: RunAnswers) -> str:
    """The command that finishes a run, if its file is known."""
    if not run.manifest.file:
        return "The same call of `run_batch` goes on."
    return f"{code(run_command(run))} goes on."


def _headline(run: RunAnswers) -> list[Block]:
    if not run.parts_done:
        return []
    difference = [Text(text)] if (text := tell_difference(run)) else []
    if len(run.arms) == 1:
        return [Numbers((_reached("reached", run.rate, run.arms), *_cost(run.arms[0])))]
    if len(run.arms) > MAX_NUMBERS:
        return [Numbers((_reached("reached, over all arms", run.rate, run.arms),)), *difference]
    if len({arm.rate.share for arm in run.arms}) == 1:
        times = [compute_spread(arm.numbers["solve_seconds"]) for arm in run.arms]
        solves = [
            Number(seconds(time.median), f"a solve by {arm.name}", "median")
            for arm, time in zip(run.arms, times, strict=True)
            if time
        ]
        return [Numbers((_reached("reached, by every arm", run.rate, run.arms), *solves)), *difference]
    return [Numbers(tuple(_reached(f"reached by {arm.name}", arm.rate, [arm]) for arm in run.arms)), *difference]


def _reached(label: str, rate: Rate, arms: Sequence[ArmAnswers]) -> Number:
    note, unchecked = f"{rate.count:,} of {rate.total:,} solves", sum(arm.collision_checked is False for arm in arms)
    if unchecked:
        note += f", self-collision not checked{f' in {unchecked} of {len(arms)} arms' if unchecked < len(arms) else ''}"
    return Number(format_share(rate), label, note)


def _cost(arm: ArmAnswers) -> list[Number]:
    """Time, attempts and clearance of the only arm."""
    numbers = []
    time, attempts = (compute_spread(arm.numbers.get(name, ())) for name in ("solve_seconds", "attempts"))
    if time:
        most = f"95 % within {seconds(time.p95)}" if arm.timed_alone else "timed in calls of several"
        numbers.append(Number(seconds(time.median), "a solve, median", most))
    if attempts:
        numbers.append(Number(fixed(attempts.median, 0), "attempts, median", f"95 % within {fixed(attempts.p95, 0)}"))
    clearance_m = arm.of_reached("clearance_m")
    if clearance_m.size:
        numbers.append(
            Number(
                length(float(clearance_m.min())), "smallest clearance", f"of the reached, detector {arm.facts.detector}"
            )
        )
    return numbers


def format_share(rate: Rate) -> str:
    """`99.4 %`; never 100 % or 0 % of what is not all or nothing."""
    if not rate.total:
        return "–"
    if 0 < rate.count < rate.total and not 0.05 <= 100 * rate.share < 99.95:
        return "> 99.9 %" if rate.share > 0.5 else "< 0.1 %"
    return f"{fixed(100 * rate.share, 1)} %"
