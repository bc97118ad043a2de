"""Robots that were imported from public descriptions and ship: sources, a free home, answers without a compiler."""

import numpy as np
import pytest

import ikde
from ikde.io.robots import FOLDER
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps
from tests.conftest import BY_HAND

IMPORTED = [name for name in ikde.robot_names() if name not in BY_HAND]
LICENCES = ("(Apache-2.0)", "(BSD)", "(BSD-3-Clause)")


@pytest.mark.parametrize("name", IMPORTED)
def test_every_number_has_a_source_and_the_description_a_licence(name):
    robot = ikde.load_robot(name)
    where = robot.provenance
    assert all(("frames", frame.name) in where for frame in robot.frames)
    limited = [joint.name for joint in robot.joints if joint.kind != "continuous"]
    assert all(("joints", joint, key) in where for joint in limited for key in ("lower", "upper"))
    assert all(("joints", joint, "home") in where for joint in robot.joint_names)
    assert all(("spheres", kind, k) in where for kind, rows in robot.approximations.items() for k in range(len(rows)))
    (published,) = {source.text for source in where.values() if source.kind == "published"}
    assert any(licence in published for licence in LICENCES)


@pytest.mark.parametrize("name", IMPORTED)
def test_home_is_free_and_so_are_many_configurations(name, rng):
    robot = ikde.load_robot(name)
    collision = CollisionModel.of(robot)
    assert compute_gaps(collision, robot.home[None]).min() > 0.0
    q = rng.uniform(*robot.drawn, (400, len(robot.joints)))
    assert (compute_gaps(collision, q).min(axis=1) > 0.0).mean() > 0.15


@pytest.mark.parametrize("name", IMPORTED)
def test_no_link_is_left_without_spheres_by_the_import(name):
    """All surfaces were proved to lie inside: said in the source of the spheres."""
    robot = ikde.load_robot(name)
    (said,) = {source.text for where, source in robot.provenance.items() if where[0] == "spheres"}
    assert "100 % of the surface of every link is proved to lie inside" in said


def test_they_take_little_room():
    files = [FOLDER / file for name in IMPORTED for file in (f"{name}.yaml", f"ready/{name}.json")]
    assert sum(path.stat().st_size for path in files) < 500_000


@pytest.mark.parametrize("name", IMPORTED)
def test_a_pose_is_reached_without_a_compiler(name, rng, monkeypatch):
    monkeypatch.setenv("IKDE_COMPILE", "never")
    monkeypatch.setenv("IKDE_KERNELS", "written")
    robot = ikde.load_robot(name)
    q = next(q for q in rng.uniform(*robot.drawn, (100, len(robot.joints))) if not ikde.check(robot, q).collision)
    T = ikde.forward(robot, q)["tool"]
    result = ikde.solve(robot, ikde.Target.from_matrix(T))
    assert result.reached
    np.testing.assert_allclose(ikde.forward(robot, result.q)["tool"], T, atol=1e-3)
