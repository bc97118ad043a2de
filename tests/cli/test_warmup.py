"""`ikde warmup`."""

from ikde.solver.warmup import Stage


def test_stages_are_told_and_tabulated(cli, monkeypatch):
    monkeypatch.setattr(
        "ikde.solver.warmup.list_stages", lambda robot, detector: [Stage(name="first", run=lambda: None)]
    )
    monkeypatch.setattr("ikde.track.run.list_track_stages", lambda robot, detector: [])
    outcome = cli("warmup")
    assert outcome.code == 0
    assert outcome.err == "1 of 1: first\n"
    assert "was ready" in outcome.out
    assert cli("warmup", "--json").data == {"robot": "qiao2021", "stages": [{"name": "first", "compile_seconds": 0.0}]}


def test_bad_names_are_one_line(cli):
    for arguments in (("--robot", "qiao"), ("--detector", "improv")):
        outcome = cli("warmup", *arguments)
        assert outcome.code == 2
        assert len(outcome.err.splitlines()) == 1
