"""The table of engines: one row each, and an engine behind every row."""

import subprocess
import sys
from importlib import import_module
from typing import get_args

import pytest

import ikde
from ikde.model.target import KINDS
from ikde.solver.engine_table import ALL_KINDS, AUTO, ENGINES, SEVERAL, EngineRow, Method


def test_every_method_but_auto_is_an_engine():
    assert get_args(Method) == ("auto", *ENGINES)
    assert set(AUTO) < set(ENGINES)
    assert ALL_KINDS == KINDS


@pytest.mark.parametrize(("name", "row"), ENGINES.items())
def test_a_row_leads_to_its_engine(name, row):
    module, maker = row.maker.split(":")
    assert getattr(import_module(f"ikde.solver.engines.{module}"), maker).name == name


@pytest.mark.parametrize("row", ENGINES.values(), ids=list(ENGINES))
def test_an_engine_takes_over_from_one_that_has_not_spent_more_than_its_own(row):
    assert (row.attempts_before_next or 0) < row.attempts
    assert set(row.compiled_kinds) <= set(row.target_kinds)
    assert row.one_by_one < SEVERAL


@pytest.mark.parametrize("row", ENGINES.values(), ids=list(ENGINES))
def test_what_an_engine_shares_with_the_de_is_a_setting_of_it(row):
    assert all(hasattr(ikde.DeSettings(), name) for name in row.shared_settings)
    assert row.label.format(de=ikde.DeSettings())


def test_the_last_engine_of_auto_answers_whatever_is_asked():
    last = ENGINES[AUTO[-1]]
    assert (last.target_kinds, last.is_closed_form, last.stays_in_limits) == (KINDS, False, False)


def test_a_row_says_what_sets_an_engine_apart():
    plain = EngineRow(maker="", brief="", label="", attempts=1)
    assert not any((plain.is_closed_form, plain.stays_in_limits, plain.starts_near, plain.counts_all_pairs))


def test_the_table_is_there_without_numpy():
    code = "import sys; import ikde.solver.engine_table; sys.exit('numpy' in sys.modules or 'numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
