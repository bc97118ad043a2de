"""Table 2 and Figure 7: volumes of the sphere approximations, and their clearance at home."""

from collections.abc import Mapping
from typing import Any

from ikde.bench.misprints import Data, meant
from ikde.model.robot import Robot
from ikde.model.spheres import approximation_volume_m3
from ikde.solver.check import check

APPROXIMATIONS = ("typical", "improved")
DETECTORS = ("single", *APPROXIMATIONS)
HALF_DIGIT = 5e-5  # relative, at most: what five printed digits leave open of a volume, and so of its degree


def compute_approximation(robot: Robot, published: Mapping[str, Any]) -> Data:
    """Table 2's volumes (mm^3) and degrees (part / spheres, %) as printed and ours, and who is free at home.

    Args:
        robot: qiao2021.
        published: `io.published.load_published()`.
    """
    volumes = {name: approximation_volume_m3(robot, name) for name in DETECTORS}
    sizes = {name: sum(row.count for row in robot.approximations[name]) for name in DETECTORS}
    return {
        "exact": {
            "components": [_compute_component(robot, volumes, *item) for item in published["table_2"].items()],
            "home": [_compute_home(robot, detector) for detector in DETECTORS],
            "sphere_counts": sizes,
            "total_volume_mm3": {name: 1e9 * sum(volumes[name].values()) for name in DETECTORS},
        },
        "measured": {},
        "settings": {"source": "[Qiao2021, Table 2 and section 5.3.1]", "figure": {"q": robot.home.tolist()}},
    }


def _compute_component(robot: Robot, volumes: Mapping[str, Mapping[str, float]], name: str, entry: Data) -> Data:
    original = entry["original_mm3"]
    return {
        "component": name,
        "part": entry["part"],
        "original_mm3": original,
        **{key: _compare(robot, key, name, original, 1e9 * volumes[key][name], entry[key]) for key in APPROXIMATIONS},
    }


def _compare(robot: Robot, approximation: str, name: str, original: float, volume: float, entry: Data) -> Data:
    degree, right = 100.0 * original / volume, meant(entry)["degree_pct"]
    return {
        "spheres": describe_spheres(robot, approximation, name),
        "provenance": find_provenance(robot, approximation, name),
        "volume_mm3": {"printed": entry["volume_mm3"], "ours": volume},
        "degree_pct": {"printed": entry["degree_pct"], "meant": right, "ours": degree},
        "agrees": f"{volume:.4e}" == f"{entry['volume_mm3']:.4e}" and abs(degree - right) < 0.0051 + HALF_DIGIT * right,
        "misprint": entry.get("misprint"),
    }


def describe_spheres(robot: Robot, approximation: str, component: str) -> str:
    """Counts and radii of a component's spheres, as in `3 x R80 + 1 x R80` (mm), rows in their order."""
    rows = [row for row in robot.approximations[approximation] if row.component == component]
    return " + ".join(f"{row.count} x R{1e3 * row.radius_m:g}" for row in rows)


def find_provenance(robot: Robot, approximation: str, component: str) -> list[str]:
    """Kinds of the sources of a component's rows: what is derived, and whether anything of it is calibrated."""
    rows = robot.approximations[approximation]
    named = {("spheres", approximation, index) for index, row in enumerate(rows) if row.component == component}
    return sorted({source.kind for path, source in robot.provenance.items() if path[:3] in named})


def _compute_home(robot: Robot, detector: str) -> Data:
    seen = check(robot, robot.home, detector)
    return {
        "detector": detector,
        "printed": "collides" if detector == "single" else "free",
        "collides": seen.collision,
        "clearance_mm": 1e3 * seen.pairs[0].clearance_m,
        "pair": [seen.pairs[0].a, seen.pairs[0].b],
        "colliding_pairs": [[pair.a, pair.b] for pair in seen.pairs if pair.collides],
    }
