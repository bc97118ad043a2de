"""What an import did, as data: for tables and for callers."""

from dataclasses import dataclass

from ikde.io.urdf_import.held import HeldJoint
from ikde.model.robot import Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class CoveredLink:
    """Spheres of one link."""

    link: str
    shapes: str
    """What they cover, such as `2 boxes, 1 mesh`."""
    spheres: int
    covered: float | None
    """Share of the surface that lies inside spheres by proof; None: the shapes are spheres themselves."""
    protrusion_m: float
    """How far they stand out of the shapes at most."""
    how: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportedUrdf:
    """A robot, and all that was decided on the way to it."""

    robot: Robot
    file: str
    root: str
    """The URDF's root link."""
    tool_was_chosen: bool
    """Whether the tool is the only leaf, and was not named."""
    joint_notes: dict[str, str]
    """Joint of the robot -> what the file lacks about it."""
    held: tuple[HeldJoint, ...]
    """Joints that could move and do not."""
    links: tuple[CoveredLink, ...]
    home: str
    """Where the home configuration comes from."""
    is_home_free: bool | None
    """None: not checked."""
    warnings: tuple[str, ...]


def list_notes(imported: ImportedUrdf) -> list[str]:
    """Lines for the top of the robot's file: what a reader of it cannot see in it."""
    held = [f"frozen: {joint.name} ({joint.kind}) at {joint.value:.9g}: {joint.reason}" for joint in imported.held]
    warnings = [f"warning: {warning}" for warning in imported.warnings]
    return [f"Imported from {imported.file}; m and rad.", *held, f"home: {imported.home}", *warnings]
