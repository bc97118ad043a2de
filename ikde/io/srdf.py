"""What an SRDF adds to a URDF: named configurations, and pairs of links that need no test, with reasons."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from ikde.errors import printable, shorten
from ikde.io.xml_elements import XmlFile

PREFERRED = ("home", "ready", "default")
MAX_REASON_LENGTH = 80


@dataclass(frozen=True, slots=True, kw_only=True)
class DisabledPair:
    """Two links that the SRDF leaves out."""

    a: str
    b: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Srdf:
    """The parts of an SRDF that are read; without a file, nothing."""

    states: tuple[tuple[str, str, dict[str, float]], ...] = ()
    """Group, name, and values by joint, in m or rad."""
    disabled: tuple[DisabledPair, ...] = ()
    enabled: tuple[tuple[str, str], ...] = ()
    """Pairs of links that are compared whatever joins them."""
    is_whole: bool = False
    """Whether all pairs that are not disabled are compared, whatever joins them."""
    source: str = "the SRDF"
    """What says so."""

    def choose_states(self) -> tuple[tuple[str, ...], dict[str, float]]:
        """One state of each group, called home, ready or default if there is one, else its first; and all values."""
        chosen: dict[str, tuple[str, dict[str, float]]] = {}
        for group, name, values in self.states:
            known = chosen.get(group)
            if known is None or _rank(name) < _rank(known[0]):
                chosen[group] = (name, values)
        values = {joint: value for _, state in chosen.values() for joint, value in state.items()}
        names = tuple(f"{name} of {group}" if group else name for group, (name, _) in chosen.items())
        return names, values


def _rank(name: str) -> int:
    return PREFERRED.index(name.lower()) if name.lower() in PREFERRED else len(PREFERRED)


def read_srdf(path: Path) -> Srdf:
    """Read an SRDF; raises `FileError` with line and key for what is wrong."""
    file = XmlFile(path)
    if file.root.tag != "robot":
        raise file.error(f"expected <robot>, got <{file.root.tag}>", file.root)
    states = []
    for state in file.root.find_all("group_state"):
        group, name = state.attributes.get("group", ""), file.read_name(state, "name", "group_state")
        joints = [joint for joint in state.find_all("joint") if len(joint.attributes.get("value", "").split()) == 1]
        values = {
            file.read_name(joint, "name", "group_state", name): file.read_number(joint, "value", None, name)
            for joint in joints  # those of several numbers are planar or floating
        }
        states.append((group, name, {joint: value for joint, value in values.items() if isfinite(value)}))
    disabled = [
        DisabledPair(
            a=file.read_name(pair, "link1", "disable_collisions"),
            b=file.read_name(pair, "link2", "disable_collisions"),
            reason=shorten(printable(pair.attributes.get("reason", "").strip()), MAX_REASON_LENGTH),
        )
        for pair in file.root.find_all("disable_collisions")
    ]
    enabled = tuple(
        (file.read_name(pair, "link1", "enable_collisions"), file.read_name(pair, "link2", "enable_collisions"))
        for pair in file.root.find_all("enable_collisions")
    )
    return Srdf(states=tuple(states), disabled=tuple(disabled), enabled=enabled)
