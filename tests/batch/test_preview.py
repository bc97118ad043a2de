"""What would run, and for how long."""

import pytest

import ikde
from ikde.batch.preview import preview_batch
from tests.batch.small import BLINK, ROBOT, make_arm, make_batch, read_files

ARMS = (make_arm("a", **BLINK), make_arm("b", detector="none", **BLINK))


@pytest.fixture
def batch():
    return make_batch(arms=ARMS, repeats=5, chunk=20, graders=(ROBOT.detectors["typical"],))


def test_it_says_what_would_run(batch):
    preview = preview_batch(batch, threads=1)
    assert (preview.targets, preview.repeats, preview.solves, preview.parts) == (12, 5, 120, 6)
    assert [(arm.name, arm.detector) for arm in preview.arms] == [("a", "improved"), ("b", "none")]
    assert preview.threads == 1
    assert {"arm", "q_q1", "typical_collides"} <= set(preview.columns)


def test_short_arms_are_sampled_whole(batch):
    preview = preview_batch(batch)
    assert [arm.sample for arm in preview.arms] == [60, 60]
    assert preview.seconds == sum(arm.seconds for arm in preview.arms) > 0.0


def test_long_arms_are_sampled_for_their_share_of_the_time(batch, monkeypatch):
    monkeypatch.setattr("ikde.batch.preview.SAMPLE_SECONDS", 0.0)
    assert [arm.sample for arm in preview_batch(batch, threads=3).arms] == [3, 3]


def test_it_knows_what_the_answers_will_weigh(batch, tmp_path):
    ikde.run_batch(batch, tmp_path)
    weight = sum(len(data) for kind in ("solutions", "timing") for data in read_files(tmp_path, kind).values())
    assert preview_batch(batch).bytes == pytest.approx(weight, rel=0.3)
