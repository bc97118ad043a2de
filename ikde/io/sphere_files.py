"""Spheres of links in other programs' files: cuRobo's robot files, XRDF, and SRDF `<link_sphere_approximation>`."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from ikde.errors import FileError, quoted
from ikde.formats.reading import read_text
from ikde.io.sphere_pairs import read_ignored
from ikde.io.srdf import Srdf
from ikde.io.xml_elements import XmlFile
from ikde.io.yaml_file import Document, Where, read_yaml
from ikde.model.robot import MAX_MAGNITUDE

Ball = tuple[float, float, float, float]
"""Centre in the link and radius: x, y, z, r in m."""
Kind = Literal["cuRobo", "XRDF", "SRDF"]
MAX_SPHERES = 10_000
"""Of one link."""
SPHERES = "collision_spheres"
COPIES = "component_"
"""What stands before a component's name in files that ikde has written for its own URDF."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SphereFile:
    """The spheres of a file, and what else it says about them that is not taken over."""

    path: Path
    kind: Kind
    spheres: Mapping[str, tuple[Ball, ...]]
    """By link; none for a link that is not to collide."""
    notes: tuple[str, ...] = ()
    ignored: Srdf = field(default_factory=Srdf)
    """Pairs that it leaves out, and a home, of cuRobo's and XRDF."""


def read_spheres(path: Path) -> SphereFile:
    """Read the spheres of a file, whichever kind it is: in m, in the frames of their links.

    A sphere without a radius above 0 stands for nothing in all three formats; it is left out and counted. Buffers,
    which make spheres larger for some checks, are not added; that is noted.

    Raises:
        FileError: for a file that is none of the three kinds, or a value that is no sphere, with its line and key.
    """
    if read_text(path).lstrip("\ufeff \t\r\n").startswith("<"):
        return _read_srdf(path)
    document = read_yaml(path)
    data = document.data
    if isinstance(data, dict) and (str(data.get("format", "")).lower() == "xrdf" or "geometry" in data):
        return _read_xrdf(document, data)
    return _read_curobo(document)


def _read_srdf(path: Path) -> SphereFile:
    file = XmlFile(path)
    elements = file.root.find_all("link_sphere_approximation")
    if file.root.tag != "robot" or not elements:
        raise file.error("expected an SRDF with <link_sphere_approximation>", file.root)
    found: dict[str, list[Ball]] = {}
    for element in elements:
        link = file.read_name(element, "link", "link_sphere_approximation")
        for sphere in element.find_all("sphere"):
            x, y, z = file.read_numbers(sphere, "center", (0.0, 0.0, 0.0), link)
            radius = file.read_number(sphere, "radius", None, link)
            if not _is_place((x, y, z, radius)):
                raise file.error(f"expected a sphere within {MAX_MAGNITUDE:g} m", sphere, link)
            found.setdefault(link, []).append((x, y, z, radius))
        found.setdefault(link, [])
    return _make(path, "SRDF", found, [])


def _read_curobo(document: Document) -> SphereFile:
    """A robot file, its `kinematics` alone, or the file of spheres that it names."""
    where, section = _find_curobo(document)
    spheres = section[SPHERES]
    where = (*where, SPHERES)
    buffers = [key for key in ("collision_sphere_buffer", "self_collision_buffer") if _says_more(section.get(key))]
    notes = [f"{key} is not added to radii" for key in buffers]
    if isinstance(spheres, str):
        made = _follow(document, spheres, where)
        made = replace(made, notes=(*notes, *made.notes))
    else:
        found = {name: _read_list(document, own, (*where, name)) for name, own in _items(document, spheres, where)}
        made = _make(document.path, "cuRobo", found, notes)
    return replace(made, ignored=read_ignored(document, section, where[:-1]))


def _find_curobo(document: Document) -> tuple[Where, dict[Any, Any]]:
    for where in ((), ("kinematics",), ("robot_cfg",), ("robot_cfg", "kinematics")):
        section = document.data
        for key in where:
            section = section.get(key) if isinstance(section, dict) else None
        if isinstance(section, dict) and SPHERES in section:
            return where, section
    raise document.error(f"expected cuRobo's {SPHERES}, XRDF's geometry, or an SRDF")


def _follow(document: Document, name: str, where: Where) -> SphereFile:
    """The file of spheres that a robot file names, beside it or below."""
    folder = document.path.parent.resolve()
    path = None
    with suppress(OSError, ValueError, RuntimeError):
        path = (document.path.parent / name).resolve()
        path = path if path.is_relative_to(folder) and path.is_file() else None
    if path is None:
        raise document.error(f"its spheres are in {quoted(name)}, which is not in its folder; name that file", where)
    other = read_yaml(path)
    own, section = _find_curobo(other)
    if isinstance(section[SPHERES], str):
        raise other.error("expected links with their spheres", (*own, SPHERES))
    return _read_curobo(other)


