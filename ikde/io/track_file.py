"""The track file: how it becomes a `TrackPlan`."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ikde.io.plan_file import load_plan
from ikde.track.make_plan import make_plan
from ikde.track.plan import TrackPlan
from ikde.track.spec import TrackSpec


def load_track(source: str | Path | Mapping[str, Any]) -> TrackPlan:
    """Load a track and check all of it, before anything moves.

    Args:
        source: the path of a YAML file, or the same keys as a mapping; paths inside start at the file's folder, or
            at the current one.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key, and for what is neither path nor mapping.
    """
    return load_plan(source, "track", TrackSpec, make_plan)
