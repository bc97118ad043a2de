"""`ikde report`: a page beside the answers or where it is asked for, and words for what is no run."""

import shutil

import pytest

import ikde
from tests.batch.small import make_batch

FILES = ["report.html", "report.md"]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A run whose targets are not reached."""
    folder = tmp_path_factory.mktemp("report") / "run"
    ikde.run_batch(make_batch(), folder)
    return folder


@pytest.fixture
def run(made, tmp_path):
    """A copy to write into."""
    return shutil.copytree(made, tmp_path / "run")


def contents(folder):
    """Relative path -> bytes of all files."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_the_page_goes_beside_the_answers(cli, run):
    before = contents(run)
    outcome = cli("report", run)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out == f"wrote {run / 'report' / 'report.html'}\nwrote {run / 'report' / 'report.md'}\n"
    assert names(run / "report") == FILES
    assert "</html>" in (run / "report" / "report.html").read_text(encoding="utf-8")
    assert (run / "report" / "report.md").read_text(encoding="utf-8").startswith("# small\n")
    after = contents(run)
    assert {name: after[name] for name in before} == before
    assert len(after) == len(before) + 2


def test_a_link_in_place_of_the_pages_folder_is_refused(cli, run, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (run / "report").symlink_to(tmp_path / "elsewhere")
    outcome = cli("report", run)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err == f"ikde: {run / 'report'}: is a symbolic link; a run holds none\n"
    assert names(tmp_path / "elsewhere") == []


def test_the_same_run_gives_the_same_bytes(cli, run):
    cli("report", run)
    before = contents(run)
    cli("report", run)
    assert contents(run) == before


def test_the_batch_goes_on_beside_its_page(cli, run):
    cli("report", run)
    (run / "solutions" / "auto-00004.parquet").unlink()
    assert ikde.run_batch(make_batch(), run).finished
    assert names(run / "report") == FILES


def test_out_is_where_it_goes_and_other_files_stay(cli, run, tmp_path):
    before, out = contents(run), tmp_path / "pages" / "new"
    assert cli("report", run, "--out", out).code == 0
    (out / "notes.txt").write_text("mine")
    (out / "report.md").write_text("an earlier one")
    outcome = cli("report", run, "--out", out)
    assert outcome.out.startswith(f"wrote {out / 'report.html'}\n")
    assert names(out) == ["notes.txt", *FILES]
    assert (out / "notes.txt").read_text() == "mine"
    assert (out / "report.md").read_text(encoding="utf-8").startswith("# small\n")
    assert contents(run) == before


def test_json_names_the_files_and_says_if_the_run_is_finished(cli, run):
    html, markdown = (str(run / "report" / name) for name in FILES)
    assert cli("report", run, "--json").data == {"html": html, "markdown": markdown, "finished": True}
    (run / "solutions" / "auto-00004.parquet").unlink()
    outcome = cli("report", run, "--json")
    assert (outcome.code, outcome.data["finished"]) == (0, False)
    assert "not finished" in (run / "report" / "report.md").read_text(encoding="utf-8")


def test_what_is_no_run_is_refused(refuse, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.txt").write_text("mine")
    assert "holds no run of ikde" in refuse("report", tmp_path / "mine")
    assert "holds no run of ikde" in refuse("report", tmp_path / "none")
    (tmp_path / "mine" / "manifest.json").write_text("{}")
    assert "holds no run of ikde" in refuse("report", tmp_path / "mine", "--out", tmp_path / "out")


def test_a_damaged_part_is_named(refuse, run):
    part = run / "solutions" / "auto-00002.parquet"
    part.write_bytes(part.read_bytes()[:-20])
    assert f"{part}: cannot be read" in refuse("report", run)


def test_a_file_is_no_folder_for_a_page(refuse, run, tmp_path):
    (tmp_path / "page").write_text("mine")
    assert "this is a file" in refuse("report", run, "--out", tmp_path / "page")
