"""What ikde's own world files say, as obstacles: units, frames, parts, and the files that they name."""

from typing import Any

import numpy as np

from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry, only_key
from ikde.formats.error_path import prefix_errors
from ikde.formats.units import LENGTHS_M
from ikde.formats.world_entries import (
    SOLIDS,
    AttachedEntry,
    CloudEntry,
    ColumnsEntry,
    FramePlaceEntry,
    MeshEntry,
    ObstacleEntry,
    PlaceEntry,
    SolidEntry,
    WorldFile,
)
from ikde.io.cloud_file import read_cloud
from ikde.io.mesh_solids import find_unit, read_mesh_hulls
from ikde.io.scene_values import Frames, Reading, compose, rotation_from_unit_quat
from ikde.kernels.arrays import Floats
from ikde.model.pack import pack_floats
from ikde.model.robot import WORLD
from ikde.model.rotation import check_rotation, length, measure_skew, rotation_from_rpy, rotation_with_z
from ikde.model.solids import IDENTITY, MAX_CLOUD_POINTS, SIZES, Solid, make_columns, make_solid, read_pose
from ikde.model.world import MAX_SOLIDS, Attached, Obstacle, World, make_obstacle, make_world
from ikde.solver.attach import FINEST_M, read_protrusion, read_spheres
from ikde.solver.cover_solid import cover_solids, refuse_endless

ORIENTATIONS = ("rpy", "quat_wxyz", "rotation")
EXACT = 1e-14  # how far a rotation may be off by rounding alone
MAX_HULLS = 5_000  # of a file: each takes a millisecond and more


def make_file_world(file: WorldFile, reading: Reading) -> World:
    """The world of a file, SI inside; raises `InputError` with the key that is wrong."""
    frames = Frames()
    for name, entry in file.frames.items():
        with prefix_errors("frames", name):
            if name == WORLD:
                raise InputError("this name is that of what all frames are placed in; expected another one")
            frames.add(name, entry.frame, _to_pose(entry, file.units))
    for name in file.frames:
        with prefix_errors("frames", name, "frame"):
            frames.resolve(name)
    obstacles, solids, hulls = [], 0, 0
    for name, entry in file.obstacles.items():
        with prefix_errors("obstacles", name):
            obstacles.append(_to_obstacle(name, entry, file.units, frames, reading))
            solids += len(obstacles[-1].solids)
            hulls += sum(solid.kind == "hull" for solid in obstacles[-1].solids)
            if solids > MAX_SOLIDS or hulls > MAX_HULLS:
                raise InputError(f"expected at most {MAX_SOLIDS:,} solids in all, of them {MAX_HULLS:,} hulls")
    attached = []
    for name, entry in file.attached.items():
        with prefix_errors("attached", name):
            attached.append(_to_attached(name, entry, file.units, frames, reading))
    return make_world(obstacles, file.switched_off, attached)


def _to_attached(name: str, entry: AttachedEntry, units: UnitsEntry, frames: Frames, reading: Reading) -> Attached:
    solids = _list_solids(entry, units, reading)
    for part in (entry, *(entry.parts or ())):
        if part.columns is not None:
            raise InputError("a height field cannot be attached", ("columns",))
    refuse_endless(solids)
    stood = entry.picked_from or FramePlaceEntry()
    with prefix_errors("picked_from"):
        stands_in, T_frame_given = frames.resolve(stood.frame)
        T_stood = compose(T_frame_given, _to_pose(stood, units))
    known = {"margin_m": entry.margin * units.length_m, "ignore": entry.ignore, "group": entry.group}
    obstacle = make_obstacle(name, solids, T_stood, frame=stands_in, **known)
    frame, T_frame_given = frames.resolve(entry.frame)
    out_m = None
    if entry.protrusion is not None:
        least_m = FINEST_M if entry.spheres is None else 0.0
        out_m = read_protrusion(entry.protrusion * units.length_m, ("protrusion",), least_m)
    if entry.spheres is None:
        try:
            spheres, out_m = cover_solids(solids, out_m)
        except InputError as error:
            raise InputError(error.message, ("protrusion",) if out_m is not None else error.where) from None
    else:
        spheres = read_spheres(np.array(entry.spheres) * units.length_m)
    return Attached(
        obstacle=obstacle,
        frame=frame,
        T_frame_object=read_pose(compose(T_frame_given, _to_pose(entry, units)), ("position",)),
        spheres=pack_floats(spheres),
        protrusion_m=out_m,
        may_touch=tuple(dict.fromkeys((*entry.may_touch, *entry.ignore))),
    )


def _list_solids(entry: ObstacleEntry | AttachedEntry, units: UnitsEntry, reading: Reading) -> list[Solid]:
    """At least one."""
    key = only_key(entry, (*SOLIDS, "parts"))
    solids: list[Solid] = []
    if key != "parts":
        solids = _to_solids(entry, IDENTITY, units, reading)
    for place, part in enumerate(entry.parts or ()):
        with prefix_errors("parts", place):
            solids += _to_solids(part, _to_pose(part, units), units, reading)
    if not solids:
        raise InputError("this obstacle has no solid", (key,))
    return solids


