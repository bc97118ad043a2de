"""The tables of a descent have room for all that is named in them, and nothing stands in two places."""

import numpy as np

from ikde.kernels import motion_work
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests.uncompiled import plain_module


def test_each_name_has_its_rows(qiao):
    names = motion_work
    work = plain_module(names).make_motion_work(pack_robot(qiao), CollisionModel.of(qiao).arrays, 9)
    single = [names.HERE, names.TRIAL, names.BEST, names.Y, names.SPLIT, names.STEP, names.ALONG, names.BEHIND]
    single += [names.FREE_POINT, names.POINT, names.PRODUCT, names.ROW]
    many = {names.JACOBIAN: 6, names.ROWS: 6, names.ROTATED: 3, names.SLOPE: names.MAX_CONTACTS}
    rows = single + [first + k for first, count in many.items() for k in range(count)]
    tables = work.tables
    assert sorted(rows) == list(range(len(tables.vectors)))
    assert len(tables.matrices) == len({names.NULL, names.BEND, names.HESSIAN})
    assert len(tables.numbers) == len(
        {names.ERROR, names.MULTIPLIER, names.DIAGONAL, names.SCALE, names.SLACK, names.ERROR_HERE}
    )
    assert len(tables.whole) == len({names.MOVING, names.ORDER, names.PAIR})
    assert len(tables.length) == len(tables.owner) == len(work.spaces.normals) == 2 * 9 + names.MAX_CONTACTS
    assert min(tables.numbers.shape[1], tables.whole.shape[1], len(work.contacts.gap)) >= names.MAX_CONTACTS
    assert np.shape(tables.T_world_body) == (len(pack_robot(qiao).bodies), 3, 4)
