"""What an answer was moved for, and how much it has of that."""

from dataclasses import dataclass
from typing import Literal

Prefer = Literal["manipulability", "clearance", "limits", "motion"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Preferred:
    """What an answer was moved for, and how much it has of that."""

    what: Prefer
    before: float
    """As the search found it: the scaled manipulability (`solver/objectives.py`), m of clearance beyond what is asked
    for, the smallest share of its range that a joint is from its limits, or the motion from `near`, else home."""
    after: float
    """Of the answer."""
    steps: int
    """Taken in between; 0 if the target leaves no freedom, or nothing nearby was better."""
    settled: bool
    """Whether it is a local optimum as far as slopes tell; False: the steps ended before, or it was not reached."""
