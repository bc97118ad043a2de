"""A picture of the robot: small, with its caption, for any detector."""

from dataclasses import replace

from ikde.plot.pose import plot_pose
from ikde.report.paper import pictures
from ikde.report.paper.pictures import draw_robot


def test_a_picture_is_a_small_png_with_its_caption(robots, substitute):
    substitute(pictures.plot_pose, plot_pose)
    robot = robots["key_point"]
    looks = replace(robot.detectors["typical"], pairs="load_arm")
    for detector in ("improved", looks):
        figure = draw_robot(robot, robot.home.tolist(), detector, caption="home", target_mm=(800, 500, 1000))
        assert figure.image.startswith(b"\x89PNG")
        assert len(figure.image) < 200_000
        assert (figure.caption, figure.alt) == ("home", "home")
