"""Spheres of links as another program's file gives them, in place of covers of their shapes."""

from collections.abc import Iterable, Mapping

import numpy as np

from ikde.errors import FileError, nearest, quoted
from ikde.io.sphere_files import COPIES, SphereFile
from ikde.io.urdf_import.chain import list_names
from ikde.io.urdf_import.cover_links import LinkSpheres
from ikde.io.urdf_import.imported import CoveredLink


def give_spheres(file: SphereFile, links: Mapping[str, bool]) -> tuple[dict[str, LinkSpheres], list[str]]:
    """The spheres of each link that the file has some for, and what is worth a warning.

    Args:
        file: what was read.
        links: names of the robot's links, and whether each has shapes.

    Returns:
        Spheres by link in the order of `links`; and warnings: links that there are not, links whose shapes stay without
        spheres, and what the file says beside.

    Raises:
        FileError: if the file has no sphere for any link.
    """
    placed = {_find_link(name, links): balls for name, balls in file.spheres.items()}
    found = {link: placed[link] for link in links if placed.get(link)}
    if not found:
        name = next(name for name, balls in file.spheres.items() if balls)
        raise FileError(file.path, f"no link of the robot has spheres here: {quoted(name)}{nearest(name, links)}")
    unknown = [name for name in file.spheres if _find_link(name, links) not in links]
    bare = [link for link, has_shapes in links.items() if has_shapes and link not in found]
    return {link: _place(link, balls, file) for link, balls in found.items()}, [*_warn(file, unknown, bare)]


def _find_link(name: str, links: Mapping[str, bool]) -> str:
    """The link that is meant; files of ours name a component's link after it."""
    return name.removeprefix(COPIES) if name not in links else name


def _place(link: str, balls: tuple[tuple[float, float, float, float], ...], file: SphereFile) -> LinkSpheres:
    rows = np.array(balls)
    report = CoveredLink(
        link=link,
        shapes="spheres of a file",
        spheres=len(rows),
        covered=None,
        protrusion_m=None,
        how=f"as in {file.path.name} ({file.kind})",
    )
    return LinkSpheres(centres=rows[:, :3], radii=rows[:, 3], report=report)


def _warn(file: SphereFile, unknown: list[str], bare: list[str]) -> Iterable[str]:
    if unknown:
        yield f"{file.path.name} has spheres for links that there are not: {list_names(unknown)}"
    if bare:
        yield f"{file.path.name} has no spheres for links with shapes, which are not checked: {list_names(bare)}"
    yield from (f"{file.path.name}: {note}" for note in file.notes)