def _to_obstacle(name: str, entry: ObstacleEntry, units: UnitsEntry, frames: Frames, reading: Reading) -> Obstacle:
    solids = _list_solids(entry, units, reading)
    frame, T_frame_given = frames.resolve(entry.frame)
    known = {"frame": frame, "margin_m": entry.margin * units.length_m, "ignore": entry.ignore, "group": entry.group}
    return make_obstacle(name, solids, compose(T_frame_given, _to_pose(entry, units)), **known)


def _to_pose(entry: PlaceEntry, units: UnitsEntry) -> Floats:
    """[3, 4] in m."""
    T = IDENTITY.copy()
    T[:, 3] = np.array(entry.position) * units.length_m
    given = [key for key in ORIENTATIONS if getattr(entry, key) is not None]
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} both give an orientation; give one", (given[1],))
    if entry.rpy is not None:
        T[:, :3] = rotation_from_rpy(np.array(entry.rpy) * units.angle_rad)
    if entry.quat_wxyz is not None:
        with prefix_errors("quat_wxyz"):
            T[:, :3] = rotation_from_unit_quat(np.array(entry.quat_wxyz))
    if entry.rotation is not None:
        with prefix_errors("rotation"):
            T[:, :3] = _clean_rotation(np.array(entry.rotation))
    return T


def _clean_rotation(R: Floats) -> Floats:
    """A matrix that is a rotation to rounding as it is; one that was rounded to fewer digits, as the nearest one."""
    check_rotation(R)
    if measure_skew(R) <= EXACT:
        return R
    U, _, Vt = np.linalg.svd(R)
    return U @ Vt


def _to_solids(entry: SolidEntry, T: Floats, units: UnitsEntry, reading: Reading) -> list[Solid]:
    key, unit = only_key(entry, SOLIDS), units.length_m
    with prefix_errors(key):
        value: Any = getattr(entry, key)
        if key == "mesh":
            return _read_mesh(value, T, unit, reading)
        if key == "columns":
            return _make_columns(value, T, unit)
        sizes, points = _list_sizes(key, value), None
        if key == "half_space":
            T = compose(T, _upright(np.array(value.normal)))
        elif key == "hull":
            points = np.array(value.points).reshape(-1, 3) * unit
        elif key == "cloud":
            points = _read_points(value, unit, reading)
        return [make_solid(key, np.array(sizes) * unit, T, points)]  # type: ignore[arg-type]


def _list_sizes(key: str, value: Any) -> list[float]:
    """In the file's unit."""
    return value if key == "box" else [getattr(value, size) for size in SIZES.get(key, ())]  # type: ignore[call-overload]


def _read_mesh(entry: MeshEntry, T: Floats, unit: float, reading: Reading) -> list[Solid]:
    if entry.length is not None:
        unit = LENGTHS_M[entry.length]
    if find_unit(entry.path):
        unit = 1.0
    with prefix_errors("path"):
        return read_mesh_hulls(entry.path, np.array(entry.scale) * unit, T, reading)


def _read_points(entry: CloudEntry, unit: float, reading: Reading) -> Floats:
    """[K, 3] m, finite."""
    if only_key(entry, ("path", "points")) == "points":
        points = np.array(entry.points).reshape(-1, 3) * unit
    else:
        assert entry.path is not None
        with prefix_errors("path"):
            points = read_cloud(reading.folder, entry.path, entry.array)
        points = points * (LENGTHS_M[entry.length] if entry.length else unit)
    reading.cloud_points += len(points)
    if reading.cloud_points > MAX_CLOUD_POINTS:
        raise InputError(f"expected at most {MAX_CLOUD_POINTS:,} points in all clouds together")
    good = np.isfinite(points).all(axis=1)
    if good.all():
        return points
    if not entry.drop_invalid or not good.any():
        count, first = len(points) - int(good.sum()), int(np.argmin(good)) + 1
        hint = "; `drop_invalid: true` leaves them out" if good.any() else ""
        raise InputError(f"{count:,} of {len(points):,} points are not finite, the first is number {first:,}{hint}")
    reading.note(f"{len(points) - int(good.sum()):,} of {len(points):,} points are not finite and left out")
    return points[good]


def _make_columns(entry: ColumnsEntry, T: Floats, unit: float) -> list[Solid]:
    if len({len(row) for row in entry.heights}) > 1:
        raise InputError("expected rows of one length", ("heights",))
    solids = make_columns(np.array(entry.heights) * unit, entry.cell * unit, entry.base * unit)
    return [make_solid(s.kind, s.size_m, compose(T, s.T_obstacle_solid)) for s in solids]


def _upright(normal: Floats) -> Floats:
    """The pose [3, 4] whose z axis is this direction."""
    size = float(length(normal))
    if not size > 1e-9:
        raise InputError("expected a direction, not a zero vector", ("normal",))
    T = np.eye(4)[:3]
    T[:, :3] = rotation_with_z(normal / size)
    return T
