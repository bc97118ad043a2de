"""The linear algebra of a step of the descent."""

import numpy as np
import pytest

from ikde.kernels import motion_step, motion_work
from ikde.kernels.motion_work import ALONG, HESSIAN, NULL, POINT, PRODUCT, ROW, STEP
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests.uncompiled import plain_module

kernels, rooms = plain_module(motion_step), plain_module(motion_work)


def make_work(qiao, hessian):
    """Room, with a reduced Hessian as `fill_hessian` leaves it."""
    work = rooms.make_motion_work(pack_robot(qiao), CollisionModel.of(qiao).arrays, 9)
    size = len(hessian)
    work.tables.matrices[HESSIAN, :size, :size] = np.triu(hessian, 1)
    work.tables.vectors[PRODUCT, :size] = np.diag(hessian)
    return work


def random_hessian(rng, smallest):
    """Symmetric [4, 4] with this smallest eigenvalue."""
    Q, _ = np.linalg.qr(rng.standard_normal((4, 4)))
    return Q @ np.diag([smallest, 0.8, 1.0, 1.7]) @ Q.T


@pytest.mark.parametrize(("smallest", "shifts"), [(0.5, {0.0}), (-0.3, {0.25, 0.5, 1.0}), (-5.0, {4.0, 8.0})])
def test_what_bends_the_wrong_way_is_shifted_until_it_does_not(qiao, rng, smallest, shifts):
    for _ in range(5):
        hessian = random_hessian(rng, smallest)
        work = make_work(qiao, hessian)
        is_bent = kernels.factor_hessian(work.tables, 4)
        L = np.tril(work.tables.matrices[HESSIAN, :4, :4])
        rest = L @ L.T - hessian
        assert is_bent == (smallest < 0.0)
        assert min(abs(rest[0, 0] - shift) for shift in shifts) < 1e-12
        np.testing.assert_allclose(rest, rest[0, 0] * np.eye(4), atol=1e-12)


def test_a_step_is_what_brings_the_tool_and_what_leaves_it(qiao, rng):
    hessian = random_hessian(rng, 0.5)
    work = make_work(qiao, hessian)
    tables = work.tables
    kernels.factor_hessian(tables, 4)
    L = np.tril(tables.matrices[HESSIAN, :4, :4])
    null, along, point = rng.standard_normal((4, 9)), rng.standard_normal(9), rng.standard_normal(4)
    tables.matrices[NULL, :4], tables.vectors[ALONG], tables.vectors[POINT, :4] = null, along, point
    kernels.set_step(tables, 5, 9)
    np.testing.assert_allclose(tables.vectors[STEP], along + np.linalg.solve(L.T, point) @ null, rtol=1e-12)


def test_a_half_space_has_a_unit_normal_and_keeps_its_bound(qiao, rng):
    work = make_work(qiao, random_hessian(rng, 0.5))
    tables = work.tables
    kernels.factor_hessian(tables, 4)
    L, row = np.tril(tables.matrices[HESSIAN, :4, :4]), rng.standard_normal(4)
    tables.vectors[ROW, :4] = row
    assert kernels.add_half_space(work, 4, 0.7, 5, 0) == 1
    normal, offset = work.spaces.normals[0], work.spaces.offsets[0]
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    assert (normal[4:] == 0.0).all()
    u = rng.standard_normal(4)
    assert (normal[:4] @ (L.T @ u) - offset) * tables.length[0] == pytest.approx(row @ u - 0.7)
    assert tables.owner[0] == 5
    tables.vectors[ROW, :4] = 0.0
    assert kernels.add_half_space(work, 4, 0.7, 5, 1) == 1
