"""`ikde batch`."""

import json
import signal
import subprocess
import sys
import time

import pytest

import ikde
from ikde.batch.preview import preview_batch
from tests.substitutes import never

SPEC = """
robot: qiao2021
targets:
  inline:
    - {name: near, position: [0.5, 0.2, 0.8]}
    - {position: [0.3, 0.3, 0.9]}
repeats: 3
chunk: 4
solve: {settings: {position_tolerance: 0.01}}
grade: [typical]
"""
INTERRUPTIBLE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job may have inherited "ignore"
from ikde.__main__ import main
main()
"""


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "two.yaml"
    path.write_text(SPEC)
    return path


def far(spec):
    """The same file with a target that is out of reach."""
    spec.write_text(SPEC.replace("[0.3, 0.3, 0.9]", "[9, 9, 9]"))
    return spec


def test_a_run_is_summarised_and_what_is_next_is_said(cli, spec, tmp_path):
    out = tmp_path / "run"
    outcome = cli("batch", spec, "--out", out)
    assert outcome.code == 0
    assert outcome.out.startswith("all reached by qiao2021: 6 solves\n")
    assert outcome.out.endswith(f"wrote {out} (2 parts)\nnext: ikde report {out}\n")
    assert outcome.err == f"two → {out}: 6 solves, 0 of 2 parts done before\n"
    assert len(ikde.read_batch(out)) == 6


@pytest.mark.parametrize("options", [("--dry-run",), ("--out", "run")])
def test_a_robot_without_a_detector_is_told_once(cli, spec, tmp_path, monkeypatch, options):
    monkeypatch.chdir(tmp_path)
    spec.write_text(SPEC.replace("qiao2021", "qiao2021_dh").replace("grade: [typical]", ""))
    outcome = cli("batch", spec, *options)
    assert outcome.code == 0
    assert outcome.err.startswith("ikde: self-collision is not checked: qiao2021_dh has no spheres\n")
    assert outcome.err.count("not checked") == 1


def test_the_same_command_goes_on(cli, spec, tmp_path):
    first = cli("batch", spec, "--out", tmp_path / "run", "--threads", "1")
    second = cli("batch", spec, "--out", tmp_path / "run")
    assert (second.code, second.out) == (0, first.out)
    assert "6 solves, 2 of 2 parts done before" in second.err


def test_a_target_that_is_not_reached_is_named_and_exits_with_1(cli, spec, tmp_path):
    outcome = cli("batch", far(spec), "--out", tmp_path / "run")
    assert outcome.code == 1
    assert outcome.out.startswith("3 of 6 solves not reached by qiao2021\n")
    assert outcome.out.count("  target 1, 3 of 3 repeats, first repeat 0: out of reach: at least") == 1


def test_json_is_the_summary(cli, spec, tmp_path):
    outcome = cli("batch", far(spec), "--out", tmp_path / "run", "--json")
    assert outcome.code == 1
    assert (outcome.data["solves"], outcome.data["unreached"], outcome.data["unreached_targets"]) == (6, 3, 1)
    assert [(row["target"], row["missed"]) for row in outcome.data["listed"]] == [(1, 3)]
    assert outcome.data["arms"][0]["reached"]["count"] == 3
    assert outcome.data["arms"][0]["collisions"]["typical"]["total"] == 3


def test_a_dry_run_writes_nothing(cli, spec, tmp_path, monkeypatch):
    monkeypatch.setattr("ikde.batch.preview.SAMPLE_SECONDS", 0.1)
    out = tmp_path / "run"
    text = cli("batch", spec, "--dry-run")
    data = cli("batch", spec, "--dry-run", "--out", out, "--json").data
    assert (text.code, text.err) == (0, "")
    assert "two: robot qiao2021, 2 targets, 3 repeats" in text.out
    assert "nothing was written" in text.out
    assert (data["solves"], data["parts"]) == (6, 2)
    assert not out.exists()


def test_a_dry_run_tells_compiling_apart(cli, spec, monkeypatch):
    monkeypatch.setattr("ikde.batch.preview.SAMPLE_SECONDS", 0.1)
    data = cli("batch", spec, "--dry-run", "--json").data
    assert data["compile_seconds"] == sum(arm["compile_seconds"] for arm in data["arms"])
    assert data["seconds"] == sum(arm["seconds"] + arm["load_seconds"] for arm in data["arms"])
    again = cli("batch", spec, "--dry-run")
    assert "compiling  nothing: all that the sample needed was compiled already\n" in again.out
    assert "of it to load kernels and seeds" in " ".join(again.out.split())


def test_a_dry_run_refuses_a_folder_as_the_run_would(cli, spec, tmp_path, substitute):
    out = tmp_path / "run"
    cli("batch", spec, "--out", out)
    spec.write_text(SPEC + "seed: 8\n")
    refused = cli("batch", spec, "--out", out)
    substitute(preview_batch, never)
    dry = cli("batch", spec, "--out", out, "--dry-run")
    assert (dry.code, dry.out, dry.err) == (2, "", refused.err)
    assert dry.err.count("\n") == 1
    manifest = out / "manifest.json"
    manifest.write_text(manifest.read_text().replace("ikde batch 3", "ikde batch 1"))
    for options in ((), ("--overwrite",)):
        dry = cli("batch", spec, "--out", out, "--dry-run", *options)
        assert (dry.code, dry.err) == (2, cli("batch", spec, "--out", out, *options).err)
        assert "holds a run of an earlier ikde ('ikde batch 1'" in dry.err


def test_a_dry_run_leaves_the_cluster_alone_and_says_so(cli, spec, monkeypatch):
    monkeypatch.setattr("ikde.batch.preview.SAMPLE_SECONDS", 0.1)
    outcome = cli("batch", spec, "--dry-run", "--dask", "local", "--workers", "2")
    assert (outcome.code, outcome.err) == (
        0,
        "a dry run solves its sample on this machine: the cluster is not used\n",
    )


def test_a_row_alone_is_that_of_the_run(cli, spec, tmp_path):
    out = tmp_path / "run"
    cli("batch", spec, "--out", out)
    rows = ikde.read_batch(out).to_pylist()
    there = next(row for row in rows if (row["target"], row["repeat"]) == (1, 2))
    outcome = cli("batch", spec, "--out", out, "--row", "auto/1/2", "--json")
    assert (outcome.code, outcome.data["row"], outcome.data["same_as_run"]) == (0, "auto/1/2", True)
    assert outcome.data["q"] == {name: there[f"q_{name}"] for name in outcome.data["q"]}
    said = cli("batch", spec, "--out", out, "--row", "auto/1/2")
    assert said.out.startswith("reached by qiao2021")
    assert said.err == f"the same bits as in {out}\n"


def test_a_row_without_a_run_is_compared_with_nothing(cli, spec, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli("batch", spec, "--row", "auto/1", "--json").data["same_as_run"] is None
    assert cli("batch", spec, "--row", "auto/1").err == ""
    assert cli("batch", far(spec), "--row", "auto/1").code == 1
    assert list(tmp_path.iterdir()) == [spec]


def test_a_run_of_another_file_is_replaced_only_if_told_to(cli, spec, tmp_path):
    out = tmp_path / "run"
    cli("batch", spec, "--out", out)
    spec.write_text(SPEC + "seed: 8\n")
    refused = cli("batch", spec, "--out", out)
    assert refused.code == 2
    assert refused.err.startswith(f"ikde: {out}: holds another run (--overwrite replaces it): ")
    assert "there, 8 now" in refused.err
    assert cli("batch", spec, "--out", out, "--overwrite").code == 0
    assert json.loads((out / "manifest.json").read_text())["seed"] == 8


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("", "--out: a run needs a folder"),
        ("--out run --threads 0", "threads: expected a whole number of at least 1"),
        ("--out run --workers 2", "workers: the number of workers"),
        ("--out run --dask nowhere", "dask: expected 'local' or an address"),
        ("--out run --dask local --threads 2", "threads: workers of a cluster use one thread each"),
        ("--dry-run --threads -1", "threads: expected a whole number of at least 1"),
        ("--dry-run --threads 0", "threads: expected a whole number of at least 1"),
        ("--row auto", "row: expected ARM/TARGET/REPEAT"),
        ("--row auto/2", "row: there is no target 2; expected 0 to 1"),
        ("--dry-run --workers 2", "workers: the number of workers"),
        ("--dry-run --dask nowhere", "dask: expected 'local' or an address"),
        ("--dry-run --dask local --threads 2", "threads: workers of a cluster use one thread each"),
    ],
)
def test_what_batch_refuses(cli, spec, tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    outcome = cli("batch", spec, *options.split())
    assert (outcome.code, outcome.out) == (2, "")
    assert words in outcome.err


def test_a_file_that_is_not_there_is_refused(refuse):
    assert "nowhere.yaml" in refuse("batch", "nowhere.yaml", "--out", "run")


def test_ctrl_c_says_how_to_go_on(spec, tmp_path):
    spec.write_text(SPEC.replace("repeats: 3", "repeats: 100000"))
    out = tmp_path / "run"
    command = [sys.executable, "-W", "error", "-c", INTERRUPTIBLE, "batch", str(spec), "--out", str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        while not list(out.glob("solutions/*.parquet")):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        printed, said = process.communicate(timeout=60)
    line = "ikde: interrupted; finished parts are intact; run the same command again to resume"
    assert (process.returncode, printed, said.splitlines()[1:]) == (130, "", [line])
    assert len(ikde.read_batch(out)) >= 4