def _read_xrdf(document: Document, data: dict[Any, Any]) -> SphereFile:
    name, where = _choose_geometry(document, data)
    geometry: dict[Any, Any] = data["geometry"]
    own = geometry[name]
    clone = own.get("clone") if isinstance(own, dict) and "spheres" not in own else None
    if isinstance(clone, str) and clone in geometry:
        where, own = ("geometry", clone), geometry[clone]
    if not isinstance(own, dict) or "spheres" not in own:
        raise document.error("expected spheres by link", where)
    where = (*where, "spheres")
    found = {
        link: _read_list(document, balls, (*where, link)) for link, balls in _items(document, own["spheres"], where)
    }
    sections = {key: data.get(key) for key in ("collision", "self_collision")}
    buffers = [key for key, own in sections.items() if isinstance(own, dict) and _says_more(own.get("buffer_distance"))]
    notes = [f"{key}.buffer_distance is not added to radii" for key in buffers]
    if _says_more(data.get("modifiers")):
        notes.append("modifiers, such as frames that are added, are not made")
    made = _make(document.path, "XRDF", found, notes)
    return replace(made, ignored=read_ignored(document, {"format": "xrdf", **data}, ()))


def _choose_geometry(document: Document, data: dict[Any, Any]) -> tuple[Any, Where]:
    """The geometry that `collision` names, else the only one."""
    geometry = data.get("geometry")
    if not isinstance(geometry, dict) or not geometry:
        raise document.error("expected a geometry with spheres", ("geometry",))
    collision = data.get("collision") or data.get("self_collision")
    chosen = collision.get("geometry") if isinstance(collision, dict) else None
    if chosen is None and len(geometry) > 1:
        raise document.error("expected collision.geometry, which names one of them", ("geometry",))
    name = next(iter(geometry)) if chosen is None else chosen
    if not isinstance(name, str) or name not in geometry:
        raise document.error(f"no geometry is called {quoted(str(name))}", ("collision", "geometry"))
    return name, ("geometry", name)


def _items(document: Document, spheres: Any, where: Where) -> list[tuple[str, Any]]:
    if not isinstance(spheres, dict) or not all(isinstance(name, str) for name in spheres):
        raise document.error("expected links with their spheres", where)
    return list(spheres.items())


def _read_list(document: Document, balls: Any, where: Where) -> list[Ball]:
    """The spheres of one link: `{center: [x, y, z], radius: r}` each."""
    if not isinstance(balls, list | None):
        raise document.error("expected a list of spheres", where)
    found = []
    for index, ball in enumerate(balls or []):
        numbers = [*ball.get("center", ()), ball.get("radius")] if _is_ball(ball) else []
        if len(numbers) != 4 or not _is_place(numbers):
            raise document.error("expected {center: [x, y, z], radius: r}, in m", (*where, index))
        found.append((float(numbers[0]), float(numbers[1]), float(numbers[2]), float(numbers[3])))
    return found


def _is_ball(ball: Any) -> bool:
    return isinstance(ball, dict) and isinstance(ball.get("center"), list)


def _is_place(numbers: Sequence[Any]) -> bool:
    are_numbers = all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers)
    return are_numbers and all(
        abs(number) <= MAX_MAGNITUDE for number in numbers
    )  # False for NaN; as large as it likes


def _says_more(value: Any) -> bool:
    """Whether a buffer is more than 0, or anything is listed."""
    if isinstance(value, dict):
        return any(_says_more(own) for own in value.values())
    return bool(value)


def _make(path: Path, kind: Kind, found: Mapping[str, Sequence[Ball]], notes: Sequence[str]) -> SphereFile:
    kept = {link: tuple(ball for ball in balls if ball[3] > 0.0) for link, balls in found.items()}
    for link, balls in kept.items():
        if len(balls) > MAX_SPHERES:
            raise FileError(path, f"expected at most {MAX_SPHERES:,} spheres of a link, got {len(balls):,}", (link,))
    if not any(kept.values()):
        raise FileError(path, "expected spheres with a radius above 0, got none")
    count = sum(len(balls) for balls in found.values()) - sum(map(len, kept.values()))
    flat = [f"{count} {'sphere' if count == 1 else 'spheres'} without a radius above 0"] if count else []
    return SphereFile(path=path, kind=kind, spheres=kept, notes=(*notes, *flat))
