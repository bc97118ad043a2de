"""Where the targets are, which of them were reached, and how clear."""

import numpy as np

from ikde.plot.images import to_svg
from ikde.plot.places import Places, plot_places
from ikde.report.batch_page.answers import RunAnswers
from ikde.report.numbers import significant
from ikde.report.page import Figure, Section

CLASSES = ("#D55E00", "#E69F00", "#56B4E9", "#0072B2")  # from the least clearance to the largest
MISSED, PARTLY, PLAIN = "#CC79A7", "#009E73", "#0072B2"


def make_places(run: RunAnswers) -> Section | None:
    """The targets from above and from the side; None if the run does not keep where they are."""
    if not run.places_m:
        return None
    targets = np.array(sorted(run.places_m))
    points = np.array([run.places_m[target] for target in targets.tolist()])
    reached, solves = _count(run, targets)
    clearance_m = _find_clearance(run, targets)
    looks = [(*group, "o") for group in _classify(clearance_m, reached == solves)]
    looks.append(("reached at times", (reached > 0) & (reached < solves), PARTLY, "^"))
    looks.append(("not reached", reached == 0, MISSED, "x"))
    groups = [
        Places(label=label, points_m=points[chosen], color=color, marker=marker)
        for label, chosen, color, marker in looks
        if chosen.any()
    ]
    total = run.manifest.targets
    few = f" {len(targets):,} of {total:,}, equally spaced." if len(targets) < total else ""
    how = ", coloured by the least clearance of their solutions" if np.isfinite(clearance_m).any() else ""
    figure = Figure(
        image=to_svg(plot_places(groups)),
        alt="The targets from above and from the side, by whether they were reached",
        caption=f"The targets from above and from the side{how}.{few}",
    )
    return Section("Targets", (figure,), anchor="targets")


def _count(run: RunAnswers, targets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How often each target was reached, of how many solves [targets] each."""
    reached, solves = np.zeros(len(targets), dtype=np.int64), np.zeros(len(targets), dtype=np.int64)
    for arm in run.arms:
        shown = np.isin(arm.numbers["target"], targets)
        where = np.searchsorted(targets, arm.numbers["target"][shown])
        solves += np.bincount(where, minlength=len(targets))
        reached += np.bincount(where[arm.reached[shown]], minlength=len(targets))
    return reached, solves


def _find_clearance(run: RunAnswers, targets: np.ndarray) -> np.ndarray:
    """The least of all solutions that reached a target [targets], NaN where there is none."""
    least = np.full(len(targets), np.inf)
    for arm in run.arms:
        if "clearance_m" in arm.numbers:
            values, numbers = arm.numbers["clearance_m"], arm.numbers["target"]
            known = arm.reached & np.isfinite(values) & np.isin(numbers, targets)
            np.minimum.at(least, np.searchsorted(targets, numbers[known]), values[known])
    return np.where(np.isfinite(least), least, np.nan)


def _classify(clearance_m: np.ndarray, always: np.ndarray) -> list[tuple[str, np.ndarray, str]]:
    """Targets that were always reached, in classes of as many each, by clearance."""
    known = always & np.isfinite(clearance_m)
    groups = [("reached", always & ~known, PLAIN)]
    if known.any():
        ends = np.unique(np.quantile(clearance_m[known], np.linspace(0.0, 1.0, len(CLASSES) + 1)))
        which = np.clip(np.searchsorted(ends, clearance_m, side="right") - 1, 0, max(len(ends) - 2, 0))
        for k, color in enumerate(CLASSES[: max(len(ends) - 1, 1)]):
            low, high = (significant(1e3 * float(ends[min(place, len(ends) - 1)])) for place in (k, k + 1))
            label, members = f"{low} to {high} mm" if low != high else f"{low} mm", known & (which == k)
            if label == groups[-1][0]:  # what reads the same is one class
                members = members | groups.pop()[1]
            groups.append((label, members, color))
    return groups
