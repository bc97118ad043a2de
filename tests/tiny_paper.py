"""The paper's report, as small as it can be."""

from dataclasses import replace

import ikde
from ikde.bench.budget import QUICK
from ikde.bench.paper import Sources
from ikde.io.published import load_misprints, load_published

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
)


def load_sources():
    """What the report is computed from."""
    return Sources(
        key_point=ikde.load_robot("qiao2021"),
        classical=ikde.load_robot("qiao2021_dh"),
        published=load_published(),
        misprints=load_misprints(),
    )
