"""Figures of a world: every obstacle by its number and name; what is off is an outline."""

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from ikde.io.world_file import load_world
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world
from ikde.plot.pose import plot_pose
from ikde.plot.style import COLORS
from ikde.plot.world import MAX_LABELS, OFF_ALPHA, plot_world
from ikde.scene.drawn_pose import Role, draw_pose
from ikde.scene.drawn_world import draw_world
from ikde.solver.plain import compute_components
from tests.three_joints import ROBOT, free_q
from tests.world_files import write_good


def labels(figure):
    legend = figure.axes[0].get_legend()
    return [text.get_text() for text in legend.get_texts()] if legend else []


@pytest.fixture
def world(tmp_path):
    return load_world(write_good(tmp_path))


def test_every_obstacle_is_named_once(world):
    figure = plot_world(draw_world(world, "kitchen $x$"))
    assert labels(figure) == [f"{k} {name}" for k, name in enumerate(world.names, 1)]
    assert figure.axes[0].get_title().startswith("kitchen $x$")
    numbers = [text.get_text() for text in figure.axes[0].texts]
    assert numbers == [str(k) for k in range(1, len(world) + 1)]


def test_colours_and_what_is_off(world):
    figure = plot_world(draw_world(world, ""))
    faces = {c.get_label(): c for c in figure.axes[0].collections if not c.get_label().startswith("_")}
    assert tuple(faces["1 ball"].get_facecolor()[0][:3]) == pytest.approx(to_rgb(COLORS[0]))
    assert faces["3 can"].get_facecolor()[0][3] == OFF_ALPHA


def test_many_obstacles_are_counted():
    ball = make_solid("sphere", [0.1])
    many = make_world([make_obstacle(f"o{k}", [ball]) for k in range(MAX_LABELS + 2)])
    figure = plot_world(draw_world(many, "many"))
    assert len(labels(figure)) == MAX_LABELS
    assert figure.axes[0].get_title() == "many  ·  and 2 more"


def test_an_empty_world():
    assert labels(plot_world(draw_world(World(), "empty"))) == []


def test_obstacles_beside_a_robot_are_named_and_what_is_too_near_has_a_colour():
    q = free_q(1)[0]
    hand = compute_components(CollisionModel.of(ROBOT), q)["hand"][0].mean(axis=0)
    T = np.eye(4)
    T[:3, 3] = hand
    bead = make_obstacle("bead", [make_solid("sphere", (0.02,))], T)
    T[2, 3] += 0.4
    world = make_world([bead, make_obstacle("$box$", [make_solid("box", (0.1, 0.1, 0.1))], T)])
    figure = plot_pose(draw_pose(CollisionModel.of(ROBOT).in_world(world), q))
    assert {text.get_text() for text in figure.axes[0].texts} == {"bead", "$box$"}
    assert {Role.OBSTACLE, Role.TOUCHED, "colliding spheres"} <= set(labels(figure))
