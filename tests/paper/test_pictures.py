"""A picture of the robot: small, with its caption, for any detector."""

from ikde.model.collision_model import CollisionModel
from ikde.paper import pictures
from ikde.paper.pictures import draw_robot
from ikde.paper.section import make_collision
from ikde.plot.pose import plot_pose


def test_a_picture_is_a_small_png_with_its_caption(qiao, substitute):
    substitute(pictures.plot_pose, plot_pose)
    for collision in (CollisionModel.of(qiao, "improved"), make_collision(qiao, "typical", "load_arm")):
        figure = draw_robot(collision, qiao.home.tolist(), caption="home", target_mm=(800, 500, 1000))
        assert figure.image.startswith(b"\x89PNG")
        assert len(figure.image) < 200_000
        assert (figure.caption, figure.alt) == ("home", "home")
