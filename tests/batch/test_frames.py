"""The one-liners of docs/batch.md: a run's answers in other people's tables."""

from pathlib import Path

import pytest

import ikde
from tests.batch.small import BLINK, make_arm, make_batch

DOCS = Path(__file__).parents[2] / "docs" / "batch.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("run")
    ikde.run_batch(make_batch(arms=(make_arm("a", **BLINK), make_arm("b", **BLINK))), path)
    return path


def run_line(library, folder):
    """The line of the page that names the library, on this run; its value."""
    module = pytest.importorskip(library)
    line = next(line for line in DOCS.read_text(encoding="utf-8").splitlines() if SIGNS[library] in line)
    code = line.removeprefix("frame = ").replace("runs/first", folder.as_posix())
    return eval(code, {"ikde": ikde, library: module})


SIGNS = {"pandas": ".to_pandas()", "polars": "polars.from_arrow(", "duckdb": "duckdb.sql("}


def test_pandas_reads_a_run(folder):
    frame = run_line("pandas", folder)
    assert frame.shape == ikde.read_batch(folder).shape
    assert frame.groupby("arm", observed=True)["reached"].mean().to_dict() == {"a": 0.0, "b": 0.0}


def test_polars_reads_a_run(folder):
    frame = run_line("polars", folder)
    assert frame.shape == ikde.read_batch(folder).shape
    assert frame["target"].to_list() == ikde.read_batch(folder)["target"].to_pylist()


def test_duckdb_asks_the_parts_themselves(folder):
    assert sorted(run_line("duckdb", folder).fetchall()) == [("a", 0.0), ("b", 0.0)]
