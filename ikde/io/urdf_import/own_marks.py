"""What `<ikde>` says in URDFs that ikde has written: the tool, joints in order, components, and what is not known."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from ikde.errors import nearest, quoted
from ikde.io.xml_elements import Element, XmlFile
from ikde.kernels.arrays import Floats
from ikde.model.names import find_fault
from ikde.model.robot import MAX_MAGNITUDE

MAX_NUMBER = 1e9


class _Joint(Protocol):
    """What is asked of a joint."""

    @property
    def kind(self) -> str: ...
    @property
    def parent(self) -> str: ...
    @property
    def child(self) -> str: ...
    @property
    def p_parent_child(self) -> Floats: ...
    @property
    def R_parent_child(self) -> Floats: ...


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnMarks:
    """What the element says; of a file without one, nothing."""

    tool: str | None = None
    """A link."""
    safe_distance_m: float = 0.0
    joints: Mapping[str, float | None] = field(default_factory=dict)
    """Those that move, in the order of q, whether they move the tool or not, and their largest acceleration."""
    components: Mapping[str, str] = field(default_factory=dict)
    """Link -> component whose spheres it has; the link is fixed to the one that it is part of, and is no frame."""
    placeholders: Mapping[tuple[str, str, str], float] = field(default_factory=dict)
    """(`joint` or `link`, name, attribute) -> the number that stands for one that is not known."""

    def keep(self, tag: str, name: str, key: str, value: float | None) -> float | None:
        """A number of the file; None if it is the placeholder that was written there."""
        return None if value is None or self.placeholders.get((tag, name, key)) == value else value


def read_marks(file: XmlFile, links: Mapping[str, object], joints: Mapping[str, _Joint]) -> OwnMarks:
    """Read the element `<ikde>` of a file; raises `FileError` for a link or joint that there is not."""
    own = file.root.find("ikde")
    if own is None:
        return OwnMarks()
    tool = own.attributes.get("tool")
    if tool is not None and tool not in links:
        message = f"no link is called {quoted(tool)}{nearest(tool, links)}"
        raise file.error(message, own, "ikde", "tool")
    safe_m = file.read_number(own, "safe_distance", 0.0, "ikde")
    if not 0.0 <= safe_m <= MAX_MAGNITUDE:
        raise file.error(f"expected a distance of at least 0 m, got {safe_m:g}", own, "ikde", "safe_distance")
    moving = dict(_read_moving(file, element, joints) for element in own.find_all("coordinate"))
    components = dict(_read_component(file, element, links, joints) for element in own.find_all("component"))
    return OwnMarks(
        tool=tool,
        safe_distance_m=safe_m,
        joints=moving,
        components=components,
        placeholders=dict(_read_placeholders(file, own)),
    )


def _read_known(file: XmlFile, element: Element, key: str, known: Mapping[str, object], what: str) -> str:
    name = file.read_name(element, key, "ikde", element.tag)
    if name not in known:
        raise file.error(f"no {what} is called {quoted(name)}{nearest(name, known)}", element, "ikde", element.tag)
    return name


def _read_moving(file: XmlFile, element: Element, joints: Mapping[str, _Joint]) -> tuple[str, float | None]:
    """A joint of q and its largest acceleration."""
    name = _read_known(file, element, "joint", joints, "joint")
    value = file.read_number(element, "acceleration", 0.0, "ikde", "coordinate", name)
    if not 0.0 <= value <= MAX_NUMBER:
        message = f"expected a number above 0, up to {MAX_NUMBER:g}, got {value:g}"
        raise file.error(message, element, "ikde", "coordinate", name, "acceleration")
    return name, value or None


def _read_component(
    file: XmlFile, element: Element, links: Mapping[str, object], joints: Mapping[str, _Joint]
) -> tuple[str, str]:
    """A link and its component."""
    link, name = _read_known(file, element, "link", links, "link"), file.read_name(element, "name", "ikde", "component")
    if fault := find_fault(name):
        raise file.error(fault, element, "ikde", "component")
    above = [joint for joint in joints.values() if joint.child == link]
    is_end = len(above) == 1 and all(joint.parent != link for joint in joints.values())
    if not is_end or above[0].kind != "fixed":
        message = f"expected a link at an end, on a fixed joint, got {quoted(link)}"
        raise file.error(message, element, "ikde", "component")
    return link, name


def _read_placeholders(file: XmlFile, own: Element) -> list[tuple[tuple[str, str, str], float]]:
    return [
        ((tag, element.attributes[tag], key), file.read_number(element, key, None, "ikde", "placeholder"))
        for element in own.find_all("placeholder")
        for tag in ("joint", "link")
        if tag in element.attributes
        for key in ("velocity", "effort", "mass")
        if key in element.attributes
    ]
