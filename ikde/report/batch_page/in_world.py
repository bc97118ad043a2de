"""A row among the obstacles of its run: its picture, and the command that checks it again."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ikde.errors import InputError
from ikde.io.world_file import load_world
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target
from ikde.plot.images import to_png
from ikde.plot.pose import plot_pose
from ikde.report.batch_page.answers import RunAnswers
from ikde.report.page import Figure
from ikde.scene.drawn_pose import draw_pose

DPI = 90


def place_arm(run: RunAnswers, arm: str, collision: CollisionModel) -> CollisionModel | None:
    """What an arm compared, in its world; None where that is no file any more, or another one than the run's."""
    known = run.manifest.recipe.get("arms", {}).get(arm, {}).get("world")
    file = find_file(run, arm)
    if not isinstance(known, dict) or "digest" not in known:
        return collision
    if file is None:
        return None
    try:
        world = load_world(file)
        placed = collision.in_world(world, known["margin_m"], known["margins_m"])
    except (InputError, KeyError, TypeError):
        return None
    return placed if world.digest == known["digest"] else None


def find_file(run: RunAnswers, arm: str) -> Path | None:
    """The world file of an arm."""
    file = next(facts.world_file for facts in run.manifest.arms if facts.name == arm)
    return None if file is None else Path(run.manifest.file or "").parent / file


def draw_in_world(placed: CollisionModel, q: Floats, target_m: Sequence[float], alt: str) -> Figure:
    """The robot at `q` [N] with what is near, and what it touches."""
    pose = draw_pose(placed, q, target=Target(target_m) if len(target_m) else None)
    picture = to_png(plot_pose(replace(pose, title="")), dpi=DPI)
    caption = (
        "Its configuration in its world. What is too near is purple, and what it touches of the robot black (white "
    )
    caption += "on a dark page)."
    return Figure(image=picture, alt=alt, caption=caption)


def check_command(placed: CollisionModel, file: Path, robot: str, q: Floats) -> str:
    """`ikde check --world ...` of a configuration `q` [N], m and rad."""
    margins = [repr(placed.margin_m), *(f"{name}={margin_m!r}" for name, margin_m in placed.margins_m)]
    values = " ".join(map(repr, q.tolist()))
    asked = ["--detector", placed.name, "--world", str(file), "--margin", ",".join(margins), "--q", values]
    return shlex.join(["ikde", "check", "--robot", robot, *asked, "--plot", "row.png"])
