"""Formula 23 and Figure 6: where both models put the arm's key points."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.bench.misprints import Data, meant
from ikde.model.convention import from_convention
from ikde.model.robot import Robot
from ikde.solver.forward import forward

MODELS = {"key_point": "Table 1(b), key points", "classical": "Table 1(a), Denavit-Hartenberg"}


def compute_kinematics(robots: Mapping[str, Robot], published: Mapping[str, Any]) -> Data:
    """Every point of Formula 23 as printed and by both models, mm in the world.

    Args:
        robots: `key_point` (qiao2021) and `classical` (qiao2021_dh).
        published: `io.published.load_published()`.
    """
    formula = published["formula_23"]
    q = np.radians(formula["q_classical_deg"])
    frames = {model: forward(robots[model], q, convention="classical") for model in MODELS}
    return {
        "exact": {
            "points": [_compute_point(point, frames) for point in formula["points"]],
            "figures": [_describe_figure(model, robots[model], q, formula) for model in MODELS],
            "models_differ_mm": _compare_models(formula, frames),
        },
        "measured": {},
        "settings": {
            "source": "[Qiao2021, Formula 23]",
            "q_classical_deg": formula["q_classical_deg"],
            "rounding_mm": formula["rounding_mm"],
            "models": MODELS,
        },
    }


def _compute_point(point: Mapping[str, Any], frames: Mapping[str, Mapping[str, Any]]) -> Data:
    right = meant(point)["xyz_mm"]
    ours = {model: 1e3 * frames[model][point[model]][:3, 3] for model in MODELS}
    return {
        "names": {model: point[model] for model in MODELS},
        "printed_mm": point["xyz_mm"],
        "meant_mm": right,
        "misprint": point.get("misprint"),
        "ours_mm": {model: xyz.tolist() for model, xyz in ours.items()},
        "difference_mm": {model: float(np.abs(xyz - point["xyz_mm"]).max()) for model, xyz in ours.items()},
        "difference_to_meant_mm": {model: float(np.abs(xyz - right).max()) for model, xyz in ours.items()},
    }


def _describe_figure(model: str, robot: Robot, q: np.ndarray, formula: Mapping[str, Any]) -> Data:
    """What Figure 6 draws of one model: the configuration, and the frames along the arm."""
    return {
        "model": model,
        "robot": robot.name,
        "q": from_convention(robot, q, "classical").tolist(),
        "frames": ["Ob", *(point[model] for point in formula["points"]), robot.tool],
    }


def _compare_models(formula: Mapping[str, Any], frames: Mapping[str, Mapping[str, Any]]) -> float:
    """Largest distance between the same point of both models."""
    a, b = ([frames[model][point[model]][:3, 3] for point in formula["points"]] for model in MODELS)
    return float(1e3 * np.linalg.norm(np.subtract(a, b), axis=1).max())
