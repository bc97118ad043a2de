"""What an import did, as data: for tables and for callers."""

from dataclasses import dataclass

from ikde.io.urdf_import.held import HeldJoint
from ikde.model.robot import Robot

AS_THEY_ARE = "as they are"
"""How spheres are made of collision elements that are spheres."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CoveredLink:
    """Spheres of one link."""

    link: str
    shapes: str
    """What they cover, such as `2 boxes, 1 mesh`."""
    spheres: int
    covered: float | None
    """Share of the surface that lies inside spheres by proof; None: the shapes are spheres themselves."""
    protrusion_m: float | None
    """How far they stand out of the shapes at most; None: not checked."""
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
    made = [f"spheres of {describe_cover(link)}" for link in imported.links if link.how != AS_THEY_ARE]
    return [f"Imported from {imported.file}; m and rad.", *held, f"home: {imported.home}", *made, *warnings]


def describe_cover(link: CoveredLink) -> str:
    """A line of a robot's file: what was covered how, and what is known of it."""
    parts = [f"{link.link}: {link.spheres} for {link.shapes}, {link.how}"]
    if link.covered is not None:
        parts.append(f"{100.0 * link.covered:.6g} % proved to be covered")
    if link.protrusion_m:
        parts.append(f"at most {link.protrusion_m * 1e3:.3g} mm out")
    return "; ".join(parts)
