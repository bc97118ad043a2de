"""Ikde's own world files as obstacles: units, frames, orientations, and limits on how much there may be."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.io import world_objects
from ikde.io.world_file import load_world
from tests.world_files import write_good


@pytest.fixture
def world(tmp_path):
    return load_world(write_good(tmp_path))


def test_lengths_are_in_the_units_of_the_file(world):
    ball = world["ball"]
    assert ball.solids[0].size_m == (0.05,)
    assert ball.T_world_obstacle[:, 3] == pytest.approx([0.1, 0.2, 0.3])
    assert (ball.margin_m, ball.ignore, ball.group) == (0.005, (), None)
    assert world["scan"].solids[0].size_m == (0.003,)
    assert world["scan"].solids[0].points[0].tolist() == [0.1, 0.2, 0.3]
    assert world["dust"].solids[0].points[1] == pytest.approx([0.01, 0, 1e-4])


def test_frames_of_the_file_are_resolved_and_others_kept(world):
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    assert world["top"].frame == world["can"].frame == "world"
    assert world["bar"].frame == "flange"
    assert np.allclose(world["can"].T_world_obstacle[:, 3], [0.5 - 0.1 * s, 0.1 * c, 0.4])
    assert np.allclose(world["can"].T_world_obstacle[:, 0], [-s, c, 0])


def test_orientations(world):
    assert np.allclose(world["bar"].T_world_obstacle[:, 2], [1, 0, 0])
    assert world["tip"].T_world_obstacle[:, :3].tolist() == [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    wall = world["wall"].solids[0].T_obstacle_solid
    assert wall[:, 2].tolist() == [-1, 0, 0]


def test_a_rounded_matrix_becomes_the_nearest_rotation():
    c, s = 0.8660254, 0.5
    world = load_world({"obstacles": {"a": {"box": [1, 1, 1], "rotation": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}}})
    R = world["a"].T_world_obstacle[:, :3]
    assert np.abs(R @ R.T - np.eye(3)).max() < 1e-15
    assert np.allclose(R[0], [c, -s, 0], atol=1e-7)


def test_parts_and_columns_are_solids_of_one_obstacle(world):
    assert [solid.kind for solid in world["rack"].solids] == ["box", "sphere"]
    assert world["rack"].solids[0].T_obstacle_solid[:, 3] == pytest.approx([0, 0, 0.1])
    assert [solid.size_m for solid in world["ground"].solids] == [
        pytest.approx(size) for size in ((0.4, 0.2, 0.015), (0.2, 0.2, 0.025), (0.2, 0.2, 0.005))
    ]


def test_a_mesh_is_its_hull_in_its_own_unit(tmp_path, monkeypatch):
    pytest.importorskip("trimesh")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    monkeypatch.chdir(tmp_path)
    file = {"obstacles": {"a": {"mesh": {"path": "a.obj", "scale": [1, 2, 3], "length": "mm"}, "position": [1, 0, 0]}}}
    (solid,) = load_world(file)["a"].solids
    assert solid.points.max(axis=0) == pytest.approx([0.001, 0.002, 0.003])


@pytest.mark.parametrize(
    ("name", "said"), [("MAX_SOLIDS", "at most 3 solids"), ("MAX_CLOUD_POINTS", "at most 3 points")]
)
def test_how_much_there_may_be(tmp_path, monkeypatch, name, said):
    monkeypatch.setattr(world_objects, name, 3)
    with pytest.raises(InputError, match=said):
        load_world(write_good(tmp_path))
