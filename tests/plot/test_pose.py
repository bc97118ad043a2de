"""Figures of a pose and of frames: everything that is to be drawn is there, in the colour of its role, to scale."""

from collections import Counter

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import ikde
from ikde.errors import FileError
from ikde.model.collision_model import CollisionModel
from ikde.plot.pose import plot_frames, plot_pose, save_figure
from ikde.scene.drawn_pose import COLORS, Role, draw_frames, draw_pose

TARGET = ikde.Target((0.8, 0.5, 1.0))
NAMES = ["Ob", "O1", "Oc12", "O2", "Oc23", "O3", "O4", "O5", "O6", "tool"]


@pytest.fixture(scope="module", params=[2.6, 0.0], ids=["folded", "straight"])
def pose(qiao, request):
    """The arm in the load, and up in the air."""
    q = qiao.home
    q[4:6] = request.param
    return draw_pose(CollisionModel.of(qiao, "improved"), q, target=TARGET)


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def surfaces(axes):
    return [artist for artist in axes.collections if type(artist).__name__ == "Poly3DCollection"]


def hue(surface):
    """Its colour at full brightness; shading scales all three channels alike."""
    colors = np.asarray(surface.get_facecolor())[:, :3]
    brightest = colors[colors.sum(axis=1).argmax()]
    return tuple(np.round(brightest / max(brightest.max(), 1e-9), 1))


def hue_of(role):
    rgb = np.array(to_rgb(COLORS[role]))
    return tuple(np.round(rgb / rgb.max(), 1))


def test_every_sphere_is_drawn_in_the_colour_of_its_role(pose):
    drawn = Counter(hue(surface) for surface in surfaces(plot_pose(pose).axes[0]))
    assert drawn == Counter(hue_of(role) for role in pose.robot.roles[pose.robot.parts])


def test_the_legend_names_each_role_once(pose):
    roles = dict.fromkeys(pose.robot.roles[pose.robot.parts])
    marks = [mark.text for mark in pose.marks]
    assert labels(plot_pose(pose).axes[0]) == ["links", *(f"{role} spheres" for role in roles), *marks]


def test_marks_are_drawn_where_they_are(pose):
    closest, target, base = pose.marks
    assert base.role is Role.BASE
    axes = plot_pose(pose).axes[0]
    line = next(line for line in axes.lines if line.get_label() == closest.text)
    assert line.get_color() == COLORS[Role.CLOSEST]
    np.testing.assert_array_equal(np.array(line.get_data_3d()).T, closest.points_m)
    mark = next(mark for mark in axes.collections if mark.get_label() == target.text)
    assert to_rgb(mark.get_facecolor()[0][:3]) == pytest.approx(to_rgb(COLORS[Role.TARGET]))
    assert axes.get_title() == pose.title


def test_without_spheres_and_target_the_links_are_drawn(qiao):
    axes = plot_pose(draw_pose(CollisionModel.of(qiao, "none"), qiao.home)).axes[0]
    assert surfaces(axes) == []
    tool = ikde.forward(qiao, qiao.home)["tool"][:3, 3]
    assert np.array(axes.lines[0].get_data_3d())[:, -1] == pytest.approx(tool)


def test_everything_drawn_is_inside_the_axes_at_one_scale(any_robot):
    pose = draw_pose(CollisionModel.of(any_robot), any_robot.home, target=TARGET)
    axes = plot_pose(pose).axes[0]
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    assert np.ptp(limits, axis=1) == pytest.approx(np.ptp(limits[0]))
    low, high = pose.compute_box()
    assert np.all(limits[:, 0] <= low + 1e-9)
    assert np.all(high <= limits[:, 1] + 1e-9)


@pytest.mark.parametrize(("name", "start"), [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")])
def test_the_file_is_of_its_kind(qiao, tmp_path, name, start):
    save_figure(plot_pose(draw_pose(CollisionModel.of(qiao, "none"), qiao.home, target=TARGET)), tmp_path / name)
    assert (tmp_path / name).read_bytes().startswith(start)


@pytest.mark.parametrize(("name", "words"), [("a.xyz", "cannot be drawn"), ("nowhere/a.png", "cannot be written")])
def test_a_file_that_cannot_be_made_is_one_line(qiao, tmp_path, name, words):
    figure = plot_pose(draw_pose(CollisionModel.of(qiao, "none"), qiao.home))
    with pytest.raises(FileError, match=words) as caught:
        save_figure(figure, tmp_path / name)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def frames(qiao):
    return plot_frames(draw_frames(qiao, qiao.home, NAMES, title="home")).axes[0]


def test_every_frame_has_its_name_and_three_axes(frames):
    assert [text.get_text() for text in frames.texts] == NAMES
    assert len(frames.lines) == 1 + 3 * len(NAMES)
    assert frames.get_title() == "home"


def test_a_metre_is_a_metre_in_every_direction(frames):
    spans = [np.ptp(axis.get_view_interval()) for axis in (frames.xaxis, frames.yaxis, frames.zaxis)]
    scales = np.array(frames._box_aspect) / spans
    assert np.ptp(scales) < 0.05 * np.mean(scales)


def test_axes_are_named_with_their_unit(frames):
    assert [frames.get_xlabel(), frames.get_ylabel(), frames.get_zlabel()] == ["x [m]", "y [m]", "z [m]"]


def test_a_figure_is_written_through_a_link_and_never_in_part(tmp_path, qiao):
    (tmp_path / "link.svg").symlink_to("aim.svg")
    save_figure(plot_frames(draw_pose(CollisionModel.of(qiao, "none"), qiao.home)), tmp_path / "link.svg")
    assert (tmp_path / "link.svg").is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["aim.svg", "link.svg"]
    (tmp_path / "folder.svg").mkdir()
    with pytest.raises(FileError, match="no ordinary file"):
        save_figure(plot_frames(draw_pose(CollisionModel.of(qiao, "none"), qiao.home)), tmp_path / "folder.svg")


def test_a_region_is_drawn_with_what_its_lines_are(qiao):
    region = ikde.Region.any_of([ikde.Region.box(TARGET, 0.1), ikde.Region.look_at((1, 0, 0), (0.3, 0.6))])
    region = region.with_base([(0, 0), (2, 0), (2, 2)])
    pose = draw_pose(CollisionModel.of(qiao), qiao.home, target=TARGET, region=region, alternative=1)
    axes = plot_pose(pose).axes[0]
    assert labels(axes)[-3:] == ["region: alternative 2 of 2", "other alternatives", "where the base may stand"]
    drawn = {line.get_label(): line for line in axes.lines}
    reached, others, floor = (drawn[label] for label in labels(axes)[-3:])
    assert reached.get_linewidth() > others.get_linewidth()
    assert (reached.get_color(), floor.get_color()) == (COLORS[Role.REGION], COLORS[Role.BASE])
    assert floor.get_linestyle() == "--"
