"""Commands in this process: quick, with what they print and their exit code."""

import json
import sys
from dataclasses import dataclass

import pytest

import ikde
from ikde.cli.app import run
from ikde.solver.settings import BulkOptions
from tests.flat_settings import flat_settings

BLAS_PROBE = "scipy.linalg.cython_blas"


@dataclass(frozen=True)
class Outcome:
    """What a command did."""

    code: int
    out: str
    err: str

    @property
    def data(self):
        return json.loads(self.out)


@pytest.fixture(autouse=True, scope="session")
def _kernels_are_compiled():
    """So that no command has to say that it compiles."""
    settings = flat_settings(population=6, generations=1, restarts=1)
    ikde.solve_many(ikde.load_robot("qiao2021"), [ikde.Target((0, 0, 1))], settings, bulk=BulkOptions(explain=False))


@pytest.fixture(autouse=True)
def _no_terminal_is_so_wide(monkeypatch):
    """Workers of pytest say how wide their terminal is."""
    monkeypatch.delenv("COLUMNS", raising=False)


@pytest.fixture(autouse=True)
def _scipy_stays_whole():
    """`ikde solve` hides one module of scipy from its own process; other tests need it."""
    yield
    if sys.modules.get(BLAS_PROBE, run) is None:
        del sys.modules[BLAS_PROBE]


@pytest.fixture
def cli(capsys):
    """Run one command."""

    def call(*arguments):
        capsys.readouterr()
        code = run([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Outcome(code, captured.out, captured.err)

    return call


@pytest.fixture
def refuse(cli, tmp_path, monkeypatch):
    """Run one command that must be refused: exit code 2, a line a fault on stderr, nothing printed, nothing written."""

    def call(*arguments):
        monkeypatch.chdir(tmp_path)
        before = sorted(tmp_path.rglob("*"))
        outcome = cli(*arguments)
        assert (outcome.code, outcome.out) == (2, ""), outcome
        lines = outcome.err.splitlines()  # one for each thing that is wrong, and one for how many more there are
        assert 1 <= len(lines) <= 11, outcome.err
        assert all(line.startswith("ikde") for line in lines)
        assert sorted(tmp_path.rglob("*")) == before
        return outcome.err

    return call
