"""Write the robot files of `ikde/robots` that come from public URDFs: frames, limits, spheres and pairs, no meshes.

    python -m benchmarks.import_robots [NAME ...]      (pip install 'ikde[meshes]' example-robot-data)

A robot is not listed where spheres of 20 mm call most of what it can do a collision, as 9 in 10 poses of the UR10.

Then `python benchmarks/ship_robots.py`, `python benchmarks/ship_proofs.py` and `python -m benchmarks.ship_pools`.
The licence of each description is looked for in the file that states it, and named in the robot's file.
"""

import sys
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from ikde.io.robot_writer import write_robot
from ikde.io.robots import FOLDER, parse_file
from ikde.io.urdf_import.imported import ImportedUrdf
from ikde.io.urdf_import.installed import find_installed
from ikde.io.urdf_import.options import Base, ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import FreeSpheres, Provenance, Robot
from ikde.solver.plain import compute_gaps

PACKAGE = "example-robot-data"
GRID_M = 1e-6  # of what is written of spheres; they grow by as much as that may take away


@dataclass(frozen=True, kw_only=True)
class Source:
    """A robot of the package, and what its file does not say."""

    name: str
    title: str
    urdf: str
    """The file's name, without its ending."""
    tool: str
    licence: str
    """As it stands in `licence_file`."""
    licence_file: str = "README.md"
    """From the folder of the description."""
    srdf: str | None = None
    base: Base = "urdf"
    protrusion_m: float = 0.02


SOURCES = (
    Source(
        name="kinova_j2s6s200",
        title="Kinova Jaco 2, 6 joints, 2 fingers",
        urdf="kinova",
        tool="j2s6s200_end_effector",
        licence="BSD",
        srdf="srdf/kinova.srdf",
    ),
    Source(
        name="panda_hand",
        title="Franka Emika Panda with its hand",
        urdf="panda",
        tool="panda_hand_tcp",
        licence="Apache-2.0",
        srdf="srdf/panda.srdf",
    ),
    Source(
        name="xarm7",
        title="UFACTORY xArm7",
        urdf="xarm7",
        tool="link_eef",
        licence="BSD-3-Clause",
        srdf="srdf/xarm7.srdf",
    ),
)


def import_source(source: Source) -> tuple[Robot, list[str]]:
    """The robot as it is shipped, and the lines on top of its file."""
    path, folders = find_installed(source.urdf)
    description = path.parents[1]
    if f"license: {source.licence}\n" not in (description / source.licence_file).read_text(encoding="utf-8"):
        raise SystemExit(f"{description / source.licence_file} does not say {source.licence!r}")
    options = ImportOptions(
        tool=source.tool,
        base=source.base,
        srdf=description / source.srdf if source.srdf else None,
        package_paths=folders,
        protrusion_m=source.protrusion_m,
    )
    imported = read_urdf(path, options)
    where = f"{PACKAGE} {version(PACKAGE)} ({source.licence}), {description.name}/{path.relative_to(description)}"
    licence = f"the licence is that of its {source.licence_file}"
    robot = replace(imported.robot, name=source.name, title=source.title)
    robot = check_home(rename_detector(replace(robot, approximations=round_spheres(robot))))
    notes = [
        f"{source.title}: imported from {where}; {licence}. m and rad.",
        "Written by benchmarks/import_robots.py.",
        *(f"Frozen: {held.name} at {held.value:.9g}, {held.reason}." for held in imported.held),
    ]
    return replace(robot, provenance=name_sources(robot, source, imported, f"{where}; {licence}")), notes


def check_home(robot: Robot) -> Robot:
    """The robot, whose home must be free."""
    if compute_gaps(CollisionModel.of(robot), robot.home[None]).min() <= 0.0:
        raise SystemExit(f"{robot.name}: home collides")
    return robot


def round_spheres(robot: Robot) -> dict[str, tuple[FreeSpheres, ...]]:
    """The spheres on a grid, as much larger as it takes to hold what they held."""

    def enclose(x: float, y: float, z: float, r: float) -> tuple[float, ...]:
        centre = [round(value / GRID_M) for value in (x, y, z)]
        away = np.linalg.norm(np.array(centre) * GRID_M - (x, y, z))
        return tuple(number / 1e6 for number in (*centre, int(np.ceil((r + away) / GRID_M))))

    return {
        name: tuple(replace(row, spheres=tuple(enclose(*sphere) for sphere in row.spheres)) for row in rows)
        for name, rows in robot.approximations.items()
    }


def rename_detector(robot: Robot) -> Robot:
    """The robot with its detector called `default`, as in the other files."""
    (detector,) = robot.detectors.values()
    return replace(robot, detectors={"default": replace(detector, name="default")}, default_detector="default")


def name_sources(
    robot: Robot, source: Source, imported: ImportedUrdf, where: str
) -> dict[tuple[str | int, ...], Provenance]:
    """Where each entry comes from."""
    urdf = Provenance(kind="published", text=where)
    share = min((link.covered for link in imported.links if link.covered is not None), default=1.0)
    text = f"cover of the collision shapes that this URDF names; {100.0 * share:.3g} % of the surface of every link is"
    text += f" proved to lie inside, and spheres stand out by at most {1000.0 * source.protrusion_m:g} mm"
    spheres = Provenance(kind="derived", text=text)
    found = Provenance(kind="derived", text=f"home: {imported.home}")
    pairs = Provenance(kind="derived", text="pairs that are left out: by the SRDF beside the URDF, or always touching")
    check = Provenance(kind="calibrated", text="every pair of links but those; contact at distance 0")
    entries: dict[tuple[str | int, ...], Provenance] = {}
    for joint in robot.joints:
        keys = ("lower", "upper", "max_speed", "max_effort")
        written = [key for key in keys if joint.kind != "continuous" or key.startswith("max")]
        entries |= {("joints", joint.name, key): urdf for key in written if getattr(joint, key) is not None}
        entries["joints", joint.name, "home"] = found
    entries |= {("frames", frame.name): urdf for frame in robot.frames}
    for name, rows in robot.approximations.items():
        entries |= {("spheres", name, k): spheres for k in range(len(rows))}
    entries |= {("adjacent",): pairs} if robot.adjacent else {}
    entries |= {("detectors", name): check for name in robot.detectors}
    entries |= {("inertias", name): urdf for name in robot.inertias}
    return entries


def main() -> None:
    """One file a robot."""
    asked = sys.argv[1:]
    for source in SOURCES:
        if asked and source.name not in asked:
            continue
        robot, notes = import_source(source)
        path = Path(FOLDER / f"{source.name}.yaml")
        write_robot(robot, path, notes)
        robot = parse_file(path)
        spheres = sum(row.count for row in robot.approximations["spheres"])
        print(f"{source.name}: {len(robot.joints)} joints, {spheres} spheres, {path.stat().st_size} bytes", flush=True)


if __name__ == "__main__":
    main()
