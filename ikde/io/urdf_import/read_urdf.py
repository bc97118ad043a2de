"""From a URDF file to a robot that has been checked, with an account of what was decided."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import cast

from ikde.errors import FileError, InputError, quoted
from ikde.formats.reading import read_path
from ikde.io.sphere_files import SphereFile, read_spheres
from ikde.io.srdf import Srdf, read_srdf
from ikde.io.urdf_import.assemble import add_spheres, assemble, free_home, set_home
from ikde.io.urdf_import.chain import LinkTree, choose_tool, find_tree
from ikde.io.urdf_import.choose_pairs import PairChoice
from ikde.io.urdf_import.cover_links import LinkSpheres, cover_links
from ikde.io.urdf_import.description import Description, read_description
from ikde.io.urdf_import.finer import choose_finer, cover_finer
from ikde.io.urdf_import.frames import build_skeleton
from ikde.io.urdf_import.given_spheres import give_spheres
from ikde.io.urdf_import.held import HeldJoint, find_held
from ikde.io.urdf_import.imported import ImportedUrdf
from ikde.io.urdf_import.options import Base, ImportOptions, check_pairs
from ikde.model.robot import Robot


def import_urdf(
    path: str | PathLike[str],
    *,
    tool: str | Mapping[str, str] | None = None,
    base: Base = "urdf",
    srdf: str | PathLike[str] | None = None,
    spheres: bool | str | PathLike[str] = True,
    hold: Mapping[str, float] | None = None,
    package_paths: Sequence[str | PathLike[str]] = (),
    protrusion_m: float = 0.02,
    compare: Sequence[tuple[str, str]] = (),
) -> Robot:
    """A robot from a URDF file: the joints that move the tool, every link as a frame, spheres and pairs.

    `ikde.read_urdf` gives the same robot with an account of what was frozen, covered and left out, and takes what is
    asked for more rarely, such as the scale of meshes in mm.

    Args:
        path: the file.
        tool: the link that targets are for; None: the only leaf that a joint moves. Several links by name, as of two
            arms: the first is the tool, `robot.with_tool(name)` another one; joints that do not move it are held.
        base: `urdf` takes the file as it is; `fixed` holds a floating or planar joint of the root; `omni` and
            `differential` put x, y (within 100 m) and a continuous yaw under the root.
        srdf: an SRDF, for the home configuration and pairs of links that need no test.
        spheres: whether links get spheres; without, self-collision is not checked. A file of cuRobo's, an XRDF or SRDF:
            the spheres that it has, and no others.
        hold: joints that stay where they are, m or rad; joints off the chain to the tool stay anyway.
        package_paths: folders that meshes may lie in, beside the file's own.
        protrusion_m: how far spheres may stand out of the shapes that they cover.
        compare: pairs of links that are compared although they are adjacent, always touch, or the SRDF leaves them out.

    Raises:
        InputError: for a value that makes no sense.
        FileError: for a file that cannot be read or is wrong, with its line and the link or joint.
    """
    options = ImportOptions(
        tool=tool,
        base=base,
        hold={} if hold is None else hold,
        srdf=cast(Path | None, srdf),
        package_paths=cast(tuple[Path, ...], package_paths),
        spheres=cast(bool | Path, spheres),
        protrusion_m=protrusion_m,
        compare=check_pairs(compare),
    )
    robot = read_urdf(path, options).robot
    return robot.with_tool() if robot.tools else robot


def read_urdf(path: str | PathLike[str], options: ImportOptions | None = None) -> ImportedUrdf:
    """A robot from a URDF file, with an account of what was decided on the way.

    Args:
        path: the file.
        options: what the file does not say, as for `import_urdf`.

    Raises:
        InputError: for a value that makes no sense.
        FileError: for a file that cannot be read or is wrong, with its line and the link or joint.
    """
    options = ImportOptions() if options is None else options
    if not isinstance(options, ImportOptions):
        raise InputError(f"expected ImportOptions, got {quoted(options)}", ("options",))
    description = read_description(read_path(path, "path"))
    tree = find_tree(description)
    asked = description.marks.tool if options.tool is None else options.first_tool
    tool = choose_tool(description, tree, asked, options.drives)
    tools = {name: choose_tool(description, tree, link) for name, link in options.tools.items()}
    file = read_spheres(options.spheres) if isinstance(options.spheres, Path) else None
    srdf = read_srdf(options.srdf) if options.srdf else file.ignored if file else Srdf()
    states, values = srdf.choose_states()
    held = find_held(description, tree, (tool, *tools.values()), options, values)
    skeleton = build_skeleton(description, tree, tool, options, held)
    if not skeleton.joints:
        raise FileError(description.path, f"no joint moves the tool {tool!r}; name another link or a base", ("tool",))
    covered, given = _find_spheres(description, tree, options, file)
    covered = _sort_components(covered, description.marks.components)
    try:
        robot = assemble(description, skeleton, skeleton.frame_of[tool], options)
        robot = replace(robot, tools={name: skeleton.frame_of[link] for name, link in tools.items()})
        robot = set_home(robot, values)
        choice = PairChoice(srdf=srdf, asked=options.compare, safe_distance_m=description.marks.safe_distance_m)
        pairs = add_spheres(robot, skeleton, covered, choice)
        if finer := choose_finer(pairs.often, covered, skeleton.component_of):
            covered |= cover_finer(description, tree, options, finer)
            pairs = add_spheres(robot, skeleton, covered, choice)
    except FileError:
        raise
    except InputError as error:
        raise FileError(description.path, error.message, error.where) from None
    robot, home, is_free = free_home(pairs.robot, states, srdf)
    return ImportedUrdf(
        robot=robot,
        file=str(path),
        root=tree.root,
        tool_was_chosen=options.tool is None and description.marks.tool is None,
        joint_notes=skeleton.notes,
        held=tuple(held.values()),
        links=tuple(covered[link].report for link in covered),
        home=home,
        is_home_free=is_free,
        never_touching=pairs.never,
        warnings=(
            *description.warnings,
            *skeleton.warnings,
            *_list_followers(description, held),
            *(warning for own in covered.values() for warning in own.warnings),
            *given,
            *pairs.warnings,
        ),
    )


def _find_spheres(
    description: Description, tree: LinkTree, options: ImportOptions, file: SphereFile | None
) -> tuple[dict[str, LinkSpheres], list[str]]:
    """Spheres of links, made or given, and what is worth a warning of a file that gives them."""
    if file:
        parts = description.marks.components
        links = {
            name: bool(description.links[name].shapes) and parts.get(name) not in file.spheres for name in tree.order
        }
        return give_spheres(file, links)
    return (cover_links(description, tree, options) if options.spheres else {}), []


def _sort_components(covered: dict[str, LinkSpheres], parts: Mapping[str, str]) -> dict[str, LinkSpheres]:
    """Components in the order in which they were written, after all others."""
    order = {name: place for place, name in enumerate(parts.values())}
    return dict(sorted(covered.items(), key=lambda item: order.get(parts.get(item[0], item[0]), -1)))


def _list_followers(description: Description, held: Mapping[str, HeldJoint]) -> list[str]:
    """Frozen joints that would move with one of the chain."""
    mimics = {name: joint.mimic.joint for name in held if (joint := description.joints[name]).mimic}
    return [
        f"{name} mimics {master}, which moves: what it carries is checked where it is frozen"
        for name, master in mimics.items()
        if master in description.joints and master not in held
    ]
