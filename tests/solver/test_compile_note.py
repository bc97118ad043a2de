"""What is compiled is said once, by whoever is outermost, and only if it is compiled."""

import sys

import pytest

from ikde.kernels.jit import CLOCKS, compile_clock
from ikde.model.collision_model import CollisionModel
from ikde.solver import compile_note
from ikde.solver.compile_note import name_work, note_compile


def begin_to_compile():
    """What numba tells each clock."""
    for clock in tuple(CLOCKS):
        clock.start()
        clock.end()


def test_work_is_named_by_robots_and_detectors(qiao):
    default, none = CollisionModel.of(qiao), CollisionModel.of(qiao, "none")
    assert name_work("pose targets", default) == "pose targets of qiao2021, detector improved"
    assert name_work("many targets", default, none, default) == "many targets of qiao2021, detector improved, none"


@pytest.mark.parametrize(("kept", "often"), [(True, "once on this machine"), (False, "every time, since no cache")])
def test_it_is_said_in_one_line_when_it_begins(capsys, monkeypatch, kept, often):
    monkeypatch.setattr(compile_note.cache_folder, "CACHE_IS_WRITABLE", kept)
    with note_compile(lambda: "a\x1b\nb", "a minute"):
        assert capsys.readouterr().err == ""
        begin_to_compile()
        begin_to_compile()
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith(rf"compiling the kernels for a\x1b\nb: {often}")
    assert said.err.endswith(", a minute ...\n")
    assert said.err.count("\n") == 1


def test_where_nothing_is_compiled_nothing_is_named_or_said(capsys):
    with note_compile(lambda: pytest.fail("asked for a name")) as clock:
        pass
    assert (capsys.readouterr().err, clock.seconds) == ("", 0.0)


def test_the_outermost_speaks_for_all(capsys):
    with compile_clock(), note_compile(lambda: "all"), note_compile(lambda: "a part"):
        begin_to_compile()
    assert capsys.readouterr().err.startswith("compiling the kernels for all: ")
    heard = []
    with compile_clock(lambda: heard.append("mine")), note_compile(lambda: "a part"):
        begin_to_compile()
    assert (heard, capsys.readouterr().err) == (["mine"], "")
    with note_compile(lambda: "a part"):
        begin_to_compile()
    assert "a part" in capsys.readouterr().err


def test_a_program_without_a_console_hears_nothing(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    with note_compile(lambda: "a"):
        begin_to_compile()
