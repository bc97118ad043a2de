"""One configuration of the robot with its spheres, as the paper draws it: arm red, platform blue, collisions black."""

from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import FileError
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.pairs import component_bodies
from ikde.model.robot import WORLD, Robot
from ikde.model.target import Target
from ikde.model.tree import Tree, build_tree
from ikde.plot.images import any_letters, show_as_text
from ikde.solver.check import compute_pairs
from ikde.solver.plain import compute_components, compute_frames, compute_sphere_gaps

ARM, BASE, COLLIDING, CLOSEST, TARGET = "#d1352b", "#3568b8", "#1a1a1a", "#0b8a3c", "#e69f00"
AXES = ("#c00000", "#008000", "#0000c0")
MESH = 24  # facets around a sphere
MARGINS = (0.0, 0.03, 0.95, 0.92)  # left, bottom, width, height; a layout engine would draw everything twice
AXIS_LENGTH_M = 0.15
NOT_CHECKED = "self-collision not checked"


def plot_pose(
    collision: CollisionModel,
    q: Floats,
    *,
    target: Target | None = None,
    size_in: tuple[float, float] = (9.0, 8.0),
) -> Any:
    """Draw the robot at `q` [N] with the spheres that are compared, the closest pair and the target.

    Returns:
        A matplotlib `Figure`; axes in metres, world frame.
    """
    from matplotlib.figure import Figure

    robot = collision.robot
    figure = Figure(figsize=size_in, dpi=130)
    axes: Any = figure.add_axes(MARGINS, projection="3d", computed_zorder=False)
    _set_view(axes, robot, q)
    _draw_skeleton(axes, robot, q)
    told = _draw_spheres(axes, collision, q) if collision.pairs else NOT_CHECKED
    if target is not None:
        axes.scatter(*target.p_world_tool, marker="*", s=160, color=TARGET, label="target", depthshade=False, zorder=11)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title=f"{robot.name}  ·  {told}")
    _set_equal(axes, collision, q, target)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", fontsize=9, framealpha=0.9)
    return show_as_text(figure)


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure; raises `FileError` if the ending is unknown or the file cannot be written."""
    try:
        with any_letters():
            figure.savefig(path)
    except ValueError as error:
        raise FileError(path, f"cannot be drawn: {error}") from None
    except OSError as error:
        raise FileError(path, f"cannot be written: {error.strerror or error}") from None


def _draw_skeleton(axes: Any, robot: Robot, q: Floats) -> None:
    """The line of key points from the base to the tool, and the tool's axes (x red, y green, z blue)."""
    axes.plot(*compute_bones(robot, q).T, "o-", color="0.2", linewidth=2.0, markersize=3.5, zorder=5)
    T_world_tool = compute_frames(robot, q)[robot.tool]
    for k, color in enumerate(AXES):
        tip = T_world_tool[:3, 3] + AXIS_LENGTH_M * T_world_tool[:3, k]
        axes.plot(*np.array([T_world_tool[:3, 3], tip]).T, color=color, linewidth=2.5, zorder=6)


def _drawn_chain(robot: Robot) -> list[str]:
    """Frames from the base to the tool, without the rails that a mobile base slides on."""
    frames = {frame.name: frame for frame in robot.frames}
    kinds = {joint.name: joint.kind for joint in robot.joints}
    chain = [robot.tool]
    while frames[chain[-1]].parent != WORLD:
        chain.append(frames[chain[-1]].parent)
    chain = chain[::-1]
    while len(chain) > 1 and kinds.get(frames[chain[0]].joint or "") == "prismatic":
        chain = chain[1:]
    return chain


def compute_bones(robot: Robot, q: Floats) -> Floats:
    """Key points [..., n, 3] of the drawn chain for `q` [..., N], world frame, m."""
    Ts_world = compute_frames(robot, q)
    return np.stack([Ts_world[name][..., :3, 3] for name in _drawn_chain(robot)], axis=-2)


