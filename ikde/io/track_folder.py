"""Where a followed track goes: its motion, its figures as numbers and as a page; all of it or nothing."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ikde.errors import FileError
from ikde.files.atomic import sync_folder, write_together
from ikde.io.trajectory_files import format_trajectory
from ikde.track.trajectory import Trajectory

SUMMARY, PAGE = "summary.json", "report.html"
MOTION = (
    *("trajectory.csv", "trajectory.parquet", "joint_trajectory.yaml", "joint_trajectory.json"),
    *("base.yaml", "base.json"),
)


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
    paths = {folder / name: data for name, data in files.items()}
    try:
        write_together(paths)
        for name in {PAGE, SUMMARY, *MOTION} - set(files):
            (folder / name).unlink(missing_ok=True)
        sync_folder(folder)
    except OSError as error:
        raise FileError(error.filename or folder, f"cannot be written: {error.strerror or error}") from None
    return tuple(paths)
