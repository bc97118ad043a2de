"""The paper's report, as small as it can be."""

from dataclasses import replace
from functools import cache

from ikde.paper.inputs import QUICK, load_inputs
from ikde.paper.results import compute_paper

TINY = replace(
    QUICK,
    solves=3,
    variation_solves=1,
    waits=1,
    timing_rounds=1,
    verdicts=20,
    surface_verdicts=5,
    timed_verdicts=3,
    curve_points=11,
    run_steps_per_s=5,
)


class Record:
    """Progress, kept."""

    def __init__(self):
        self.sections, self.solves = [], 0

    def begin(self, section):
        self.sections.append(section)

    def advance(self, solves):
        self.solves += solves


@cache
def compute_tiny():
    """(results, what progress heard): once for all tests, which change nothing in it."""
    record = Record()
    return compute_paper(replace(load_inputs(TINY), progress=record)), record
