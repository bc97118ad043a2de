"""`ikde bench paper`: files that are whole, a check that finds what was changed, and words for what is wrong."""

import json
from dataclasses import asdict

import pytest
from matplotlib.figure import Figure

from ikde.paper import inputs
from ikde.plot.pose import plot_pose
from ikde.plot.surfaces import plot_surface
from tests.tiny_paper import TINY


@pytest.fixture
def report(cli, tmp_path, monkeypatch, substitute):
    """A tiny report in a folder of its own, its pictures blank: each takes half a second."""
    monkeypatch.setattr(inputs, "QUICK", TINY)
    for plot in (plot_pose, plot_surface):
        substitute(plot, lambda *_, **__: Figure(figsize=(1, 1)))
    outcome = cli("bench", "paper", "--out", tmp_path / "report", "--quick")
    assert outcome.code == 0, outcome
    return tmp_path / "report", outcome


def test_a_report_is_a_page_its_markdown_and_its_data_and_the_data_checks(cli, report):
    folder, outcome = report
    assert sorted(path.name for path in folder.iterdir()) == ["report.html", "report.md", "results.json"]
    assert outcome.out.startswith(f"wrote {folder / 'results.json'}\n")
    assert "computing: rejection" in outcome.err
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "Table 4" in page
    assert "A quick run" in page

    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    before = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
    checked = cli("bench", "paper", "--out", folder, "--check")
    assert (checked.code, checked.out) == (0, f"{folder / 'results.json'}: every exact figure comes out the same\n")

    results["made"]["only"] = ["kinematics"]
    results["sections"] = {"kinematics": results["sections"]["kinematics"]}
    results["sections"]["kinematics"]["exact"]["points"][0]["printed_mm"][0] += 1.0
    (folder / "results.json").write_text(json.dumps(results))
    tampered = cli("bench", "paper", "--out", folder, "--check", "--json")
    assert tampered.code == 1
    assert tampered.data["agrees"] is False
    assert [line.split(":")[0] for line in tampered.data["differences"]] == ["kinematics.exact.points[0].printed_mm[0]"]
    del before[folder / "results.json"]
    assert all(path.stat().st_mtime_ns == time for path, time in before.items())


def test_a_check_needs_a_record(refuse, tmp_path):
    assert "no such file" in refuse("bench", "paper", "--out", tmp_path / "none", "--check")


def test_a_damaged_record_is_one_line(refuse, tmp_path):
    (tmp_path / "results.json").write_text(
        json.dumps({"made": {"budget": asdict(TINY), "only": []}, "sections": {"kinematics": 3}})
    )
    assert "sections.kinematics: expected a mapping" in refuse("bench", "paper", "--out", tmp_path, "--check")


def test_a_check_takes_its_sizes_from_the_record(refuse):
    assert "--quick" in refuse("bench", "paper", "--check", "--quick")


def test_sections_alone(cli, tmp_path):
    outcome = cli("bench", "paper", "--out", tmp_path / "r", "--only", "kinematics,approximation,misprints")
    assert outcome.code == 0
    page = (tmp_path / "r" / "report.md").read_text(encoding="utf-8")
    assert [line[3:] for line in page.splitlines() if line.startswith("## ")] == [
        *(
            "Formula 23 and Figure 6: kinematics",
            "Table 2 and Figure 7: sphere approximations",
            "Misprints, puzzles and what was calibrated",
            "How this was made",
        ),
    ]
    assert "ikde bench paper --only kinematics --out report/" in page
    assert cli("bench", "paper", "--out", tmp_path / "r", "--check").code == 0


@pytest.mark.parametrize("only", ["kinematic", "", ",", "kinematics,x"])
def test_an_unknown_section_is_refused(refuse, only):
    assert "expected some of kinematics, approximation" in refuse("bench", "paper", "--only", only)


def test_a_file_is_no_folder(refuse, tmp_path):
    (tmp_path / "report").write_text("mine")
    assert "this is a file" in refuse("bench", "paper", "--out", tmp_path / "report")


def test_an_unknown_benchmark_is_refused(refuse):
    assert "paperr" in refuse("bench", "paperr")
