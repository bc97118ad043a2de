"""Where the print is wrong and what was chosen inside what it leaves free: the page of misprints and calibrations."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from ikde.model.robot import Robot

Data = dict[str, Any]


def meant(entry: Mapping[str, Any]) -> Data:
    """A published entry as it was meant: its misprint, if it has one, put right."""
    return {**entry, **entry.get("misprint", {})}


def compute_misprints(robot: Robot, misprints: Sequence[Mapping[str, str]]) -> Data:
    """Every misprint and puzzle of the papers, and every number of the robot that the print does not force.

    Args:
        robot: qiao2021.
        misprints: `io.published.load_misprints()`.
    """
    entries = [dict(entry) for entry in misprints]
    chosen = [
        {"number": ".".join(str(key) for key in path), "kind": source.kind, "why": source.text}
        for path, source in robot.provenance.items()
        if source.kind == "calibrated"
    ]
    kinds = Counter(source.kind for source in robot.provenance.values())
    return {
        "exact": {
            "misprints": [entry for entry in entries if entry["kind"] == "misprint"],
            "puzzles": [entry for entry in entries if entry["kind"] == "puzzle"],
            "calibrated": chosen,
            "provenance_counts": {kind: kinds[kind] for kind in ("published", "derived", "calibrated")},
        },
        "measured": {},
        "settings": {"robot": robot.name, "evidence": "tests/test_published.py, benchmarks/calibrate.py"},
    }
