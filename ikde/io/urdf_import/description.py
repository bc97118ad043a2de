"""What a URDF file says: links with shapes and masses, joints with axes and limits; numbers read, names resolved."""

from dataclasses import dataclass, field, replace
from math import inf
from pathlib import Path
from typing import Literal, TypeVar, cast, get_args

import numpy as np

from ikde.errors import FileError, InputError, nearest, quoted
from ikde.io.urdf_import.own_marks import OwnMarks, read_marks
from ikde.io.xml_elements import Element, XmlFile
from ikde.kernels.arrays import Floats
from ikde.model.names import check_printable
from ikde.model.robot import MAX_MAGNITUDE, Inertia
from ikde.model.rotation import rotation_from_rpy
from ikde.model.tree import transform
from ikde.spheres.shapes import ShapeKind

UrdfKind = Literal["revolute", "continuous", "prismatic", "fixed", "planar", "floating"]
Part = TypeVar("Part", "UrdfLink", "UrdfJoint")
MAX_LINKS = 1000
MAX_NUMBER = 1e9  # of masses, speeds, efforts and axes, as in a robot file
SIZES = {"sphere": ("radius",), "cylinder": ("radius", "length"), "capsule": ("radius", "length")}


@dataclass(frozen=True, slots=True, kw_only=True)
class Mimic:
    """value = multiplier * value of `joint` + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UrdfJoint:
    """One joint; `lower` and `upper` are infinite where the file gives none, and of kinds without limits."""

    name: str
    kind: UrdfKind
    parent: str
    child: str
    p_parent_child: Floats
    R_parent_child: Floats
    axis: Floats
    """[3] unit vector in the child."""
    lower: float
    upper: float
    max_speed: float | None
    max_effort: float | None
    mimic: Mimic | None
    line: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UrdfShape:
    """One collision element of a link; a mesh is still a name."""

    kind: ShapeKind
    size: tuple[float, ...]
    T_link_shape: Floats
    mesh: str
    scale: tuple[float, float, float]
    line: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UrdfLink:
    """One link."""

    name: str
    shapes: tuple[UrdfShape, ...]
    inertia: Inertia | None
    line: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Description:
    """The whole file; every joint's links exist, no name is given twice."""

    path: Path
    name: str
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]
    warnings: tuple[str, ...]
    marks: OwnMarks = field(default_factory=OwnMarks)
    """What `<ikde>` says, in files that ikde has written."""

    def error(self, message: str, part: UrdfLink | UrdfJoint) -> FileError:
        """An error about a link or joint."""
        where = ("joint" if isinstance(part, UrdfJoint) else "link", part.name)
        return FileError(self.path, message, where, part.line)


def read_description(path: Path) -> Description:
    """Read a URDF file; raises `FileError` with line and name for the first thing that is wrong."""
    file = XmlFile(path)
    root = file.root
    if path.suffix.lower() == ".xacro" or any(element.tag.startswith("xacro:") for element in root.children):
        stem = path.name.removesuffix(".xacro").removesuffix(".urdf")
        target = f"{stem}{'_expanded' if path.suffix.lower() == '.urdf' else ''}.urdf"
        raise FileError(path, f"this is xacro, not URDF; expand it first: xacro {path.name} > {target}")
    if root.tag != "robot":
        raise file.error(f"expected <robot>, got <{root.tag}>", root)
    warnings: list[str] = []
    links = _named(file, "link", [_read_link(file, element, warnings) for element in root.find_all("link")])
    if not links:
        raise file.error("expected at least one <link>", root)
    if len(links) > MAX_LINKS:
        raise file.error(f"expected at most {MAX_LINKS:,} links, got {len(links):,}", root)
    joints = _named(file, "joint", [_read_joint(file, element, links) for element in root.find_all("joint")])
    name = root.attributes.get("name") or path.stem
    check_name(file, name, root, "robot")
    marks = read_marks(file, links, joints)
    return Description(
        path=path,
        name=name,
        links={own.name: _drop_mass(own, marks) for own in links.values()},
        joints={own.name: _drop_limits(own, marks) for own in joints.values()},
        warnings=tuple(warnings),
        marks=marks,
    )


def _drop_mass(link: UrdfLink, marks: OwnMarks) -> UrdfLink:
    """The link without a mass that is a placeholder."""
    mass_kg = marks.keep("link", link.name, "mass", link.inertia.mass_kg if link.inertia else None)
    return link if mass_kg is not None else replace(link, inertia=None)


