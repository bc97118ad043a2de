"""The report's topics in their order: what computes each, and what shows it."""

from collections.abc import Callable
from typing import Any, NamedTuple

from ikde.paper.approximation import compute_approximation, show_approximation
from ikde.paper.detection import compute_detection
from ikde.paper.detection_page import show_detection
from ikde.paper.inputs import Inputs
from ikde.paper.kinematics import compute_kinematics, show_kinematics
from ikde.paper.misprints import compute_misprints, show_misprints
from ikde.paper.rejection import compute_rejection
from ikde.paper.rejection_page import show_rejection
from ikde.paper.section import Computed
from ikde.paper.sensitivity import compute_sensitivity, show_sensitivity
from ikde.paper.situations import compute_situations, show_situations
from ikde.paper.solutions import compute_solutions, show_solutions
from ikde.paper.timing import compute_timing
from ikde.paper.timing_page import show_timing
from ikde.paper.waiting import compute_waiting, show_waiting
from ikde.report.page import Section


class Topic(NamedTuple):
    """A section of the report."""

    compute: Callable[[Inputs], Computed]
    show: Callable[[Any, Inputs], Section]


TOPICS = {
    "kinematics": Topic(compute_kinematics, show_kinematics),
    "approximation": Topic(compute_approximation, show_approximation),
    "timing": Topic(compute_timing, show_timing),
    "rejection": Topic(compute_rejection, show_rejection),
    "sensitivity": Topic(compute_sensitivity, show_sensitivity),
    "waiting": Topic(compute_waiting, show_waiting),
    "detection": Topic(compute_detection, show_detection),
    "solutions": Topic(compute_solutions, show_solutions),
    "situations": Topic(compute_situations, show_situations),
    "misprints": Topic(compute_misprints, show_misprints),
}
