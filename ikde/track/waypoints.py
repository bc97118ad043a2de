"""Waypoints of a track file, written there or in a table: poses, and the shortest rotations between them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ikde.errors import FileError, InputError
from ikde.formats.entries import FileEntry, InlineTarget, UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.formats.poses import read_orientation, read_position
from ikde.formats.table_targets import read_targets
from ikde.formats.tables import row_error
from ikde.kernels.arrays import Floats
from ikde.model.target import AXIS, POSITION, Target, Targets
from ikde.track.orientations import Orientations
from ikde.track.slerp import PathOrientation, slerp

ASKED = {"position": "a position", "axis": "an axis", "pose": "a pose"}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Waypoints:
    """Two poses or more, of one kind."""

    targets: Targets
    blame: Callable[[int, str], InputError]
    """What is wrong with the waypoint of this index, as an error in its place."""

    @property
    def have_orientations(self) -> bool:
        """Whether they ask for orientations."""
        return self.targets.kind[0] != POSITION

    def orient(self, at: Floats) -> Orientations:
        """Orientations at places `at` [S], 0 at the first waypoint, 1 at the next; raises `InputError` where it is."""
        orientation: PathOrientation = "axis" if self.targets.kind[0] == AXIS else "pose"
        try:
            return orientation, slerp(orientation, self.targets.R_world_tool, at)
        except InputError as error:
            raise self.blame(int(error.where[0]), error.message) from None


def read_waypoints(entry: FileEntry | Sequence[InlineTarget], units: UnitsEntry, folder: Path) -> Waypoints:
    """Waypoints from a table or a list.

    Raises:
        InputError: with a path inside `entry`; later, of orientations, with a path inside `path` of the track file.
        FileError: for what is wrong inside a table, with its row.
    """
    if isinstance(entry, FileEntry):
        return _read_table(folder / entry.path, entry, units)
    targets = []
    for index, waypoint in enumerate(entry):
        with prefix_errors(index):
            position = read_position("position", waypoint.position, units)
            targets.append(Target(position, **read_orientation(waypoint, units)))
            if targets[-1].kind != targets[0].kind:
                last, first = ASKED[targets[-1].kind], ASKED[targets[0].kind]
                raise InputError(f"this waypoint asks for {last}, the first one for {first}")
    return Waypoints(targets=Targets.of(targets), blame=lambda index, text: InputError(text, ("waypoints", index)))


def _read_table(path: Path, entry: FileEntry, units: UnitsEntry) -> Waypoints:
    table = read_targets(path, entry.columns, entry.units or units)
    if table.count < 2:
        raise FileError(path, "expected 2 rows or more, got 1")
    return Waypoints(targets=table.read(0, table.count), blame=lambda row, text: row_error(path, row, text))
