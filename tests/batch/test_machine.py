"""What a run was made on."""

import json
import os
import platform

import ikde
from ikde.batch.machine import describe_machine, describe_versions


def test_versions_name_what_has_a_hand_in_the_answers():
    versions = describe_versions()
    assert (versions["ikde"], versions["python"]) == (ikde.__version__, platform.python_version())
    assert {"numpy", "numba", "pyarrow"} < set(versions)


def test_the_machine_is_plain_data():
    facts = json.loads(json.dumps(describe_machine()))
    assert facts["cores"] == os.cpu_count()
    assert facts["processor"]
    assert isinstance(facts["cpu_flags"], list)
