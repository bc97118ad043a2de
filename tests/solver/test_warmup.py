"""Warming up names what it compiles, and compiles it."""

import ikde
from ikde.model.target import KINDS
from ikde.solver.warmup import Stage, list_stages, warm_up


def test_every_engine_and_kind_has_a_stage(qiao):
    names = [stage.name for stage in list_stages(qiao)]
    assert names == [
        *(f"lm, {call} {kind}" for kind in KINDS for call in ("one", "near", "many of")),
        *("analytic, one pose", "analytic, near pose", "analytic"),
        *("memetic", "de"),
    ]


def test_a_robot_without_a_closed_form_has_no_such_stage():
    assert not [stage.name for stage in list_stages(ikde.load_robot("panda")) if "analytic" in stage.name]


def test_stages_run_in_order_and_are_announced(qiao):
    ran, told = [], []
    stages = [Stage(name=name, run=lambda name=name: ran.append(name)) for name in ("a", "b")]
    done = warm_up(stages, lambda number, stage: told.append((number, stage.name)))
    assert ran == ["a", "b"]
    assert told == [(0, "a"), (1, "b")]
    assert [(stage.name, stage.seconds) for stage in done] == [("a", 0.0), ("b", 0.0)]


def test_what_was_warmed_up_is_ready(qiao):
    stage = list_stages(qiao)[0]
    warm_up([stage])
    assert warm_up([stage])[0].seconds == 0.0
