"""A fixed sample of the mutated files of `benchmarks/fuzz_files.py`: each is an answer or one line."""

import importlib
from collections import Counter
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parent.parent / "benchmarks"
SEED, FILES = 2, 250


@pytest.fixture(scope="module")
def fuzzer(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        module = importlib.import_module("fuzz_files")
        yield module, module.Fuzzer(tmp_path_factory.mktemp("fuzz"))


def test_a_mutated_file_is_an_answer_or_one_line(fuzzer):
    module, files = fuzzer
    outcomes = Counter()
    for number in range(FILES):
        kind, data = files.make(SEED, number)
        outcome = module.judge(lambda kind=kind, data=data, draw=number < 16: files.read(kind, data, draw=draw))
        assert outcome in ("answer", "one line"), f"file {number}, {kind}: {outcome}"
        outcomes[kind, outcome] += 1
    assert {kind for kind, _ in outcomes} == set(module.KINDS)
    answered = {kind for kind, outcome in outcomes if outcome == "answer"}
    assert len(answered) > 8, "mutations that no reader lets in look at no reader's inside"


def test_the_same_number_is_the_same_file(fuzzer):
    module, files = fuzzer
    numbers = range(100)
    forwards = [files.make(SEED, number) for number in numbers]
    assert forwards == [files.make(SEED, number) for number in reversed(numbers)][::-1]
    assert [files.make(SEED, number)[0] for number in range(16)] == list(module.KINDS)


def test_what_is_not_mutated_is_answered(fuzzer):
    module, files = fuzzer
    for kind, data in (
        ("targets, CSV", files.csv.encode()),
        ("targets, Parquet", files.parquet),
        ("run folder, manifest", files.kept[files.run / "manifest.json"]),
        *(("robot, YAML", text.encode()) for text in files.robots),
        *(("run, YAML", text.encode()) for text in files.runs),
        *(("track, YAML", text.encode()) for text in files.tracks),
        *(("world, YAML", text.encode()) for text in files.worlds),
        *(("world, JSON", text.encode()) for text in files.scenes),
        ("cloud, PLY", files.ply.encode()),
        ("cloud, PCD", files.pcd.encode()),
    ):
        assert module.judge(lambda kind=kind, data=data: files.read(kind, data)) == "answer"


def test_an_escape_is_not_taken_for_an_answer(fuzzer):
    module, _ = fuzzer

    def escape():
        raise EOFError("end")

    assert module.judge(escape) == "EOFError: 'end'"
