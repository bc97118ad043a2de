"""Spheres of links exchanged in a robot that there is already; what follows from that is found anew."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path

import numpy as np

from ikde.errors import FileError, InputError, nearest, quoted
from ikde.formats.reading import read_text
from ikde.io.urdf_import.chain import find_tree
from ikde.io.urdf_import.choose_pairs import SPHERES, leave_out_touching
from ikde.io.urdf_import.cover_links import LinkSpheres, cover_link, describe_shapes, find_shapes
from ikde.io.urdf_import.description import Description, read_description
from ikde.io.urdf_import.imported import CoveredLink
from ikde.io.urdf_import.options import ImportOptions
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import NO_DETECTOR, WORLD, Detector, FreeSpheres, Robot, Spheres
from ikde.model.validate import NON_ADJACENT, check_robot
from ikde.solver.plain import compute_gaps
from ikde.spheres.measure import measure_spheres
from ikde.spheres.shapes import Shape
from ikde.spheres.triangles import shape_triangles

ALWAYS = "always touching: "  # how reasons begin that are found anew


def list_link_spheres(robot: Robot) -> dict[str, Floats]:
    """The spheres [S, 4] of each link: x, y, z, radius in m, in its frame.

    Of the default detector, or of the only approximation; of components that are called as the frame that they stand
    in, as those of an import are.
    """
    found: dict[str, list[tuple[float, float, float, float]]] = {}
    for row in robot.approximations.get(_choose_approximation(robot), ()):
        if isinstance(row, FreeSpheres) and row.component == row.frame:
            found.setdefault(row.frame, []).extend(row.spheres)
    return {link: np.array(balls) for link, balls in found.items()}


def exchange_spheres(robot: Robot, own: Mapping[str, LinkSpheres]) -> tuple[Robot, list[str]]:
    """The robot, checked, with other spheres on some links, and what is worth a warning.

    Pairs of these links that were left out because they always touch are compared again, unless they still do; a home
    that collides now stays, and that is a warning.

    Args:
        robot: as its file has it.
        own: spheres by frame.

    Raises:
        InputError: for a frame that there is not, a component that stands in another frame, or too few pairs.
    """
    frames = [WORLD, *(frame.name for frame in robot.frames)]
    for link in own:
        if link not in frames:
            raise InputError(f"no frame of the robot is called {quoted(link)}{nearest(link, frames)}", ("link",))
    name = _choose_approximation(robot)
    rows = _exchange_rows(robot.approximations.get(name, ()), own)
    again = [p for p in robot.adjacent if p.reason.startswith(ALWAYS) and {p.a, p.b} & set(own)]
    adjacent = tuple(p for p in robot.adjacent if p not in again)
    lists = {key: pairs for key, pairs in robot.pair_lists.items() if key != NON_ADJACENT}
    approximations = {**robot.approximations, name: rows}
    draft = replace(robot, approximations=approximations, adjacent=adjacent, pair_lists=lists)
    detector = robot.detectors.get(robot.default_detector) or Detector(name=name, spheres=name, pairs=NON_ADJACENT)
    if detector.pairs == NON_ADJACENT:
        others = {key: other for key, other in robot.detectors.items() if key != detector.name}
        base = replace(draft, detectors=others, default_detector=next(iter(others), NO_DETECTOR))
        known = set(map(frozenset, check_robot(base).pair_lists[NON_ADJACENT]))
        joined = tuple((p.a, p.b) for p in again if frozenset((p.a, p.b)) not in known)
        chosen = leave_out_touching(replace(base, compared=base.compared + joined), detector)
        changed, notes = chosen.robot, chosen.warnings
    else:
        changed, notes = check_robot(draft), ()
    return changed, [*notes, *_check_home(changed)]


def _choose_approximation(robot: Robot) -> str:
    detector = robot.detectors.get(robot.default_detector)
    if detector is not None:
        return detector.spheres
    return next(iter(robot.approximations), SPHERES)


def _exchange_rows(rows: tuple[Spheres, ...], own: Mapping[str, LinkSpheres]) -> tuple[Spheres, ...]:
    """All rows, those of a link where its first one was."""
    kept: dict[str | int, Spheres] = {}
    for index, row in enumerate(rows):
        if row.component not in own:
            kept[index] = row
        elif not isinstance(row, FreeSpheres) or row.frame != row.component:
            message = f"the spheres of {row.component!r} do not stand in the frame of its name; edit them in the file"
            raise InputError(message, ("link",))
        else:
            kept.setdefault(row.component, row)
    for link, spheres in own.items():
        table = np.column_stack([spheres.centres, spheres.radii]).tolist()
        kept[link] = FreeSpheres(component=link, frame=link, spheres=tuple((x, y, z, r) for x, y, z, r in table))
    return tuple(kept.values())


def _check_home(robot: Robot) -> list[str]:
    if robot.default_detector == NO_DETECTOR:
        return []
    model = CollisionModel.of(robot)
    is_free = compute_gaps(model, robot.home[None]).min() > model.limit_m
    return [] if is_free else ["home collides with these spheres"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UrdfShapes:
    """The collision shapes of a URDF's links, with all meshes found."""

    description: Description
    shapes: dict[str, list[Shape]]

    @staticmethod
    def read(path: Path, options: ImportOptions) -> "UrdfShapes":
        """Read a URDF for its shapes alone; raises `FileError` as an import does."""
        description = read_description(path)
        return UrdfShapes(description=description, shapes=find_shapes(description, find_tree(description), options))

    def cover(self, link: str, protrusion_m: float) -> LinkSpheres:
        """Spheres of one link; raises `FileError` for a link that there is not, with the nearest, or without shapes."""
        path = self.description.path
        if link not in self.shapes:
            raise FileError(path, f"no link is called {quoted(link)}{nearest(link, self.shapes)}", ("link",))
        if not self.shapes[link]:
            raise FileError(path, f"the link {quoted(link)} has no collision shapes to cover", ("link",))
        return cover_link(self.description, link, self.shapes[link], protrusion_m)

    def list_triangles(self, link: str) -> Floats:
        """Those of a link's shapes [T, 3, 3] in m, in its frame; round ones with flat facets."""
        own = [shape_triangles(shape) for shape in self.shapes.get(link, [])]
        return np.concatenate(own) if own else np.empty((0, 3, 3))

    def describe(self, link: str, spheres: Floats, made: CoveredLink | None = None) -> CoveredLink:
        """What is proved of spheres [S, 4] that others made, `made` as they say or as in the robot's file.

        Raises `FileError` for a mesh that cannot be read.
        """
        own = self.shapes.get(link, [])
        how = made.how if made else "as in the robot's file"
        measured = measure_spheres(own, spheres[:, :3], spheres[:, 3])
        return CoveredLink(
            link=link,
            shapes=describe_shapes(own) or "none",
            spheres=len(spheres),
            covered=measured.covered,
            protrusion_m=measured.protrusion_m,
            how=f"{how}, compared with hulls of the parts" if measured.of_hulls else how,
        )


def read_comments(path: Path) -> list[str]:
    """The comment lines on top of a robot's file, to be written again."""
    lines = read_text(path).splitlines()
    return [line[1:].strip() for line in takewhile(lambda line: line.startswith("#"), lines)]
