"""A motion as files: tables, and the messages that ROS controllers take; whole files or none."""

import json
from collections.abc import Callable, Mapping, Sequence
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq
import yaml

from ikde.errors import InputError
from ikde.formats.atomic import replace_all
from ikde.io.report_folder import prepare_folder
from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD
from ikde.track.trajectory import Trajectory

Format = Literal["csv", "parquet", "yaml", "json"]
FORMATS: tuple[Format, ...] = get_args(Format)
NANO = 10**9
MOTION = (
    *("trajectory.csv", "trajectory.parquet", "joint_trajectory.yaml", "joint_trajectory.json"),
    *("base.yaml", "base.json"),
)
"""All that a motion can leave in a folder."""
SUMMARY, PAGE = "summary.json", "report.html"  # of a followed track


def write_trajectory(
    folder: str | PathLike[str],
    trajectory: Trajectory,
    formats: Sequence[Format] = FORMATS,
    *,
    velocities: bool = True,
) -> tuple[Path, ...]:
    """Write a motion into a folder; what an earlier one left there in these formats is replaced or removed.

    `csv` and `parquet`: `trajectory.<format>`, a row a sample. `yaml` and `json`: `joint_trajectory.<format>`, the arm
    as a ROS message, and `base.<format>`, the base's twist and its wheels' speeds at the same times.

    Args:
        folder: where to; made if need be.
        trajectory: the motion.
        formats: which files.
        velocities: as for `joint_trajectory`.

    Returns:
        The files.

    Raises:
        InputError: for an unknown format, or a motion without samples.
        FileError: if they cannot be written; then none of them is new, or only those that were named before.
    """
    files = format_trajectory(trajectory, formats, velocities=velocities)
    prepare_folder(Path(folder))
    return replace_all(Path(folder), files, [name for name in MOTION if name.rpartition(".")[2] in formats])