def _drop_limits(joint: UrdfJoint, marks: OwnMarks) -> UrdfJoint:
    """The joint without a speed or an effort that is a placeholder."""
    speed = marks.keep("joint", joint.name, "velocity", joint.max_speed)
    effort = marks.keep("joint", joint.name, "effort", joint.max_effort)
    return replace(joint, max_speed=speed, max_effort=effort)


def _named(file: XmlFile, tag: str, parts: list[Part]) -> dict[str, Part]:
    named: dict[str, Part] = {}
    for part in parts:
        if part.name in named:
            message = f"this name is given twice, first in line {named[part.name].line}"
            raise FileError(file.path, message, (tag, part.name), part.line)
        named[part.name] = part
    return named


def check_name(file: XmlFile, name: str, element: Element, *where: str) -> None:
    """Raise `FileError` unless this can be a name."""
    try:
        check_printable(name, where)
    except InputError as error:
        raise file.error(error.message, element, *where) from None


def _read_link(file: XmlFile, element: Element, warnings: list[str]) -> UrdfLink:
    name = file.read_name(element, "name", "link")
    check_name(file, name, element, "link", name)
    shapes = [_read_shape(file, collision, name, warnings) for collision in element.find_all("collision")]
    inertial = element.find("inertial")
    return UrdfLink(
        name=name,
        shapes=tuple(shape for shape in shapes if shape),
        inertia=_read_inertia(file, inertial, name) if inertial else None,
        line=element.line,
    )


def _read_origin(file: XmlFile, element: Element, *where: str) -> tuple[Floats, Floats]:
    """Place [3] and rotation [3, 3] of its <origin>."""
    origin, zero = element.find("origin"), (0.0, 0.0, 0.0)
    if origin is None:
        return np.zeros(3), np.eye(3)
    xyz = np.array(file.read_numbers(origin, "xyz", zero, *where))
    rpy = np.array(file.read_numbers(origin, "rpy", zero, *where))
    for key, numbers in (("xyz", xyz), ("rpy", rpy)):
        if np.abs(numbers).max() > MAX_MAGNITUDE:
            raise file.error(f"expected numbers within {MAX_MAGNITUDE:g} of 0", origin, *where, key)
    return xyz, rotation_from_rpy(rpy)


def _read_shape(file: XmlFile, collision: Element, link: str, warnings: list[str]) -> UrdfShape | None:
    geometry, where = collision.find("geometry"), ("link", link, "collision")
    shape = geometry.children[0] if geometry and geometry.children else None
    if shape is None or shape.tag not in get_args(ShapeKind):
        what = f"<{shape.tag}> is no shape that is read" if shape else "it has no shape"
        warnings.append(f"line {collision.line}: a collision element of {link} is left out: {what}")
        return None
    p, R = _read_origin(file, collision, *where)
    size, scale = (), (1.0, 1.0, 1.0)
    if shape.tag == "box":
        file.read_name(shape, "size", *where)
        size = file.read_numbers(shape, "size", (0.0, 0.0, 0.0), *where)
    elif shape.tag == "mesh":
        x, y, z = file.read_numbers(shape, "scale", scale, *where)
        scale = (x, y, z)
    else:
        size = tuple(file.read_number(shape, key, None, *where) for key in SIZES[shape.tag])
    if not all(0.0 < value <= MAX_MAGNITUDE for value in (*size, *map(abs, scale))):
        raise file.error(f"expected sizes above 0, up to {MAX_MAGNITUDE:g} m", shape, *where)
    return UrdfShape(
        kind=cast(ShapeKind, shape.tag),
        size=size,
        T_link_shape=transform(R, p),
        mesh=file.read_name(shape, "filename", *where) if shape.tag == "mesh" else "",
        scale=scale,
        line=shape.line,
    )


