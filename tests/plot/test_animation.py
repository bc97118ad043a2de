"""A motion as data to play: whole millimetres, frames in time."""

import json

import numpy as np
import pytest

import ikde
from ikde.plot.animation import make_animation
from tests.track.measured import make_measured


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao, amplitude=2.6)


def test_frames_are_samples_and_the_last_is_among_them(motion):
    data = make_animation(motion, 6)
    assert data["times"] == [0.0, 0.08, 0.16, 0.24, 0.32, 0.4]
    assert data["done"] == [1, 5, 9, 13, 17, 21]
    assert data["end"] == 0.4


def test_bones_lead_to_the_tool(qiao, motion):
    data = make_animation(motion)
    assert np.shape(data["bones"]) == (21, 11, 3)
    for q, bones in zip(motion.trajectory.q, data["bones"], strict=True):
        np.testing.assert_allclose(bones[-1], 1e3 * ikde.forward(qiao, q)["tool"][:3, 3], atol=0.5)


def test_spheres_have_their_parts(qiao, motion):
    data = make_animation(motion)
    count = sum(row.count for row in qiao.approximations[motion.collision.detector.spheres])
    assert np.shape(data["centres"]) == (21, count, 3)
    assert len(data["radii"]) == len(data["parts"]) == count
    assert {data["names"][part] for part in data["base"]} == {"M", "G"}
    assert [{data["names"][part] for part in black} for black in data["black"]] == motion.colliding


def test_it_is_json_also_without_a_detector(qiao):
    data = make_animation(make_measured(qiao, detector="none"), 3)
    assert json.loads(json.dumps(data)) == data
    assert data["centres"] == [[], [], []]
