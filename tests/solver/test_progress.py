"""Silence says nothing, whatever it is told."""

from ikde.solver.progress import SILENCE


def test_silence_says_nothing(capsys):
    SILENCE.begin("section")
    SILENCE.advance(3)
    assert capsys.readouterr() == ("", "")
