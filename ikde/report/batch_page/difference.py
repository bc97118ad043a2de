"""In a sentence, what differs most between the arms of a run."""

import numpy as np

from ikde.batch.statistics import compute_spread
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.markup import verbatim
from ikde.report.numbers import fixed, percent, seconds, significant

ALIKE = 1.5  # medians whose ratio is smaller are called alike
FEW = 20  # from here on a ratio is a whole number


def tell_difference(run: RunAnswers) -> str:
    """Markup: how much is reached, then what takes how much longer; empty of one arm, or before all have begun."""
    arms = [arm for arm in run.arms if arm.solves]
    if len(arms) < 2:
        return ""
    return f"{_tell_rates(arms)}; {_tell_times(arms)}."


def _tell_rates(arms: list[ArmAnswers]) -> str:
    least, most = min(arms, key=lambda arm: arm.rate.share), max(arms, key=lambda arm: arm.rate.share)
    if least.rate.share == most.rate.share:
        return f"All arms reach {'every target' if most.rate.share == 1.0 else percent(100 * most.rate.share)}"
    apart = least.rate.interval[1] < most.rate.interval[0]
    chance = "" if apart else ", which may be chance"
    return (
        f"**{verbatim(most.name)}** reaches most, {percent(100 * most.rate.share)}, **{verbatim(least.name)}** least, "
        f"{percent(100 * least.rate.share)}{chance}"
    )


def _tell_times(arms: list[ArmAnswers]) -> str:
    medians = [spread.median if (spread := compute_spread(arm.numbers["solve_seconds"])) else np.nan for arm in arms]
    slow, fast = int(np.nanargmax(medians)), int(np.nanargmin(medians))
    ratio = medians[slow] / medians[fast] if medians[fast] > 0.0 else np.inf
    if not ALIKE <= ratio < np.inf:
        return "they take about as long"
    times = fixed(ratio, 0) if ratio >= FEW else significant(ratio, 2)
    return (
        f"**{verbatim(arms[slow].name)}** takes {times} times as long as **{verbatim(arms[fast].name)}**, "
        f"{seconds(medians[slow])} against {seconds(medians[fast])} in the median"
    )
