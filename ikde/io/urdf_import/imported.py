"""What an import did, as data: for tables and for callers."""

from dataclasses import dataclass

from ikde.io.urdf_import.held import HeldJoint
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Pairs, Robot

OF_THE_TREE = ("one body", "joined by joint")
"""Reasons that the tree of joints shows."""

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
    never_touching: Pairs = ()
    """Compared pairs of components that are proved never to touch within the joints' limits."""
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        said = f"{len(self.held)} frozen joints, {len(self.links)} links with spheres, {len(self.warnings)} warnings"
        return f"<ImportedUrdf {self.robot!r} from {self.file!r}: {said}>"


def list_notes(imported: ImportedUrdf) -> list[str]:
    """Lines for the top of the robot's file: what a reader of it cannot see in it."""
    held = [f"frozen: {joint.name} ({joint.kind}) at {joint.value:.9g}: {joint.reason}" for joint in imported.held]
    warnings = [f"warning: {warning}" for warning in imported.warnings]
    made = [f"spheres of {describe_cover(link)}" for link in imported.links if link.how != AS_THEY_ARE]
    decided = [f"home: {imported.home}", f"pairs: {describe_pairs(imported)}"]
    return [f"Imported from {imported.file}; m and rad.", *held, *decided, *made, *warnings]


def describe_cover(link: CoveredLink) -> str:
    """A line of a robot's file: what was covered how, and what is known of it."""
    parts = [f"{link.link}: {link.spheres} for {link.shapes}, {link.how}"]
    if link.covered is not None:
        parts.append(f"{100.0 * link.covered:.6g} % proved to be covered")
    if link.protrusion_m:
        parts.append(f"at most {link.protrusion_m * 1e3:.3g} mm out")
    return "; ".join(parts)


def describe_pairs(imported: ImportedUrdf) -> str:
    """How many pairs are compared, how many of them are proved never to touch, and how many are left out."""
    collision = CollisionModel.of(imported.robot)
    if not collision.pairs:
        return "none, self-collision is not checked"
    never, left_out = len(imported.never_touching), collision.left_out_pairs
    proved = f", of which {never} never touch (proved)" if never else ""
    neighbours = sum(pair.reason.startswith(OF_THE_TREE) for pair in left_out)
    left = f"{len(left_out)} left out, of which {neighbours} are neighbours"
    return f"{len(collision.pairs) + len(left_out)} in all: {len(collision.pairs)} compared{proved}; {left}"
