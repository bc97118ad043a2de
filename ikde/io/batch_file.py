"""The run file: how it becomes a `Batch`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ikde.batch.plan import Batch
from ikde.batch.resolve import make_batch
from ikde.batch.spec import BatchSpec
from ikde.io.plan_file import load_plan


def load_batch(source: str | Path | Mapping[str, Any]) -> Batch:
    """Load a run and check all of it, before anything runs.

    Args:
        source: the path of a YAML file, or the same keys as a mapping; paths inside start at the file's folder, or
            at the current one.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key, and for what is neither path nor mapping.
    """
    return load_plan(source, "run", BatchSpec, make_batch)
