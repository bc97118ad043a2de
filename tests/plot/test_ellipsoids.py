"""Ellipsoids of velocity: one a part, in the drawing of the robot and at the side."""

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.plot.ellipsoids import DRAWN_M, plot_ellipsoids
from ikde.scene.drawn_pose import draw_pose
from ikde.solver.analysis import split_jacobian


def test_each_part_has_its_ellipsoid_at_scale(qiao):
    analysis = ikde.analyze(qiao, qiao.home)
    parts, pose = split_jacobian(analysis), draw_pose(CollisionModel.of(qiao), qiao.home)
    p = ikde.forward(qiao, qiao.home)["tool"][:3, 3]
    figure = plot_ellipsoids(pose, p, parts)
    drawn, velocity, rotation = figure.axes
    assert [axes.get_title() for axes in (velocity, rotation)] == ["velocity [m/s]", "angular velocity [rad/s]"]
    for axes in (velocity, rotation):
        assert [text.get_text() for text in axes.get_legend().get_texts()] == ["whole", "arm", "base"]
    shown = {own.get_label(): own for own in drawn.collections if own.get_label() in parts}
    points = np.concatenate([np.array(line) for line in shown["whole"]._segments3d])
    far = np.linalg.norm(points - p, axis=1).max()
    assert far <= DRAWN_M + 1e-9
    assert far > 0.9 * DRAWN_M
    flat = np.concatenate([np.array(line) for line in shown["base"]._segments3d])
    assert np.ptp(flat[:, 2]) < 1e-12


def test_an_arm_without_a_base_is_drawn_once():
    robot = ikde.load_robot("panda")
    parts = split_jacobian(ikde.analyze(robot, robot.home))
    figure = plot_ellipsoids(draw_pose(CollisionModel.of(robot), robot.home), np.zeros(3), parts)
    assert [text.get_text() for text in figure.axes[1].get_legend().get_texts()] == ["whole"]