def _read_inertia(file: XmlFile, inertial: Element, link: str) -> Inertia | None:
    where = ("link", link, "inertial")
    mass, moments = inertial.find("mass"), inertial.find("inertia")
    if mass is None:
        return None
    p, R = _read_origin(file, inertial, *where)
    mass_kg = file.read_numbers(mass, "value", (0.0,), *where)[0]
    if not 0.0 <= mass_kg <= MAX_NUMBER:
        raise file.error(f"expected a mass of at least 0 kg, got {mass_kg:g}", mass, *where)
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    read = [file.read_numbers(moments, key, (0.0,), *where)[0] if moments else 0.0 for key in keys]
    if max(map(abs, read)) > MAX_NUMBER:
        raise file.error(f"expected moments within {MAX_NUMBER:g} of 0", inertial, *where)
    xx, yy, zz, xy, xz, yz = read
    I_own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    I_com_frame = R @ I_own @ R.T
    return Inertia(mass_kg=mass_kg, p_frame_com=p, I_com_frame=0.5 * (I_com_frame + I_com_frame.T))


def _read_joint(file: XmlFile, element: Element, links: dict[str, UrdfLink]) -> UrdfJoint:
    name = file.read_name(element, "name", "joint")
    check_name(file, name, element, "joint", name)
    where = ("joint", name)
    kind = file.read_name(element, "type", *where)
    if kind not in get_args(UrdfKind):
        raise file.error(f"expected one of {', '.join(get_args(UrdfKind))}, got {quoted(kind)}", element, *where)
    p, R = _read_origin(file, element, *where)
    lower, upper, speed, effort = _read_limits(file, element, kind, name)
    return UrdfJoint(
        name=name,
        kind=cast(UrdfKind, kind),
        parent=_read_end(file, element, "parent", links, *where),
        child=_read_end(file, element, "child", links, *where),
        p_parent_child=p,
        R_parent_child=R,
        axis=_read_axis(file, element, kind, *where),
        lower=lower,
        upper=upper,
        max_speed=speed,
        max_effort=effort,
        mimic=_read_mimic(file, element, *where),
        line=element.line,
    )


def _read_end(file: XmlFile, joint: Element, tag: str, links: dict[str, UrdfLink], *where: str) -> str:
    element = joint.find(tag)
    if element is None:
        raise file.error(f"expected a <{tag}>", joint, *where)
    link = file.read_name(element, "link", *where, tag)
    if link not in links:
        raise file.error(f"no link is called {quoted(link)}{nearest(link, links)}", element, *where, tag)
    return link


def _read_axis(file: XmlFile, joint: Element, kind: str, *where: str) -> Floats:
    element = joint.find("axis")
    along_x = (1.0, 0.0, 0.0)
    axis = np.array(along_x if element is None else file.read_numbers(element, "xyz", along_x, *where, "axis"))
    norm = float(np.linalg.norm(axis)) if np.abs(axis).max() <= MAX_NUMBER else 0.0
    if norm <= 1e-9:
        if kind in ("fixed", "floating"):
            return np.array(along_x)
        raise file.error("expected an axis that is neither zero nor huge", element or joint, *where, "axis")
    return axis / norm


def _read_limits(
    file: XmlFile, joint: Element, kind: str, name: str
) -> tuple[float, float, float | None, float | None]:
    """Lower, upper, speed and effort. In a <limit>, ends that are not given are 0, as URDF says; a plane has both."""
    limit, where = joint.find("limit"), ("joint", name, "limit")
    if limit is None:
        return -inf, inf, None, None
    lower, upper = -inf, inf
    if kind in ("revolute", "prismatic"):
        lower, upper = (file.read_number(limit, key, 0.0, *where) for key in ("lower", "upper"))
    if kind == "planar" and {"lower", "upper"} <= set(limit.attributes):
        lower, upper = (file.read_number(limit, key, 0.0, *where) for key in ("lower", "upper"))
    if lower > upper:
        raise file.error(f"the upper limit {upper:g} is below the lower one, {lower:g}", limit, *where)
    speed, effort = (file.read_number(limit, key, 0.0, *where) for key in ("velocity", "effort"))
    return lower, upper, _keep(speed), _keep(effort)


def _keep(value: float) -> float | None:
    """A speed or an effort; 0, and what has no end, say nothing."""
    return value if 0.0 < value <= MAX_NUMBER else None


def _read_mimic(file: XmlFile, joint: Element, *where: str) -> Mimic | None:
    mimic = joint.find("mimic")
    if mimic is None:
        return None
    master = file.read_name(mimic, "joint", *where, "mimic")
    multiplier, offset = (
        file.read_numbers(mimic, key, (default,), *where, "mimic")[0]
        for key, default in (("multiplier", 1.0), ("offset", 0.0))
    )
    return Mimic(joint=master, multiplier=multiplier, offset=offset)