def _draw_spheres(axes: Any, collision: CollisionModel, q: Floats) -> str:
    """Spheres in the paper's colours and the closest pair; returns what the title says of them."""
    components, pairs = compute_components(collision, q), compute_pairs(collision, q)
    colliding = {name for pair in pairs if pair.collides for name in (pair.a, pair.b)}
    base = base_components(collision)
    labelled: set[str] = set()
    for name, (centres, radii) in components.items():
        color, label = (BASE, "base") if name in base else (ARM, "arm")
        if name in colliding:
            color, label = COLLIDING, "colliding"
        for centre, radius in zip(centres, radii, strict=True):
            _draw_sphere(axes, centre, radius, color, label=None if label in labelled else f"{label} spheres")
            labelled.add(label)
    closest = pairs[0]
    a, b = components[closest.a], components[closest.b]
    gaps = compute_sphere_gaps(a, b)
    i, j = np.unravel_index(int(np.argmin(gaps)), gaps.shape)
    text = f"{closest.a}-{closest.b}: {closest.clearance_m * 1e3:.1f} mm"
    axes.plot(
        *np.array([a[0][i], b[0][j]]).T,
        "o-",
        color=CLOSEST,
        linewidth=2.5,
        markersize=4,
        zorder=10,
        label=f"closest pair, {text}",
    )
    state = "self-collision" if colliding else "free of self-collision"
    return f"detector {collision.name}: {state}"


def base_components(collision: CollisionModel) -> set[str]:
    """Components that no other component carries: the platform and what is fixed to it."""
    tree = build_tree(collision.robot)
    bodies = component_bodies(collision.rows, tree)
    occupied = set(bodies.values())
    return {name for name, body in bodies.items() if not occupied & _bodies_below(tree, body)}


def _bodies_below(tree: Tree, body: int) -> set[int]:
    """The bodies that carry `body`."""
    below: set[int] = set()
    while body != 0:
        body = tree.bodies[body].parent
        below.add(body)
    return below


def _draw_sphere(axes: Any, centre: Floats, radius: float, color: str, label: str | None) -> None:
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, MESH), np.linspace(0, np.pi, MESH // 2))
    x, y, z = np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)
    surface = axes.plot_surface(
        centre[0] + radius * x,
        centre[1] + radius * y,
        centre[2] + radius * z,
        color=color,
        alpha=0.4,
        linewidth=0,
        antialiased=True,
        shade=True,
        zorder=1.0 + 0.01 * _nearness(axes, centre),
    )
    surface.set_label(label or "_nolegend_")


def _set_view(axes: Any, robot: Robot, q: Floats) -> None:
    """Look at the robot from its right, a little from the front and from above."""
    heading = compute_frames(robot, q)[_drawn_chain(robot)[0]][:2, 0]
    axes.view_init(elev=16, azim=float(np.degrees(np.arctan2(heading[1], heading[0]))) - 68)


def _nearness(axes: Any, point: Floats) -> float:
    """How near a point is to the eye: spheres are drawn from far to near, lines and marks above them all."""
    elevation, azimuth = np.radians([axes.elev, axes.azim])
    towards_eye = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)]
    return float(np.dot(point, towards_eye))


def _set_equal(axes: Any, collision: CollisionModel, q: Floats, target: Target | None) -> None:
    """One scale for all three axes, around everything that is drawn."""
    lows = list(compute_bones(collision.robot, q))
    highs = list(lows)
    if target is not None:
        lows.append(target.p_world_tool)
        highs.append(target.p_world_tool)
    for centres, radii in compute_components(collision, q).values():
        lows.append((centres - radii[:, None]).min(axis=0))
        highs.append((centres + radii[:, None]).max(axis=0))
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    middle, half = 0.5 * (low + high), 0.5 * float((high - low).max()) * 1.02
    axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    axes.set_zlim(low[2], low[2] + 2 * half)
    axes.set_box_aspect((1, 1, 1))
