"""Where a followed track goes: its motion, its figures as numbers and as a page; all of it or nothing."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ikde.files.atomic import replace_all
from ikde.io.trajectory_files import MOTION, format_trajectory
from ikde.track.trajectory import Trajectory

SUMMARY, PAGE = "summary.json", "report.html"


def write_track(
    folder: Path, trajectory: Trajectory, summary: Mapping[str, Any], page: str | None = None
) -> tuple[Path, ...]:
    """Write what came of a track; what an earlier one left under these names is replaced or removed.

    Args:
        folder: where to; it is there.
        trajectory: the motion; without a sample it has no files.
        summary: plain data.
        page: the page's text; None for no page.

    Returns:
        The files, the page first.

    Raises:
        FileError: if they cannot be written; then none of them is new, or only those that were named before.
    """
    files: dict[str, bytes] = {} if page is None else {PAGE: page.encode()}
    files[SUMMARY] = (json.dumps(summary, indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode()
    if len(trajectory.q):
        files |= format_trajectory(trajectory)
    return replace_all(folder, files, (PAGE, SUMMARY, *MOTION))