def write_track(
    folder: Path, trajectory: Trajectory, summary: Mapping[str, Any], page: str | None = None
) -> tuple[Path, ...]:
    """Write what came of a track into a folder that is there; returns the files, the page first.

    What an earlier track left under these names is replaced or removed. A motion without a sample has no files.

    Raises:
        FileError: if they cannot be written; then none of them is new, or only those that were named before.
    """
    files: dict[str, bytes] = {} if page is None else {PAGE: page.encode()}
    files[SUMMARY] = (json.dumps(summary, indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode()
    if len(trajectory.q):
        files |= format_trajectory(trajectory)
    return replace_all(folder, files, (PAGE, SUMMARY, *MOTION))


def format_trajectory(
    trajectory: Trajectory, formats: Sequence[Format] = FORMATS, *, velocities: bool = True
) -> dict[str, bytes]:
    """Name -> content of a motion's files, in the order in which they get their names; as for `write_trajectory`."""
    for name in formats or ("none",):
        if name not in FORMATS:
            raise InputError(f"expected one of {', '.join(FORMATS)}, got {name!r}", ("formats",))
    table, files = trajectory_table(trajectory), {}
    for name in formats:
        if name in WRITE_TABLE:
            files[f"trajectory.{name}"] = WRITE_TABLE[name](table)
            continue
        if trajectory.base_joints:
            files[f"base.{name}"] = WRITE_PLAIN[name](base_motion(trajectory))
        files[f"joint_trajectory.{name}"] = WRITE_PLAIN[name](joint_trajectory(trajectory, velocities=velocities))
    return files


def trajectory_table(trajectory: Trajectory) -> pa.Table:
    """A row a sample: time, joint values and speeds, the base's twist and wheels, path, errors and clearance.

    Speeds of row k hold from sample k to k + 1 and are 0 in the last row. SI units; columns that the motion has no
    numbers for are left out.
    """
    if not len(trajectory.q):
        raise InputError("this motion has no samples: not even its start was reached")
    names, path = trajectory.joint_names, trajectory.path
    columns: dict[str, Any] = {"sample": np.arange(len(trajectory.q)), "t_s": trajectory.times_s}
    columns |= {f"q_{name}": trajectory.q[:, index] for index, name in enumerate(names)}
    speeds = _until_next(trajectory.joint_speeds)
    columns |= {f"speed_{name}": speeds[:, index] for index, name in enumerate(names)}
    columns |= _twist(trajectory)
    columns |= {f"path_{axis}_m": path.p_world_tool[: len(trajectory.q), k] for k, axis in enumerate("xyz")}
    columns |= {f"error_{axis}_m": trajectory.error_m[:, k] for k, axis in enumerate("xyz")}
    if path.orientation != "free":
        columns["orientation_error_rad"] = trajectory.orientation_error_rad
    if trajectory.clearance_m is not None:
        columns["clearance_m"] = trajectory.clearance_m
    return pa.table({name: np.ascontiguousarray(column) for name, column in columns.items()})


def joint_trajectory(trajectory: Trajectory, *, velocities: bool = True) -> dict[str, Any]:
    """The arm's motion as a `trajectory_msgs/JointTrajectory`, plain data.

    With velocities ROS's joint_trajectory_controller runs a cubic through the points: each is the mean of the steps
    before and after the point, that of the first one is its step's, and the last one is 0. Without them it
    interpolates linearly, as a `Trajectory` does. Accelerations are unknown: those of linear steps are jumps. The frame
    is the one in which `base_motion` has the base.
    """
    arm = [index for index, name in enumerate(trajectory.joint_names) if name not in trajectory.base_joints]
    speeds = _at_samples(trajectory.joint_speeds)
    points = [
        {
            "positions": q.tolist(),
            "velocities": speed.tolist() if velocities else [],
            "accelerations": [],
            "effort": [],
            "time_from_start": _duration(k, trajectory.path.dt_s),
        }
        for k, (q, speed) in enumerate(zip(trajectory.q[:, arm], speeds[:, arm], strict=True))
    ]
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": WORLD}
    return {"header": header, "joint_names": [trajectory.joint_names[index] for index in arm], "points": points}


def base_motion(trajectory: Trajectory) -> dict[str, Any]:
    """The base's motion beside a `joint_trajectory`: columns of equal length, SI units; row k holds until row k + 1."""
    place = [trajectory.joint_names.index(name) for name in trajectory.base_joints]
    columns = {"t_s": trajectory.times_s}
    columns |= dict(zip(("x_m", "y_m", "heading_rad"), trajectory.q[:, place].T, strict=True))
    columns |= _twist(trajectory)
    return {"drive": trajectory.drive, **{name: column.tolist() for name, column in columns.items()}}


def _twist(trajectory: Trajectory) -> dict[str, Floats]:
    """The base's speeds by name, [M + 1] each; nothing for a robot that stands still."""
    if not trajectory.base_joints:
        return {}
    v, omega = _until_next(trajectory.v), _until_next(trajectory.omega)
    if v.ndim == 2:
        return {"world_v_x_m_s": v[:, 0], "world_v_y_m_s": v[:, 1], "omega_rad_s": omega}
    columns = {"v_m_s": v, "omega_rad_s": omega}
    if trajectory.wheel_speeds is not None:
        wheels = _until_next(trajectory.wheel_speeds)
        columns |= {"wheel_left_rad_s": wheels[:, 0], "wheel_right_rad_s": wheels[:, 1]}
    return columns


def _until_next(speeds: Floats) -> Floats:
    """Speeds of the M steps as rows of M + 1 samples: after the last one the robot stands."""
    return np.concatenate([speeds, np.zeros_like(speeds[:1], shape=(1, *speeds.shape[1:]))])


def _at_samples(speeds: Floats) -> Floats:
    """Speeds at the M + 1 samples, from those of the M steps between them."""
    rows = _until_next(speeds)
    rows[1:-1] = 0.5 * (speeds[:-1] + speeds[1:])
    return rows


def _duration(k: int, dt_s: float) -> dict[str, int]:
    """K dt as ROS writes times."""
    sec, nanosec = divmod(round(k * dt_s * NANO), NANO)
    return {"sec": sec, "nanosec": nanosec}


def _csv(table: pa.Table) -> bytes:
    buffer = BytesIO()
    pa_csv.write_csv(table, buffer, pa_csv.WriteOptions(quoting_style="none"))
    return buffer.getvalue()


def _parquet(table: pa.Table) -> bytes:
    buffer = BytesIO()
    pq.write_table(table, buffer)
    return buffer.getvalue()


def _yaml(data: Mapping[str, Any]) -> bytes:
    dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    return yaml.dump(data, Dumper=dumper, sort_keys=False, default_flow_style=None, width=2**20).encode()


def _json(data: Mapping[str, Any]) -> bytes:
    return (json.dumps(data, allow_nan=False) + "\n").encode()


WRITE_TABLE: dict[str, Callable[[pa.Table], bytes]] = {"csv": _csv, "parquet": _parquet}
WRITE_PLAIN: dict[str, Callable[[Mapping[str, Any]], bytes]] = {"yaml": _yaml, "json": _json}
