"""What a run was made on."""

import json
import os
import platform
from pathlib import Path

import pytest

import ikde
from ikde.batch.machine import describe_machine, describe_versions

CPUINFO = Path("/proc/cpuinfo")


def test_versions_name_what_has_a_hand_in_the_answers():
    versions = describe_versions()
    assert (versions["ikde"], versions["python"]) == (ikde.__version__, platform.python_version())
    assert {"numpy", "numba", "pyarrow"} < set(versions)


def test_the_machine_is_plain_data():
    facts = json.loads(json.dumps(describe_machine()))
    assert facts["cores"] == os.cpu_count()
    assert facts["processor"]


@pytest.mark.skipif(not CPUINFO.exists(), reason="Linux tells what its processors can do")
def test_what_the_processor_can_do_is_listed():
    flags = describe_machine()["cpu_flags"]
    assert len(flags) > 5
    assert set(flags) <= set(CPUINFO.read_text(encoding="utf-8").split())
