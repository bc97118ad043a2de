"""The figure of a pose: the paper's colours, the closest pair, the target, and a file."""

from collections import Counter

import numpy as np
import pytest
from matplotlib.colors import to_rgb

import ikde
from ikde.errors import FileError
from ikde.model.collision_model import CollisionModel
from ikde.plot.pose import ARM, BASE, CLOSEST, COLLIDING, TARGET, base_components, plot_pose, save_figure


@pytest.fixture(scope="module")
def folded(qiao):
    """The arm in the load."""
    q = qiao.home
    q[4:6] = 2.6, 2.6
    return q


def axes_of(robot, *arguments, detector="none", **options):
    choice = detector
    return plot_pose(CollisionModel.of(robot, choice), *arguments, **options).axes[0]


def labels(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def surfaces(axes):
    return [artist for artist in axes.collections if type(artist).__name__ == "Poly3DCollection"]


def hue(surface):
    """Its colour at full brightness; shading scales all three channels alike."""
    colors = np.asarray(surface.get_facecolor())[:, :3]
    brightest = colors[colors.sum(axis=1).argmax()]
    return tuple(np.round(brightest / max(brightest.max(), 1e-9), 1))


def hue_of(color):
    rgb = np.array(to_rgb(color))
    return tuple(np.round(rgb / rgb.max(), 1))


def test_every_sphere_is_drawn_in_the_colour_of_its_part(qiao):
    detector = qiao.detectors["improved"]
    drawn = Counter(hue(surface) for surface in surfaces(axes_of(qiao, qiao.home, detector=detector)))
    spheres = Counter()
    for row in qiao.approximations["improved"]:
        spheres[hue_of(BASE if row.component in ("M", "G") else ARM)] += row.count
    assert drawn == spheres


def test_colliding_components_are_black(qiao, folded):
    detector = qiao.detectors["improved"]
    colliding = {c for pair in ikde.check(qiao, folded).pairs if pair.collides for c in (pair.a, pair.b)}
    drawn = Counter(hue(surface) for surface in surfaces(axes_of(qiao, folded, detector=detector)))
    black = sum(row.count for row in qiao.approximations["improved"] if row.component in colliding)
    assert colliding
    assert drawn[hue_of(COLLIDING)] == black


def test_the_legend_names_each_colour_once(qiao, folded):
    detector = qiao.detectors["improved"]
    free = labels(axes_of(qiao, qiao.home, detector=detector))
    assert [label for label in free if "spheres" in label] == ["base spheres", "arm spheres"]
    assert "colliding spheres" in labels(axes_of(qiao, folded, detector=detector))


def test_the_closest_pair_is_labelled_with_its_clearance(qiao):
    axes = axes_of(qiao, qiao.home, detector=qiao.detectors["improved"])
    pair = ikde.check(qiao, qiao.home).pairs[0]
    text = f"closest pair, {pair.a}-{pair.b}: {pair.clearance_m * 1e3:.1f} mm"
    assert text in labels(axes)
    line = next(line for line in axes.lines if line.get_label() == text)
    assert line.get_color() == CLOSEST


def test_the_closest_pair_is_drawn_between_the_two_spheres(qiao):
    axes = axes_of(qiao, qiao.home, detector=qiao.detectors["improved"])
    line = next(line for line in axes.lines if line.get_label().startswith("closest pair"))
    frames = ikde.forward(qiao, qiao.home)
    ends = np.array(line.get_data_3d()).T
    expected = [frames["O3"][:3, 3], frames["O6"][:3, 3]]  # J4 and J6
    assert sorted(map(tuple, ends.round(9))) == sorted(map(tuple, np.array(expected).round(9)))


def test_the_title_says_the_verdict(qiao, folded):
    detector = qiao.detectors["improved"]
    assert "free of self-collision" in axes_of(qiao, qiao.home, detector=detector).get_title()
    title = axes_of(qiao, folded, detector=detector).get_title()
    assert title.endswith("self-collision")
    assert "free" not in title


def test_an_unchecked_pose_is_not_called_free(qiao, folded):
    assert axes_of(qiao, folded).get_title() == "qiao2021  ·  self-collision not checked"


def test_a_target_is_marked(qiao):
    axes = axes_of(qiao, qiao.home, target=ikde.Target((0.8, 0.5, 1.0)))
    assert labels(axes) == ["target"]
    marks = [mark for mark in axes.collections if mark.get_label() == "target"]
    assert to_rgb(marks[0].get_facecolor()[0][:3]) == pytest.approx(to_rgb(TARGET))


def test_without_spheres_and_target_the_skeleton_is_drawn(qiao):
    axes = axes_of(qiao, qiao.home)
    assert surfaces(axes) == []
    tool = ikde.forward(qiao, qiao.home)["tool"][:3, 3]
    assert np.array(axes.lines[0].get_data_3d())[:, -1] == pytest.approx(tool)


def test_everything_drawn_is_inside_the_axes_at_one_scale(any_robot):
    detector = CollisionModel.of(any_robot).detector
    axes = axes_of(any_robot, any_robot.home, detector=detector, target=ikde.Target((0.8, 0.5, 1.0)))
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    assert np.ptp(limits, axis=1) == pytest.approx(np.ptp(limits[0]))
    for line in axes.lines[:1]:
        points = np.array(line.get_data_3d())
        assert np.all(limits[:, :1] <= points + 1e-9)
        assert np.all(points <= limits[:, 1:] + 1e-9)


def test_the_base_of_the_paper_is_platform_and_load(qiao):
    for detector in qiao.detectors.values():
        assert base_components(CollisionModel(robot=qiao, detector=detector)) == {"M", "G"}


@pytest.mark.parametrize(("name", "base"), [("ur5", {"base"}), ("panda", {"link0"})])
def test_the_base_of_a_fixed_robot_is_its_foot(name, base):
    robot = ikde.load_robot(name)
    assert base_components(CollisionModel.of(robot)) == base


@pytest.mark.parametrize(("name", "start"), [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF")])
def test_the_file_is_of_its_kind(qiao, tmp_path, name, start):
    save_figure(
        plot_pose(CollisionModel.of(qiao, "none"), qiao.home, target=ikde.Target((0.8, 0.5, 1.0))), tmp_path / name
    )
    assert (tmp_path / name).read_bytes().startswith(start)


@pytest.mark.parametrize(("name", "words"), [("a.xyz", "cannot be drawn"), ("nowhere/a.png", "cannot be written")])
def test_a_file_that_cannot_be_made_is_one_line(qiao, tmp_path, name, words):
    figure = plot_pose(CollisionModel.of(qiao, "none"), qiao.home, target=ikde.Target((0.8, 0.5, 1.0)))
    with pytest.raises(FileError, match=words) as caught:
        save_figure(figure, tmp_path / name)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []
