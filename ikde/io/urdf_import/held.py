"""Joints that stay where they are: which, at which value, and why."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ikde.errors import InputError, nearest, quoted
from ikde.io.urdf_import.chain import LinkTree
from ikde.io.urdf_import.description import Description, UrdfJoint
from ikde.io.urdf_import.options import ImportOptions
from ikde.model.robot import MAX_MAGNITUDE


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldJoint:
    """A joint that is frozen at a value in m or rad."""

    name: str
    kind: str
    value: float
    reason: str


def find_held(
    description: Description,
    tree: LinkTree,
    tools: Iterable[str],
    options: ImportOptions,
    state: Mapping[str, float],
) -> dict[str, HeldJoint]:
    """Every joint that can move but does not; `tools` are links, `state` values of an SRDF.

    Raises:
        InputError, FileError: for an unknown joint, a value outside its limits, a mimic or floating joint on the chain.
    """
    for name, value in options.hold.items():
        _check_hold(description, name, value)
    on_chain = {joint.name for tool in tools for joint in tree.path(tool)}
    held: dict[str, HeldJoint] = {}
    for name, joint in description.joints.items():
        if joint.kind == "fixed":
            continue
        moves = name in on_chain or name in description.marks.joints
        reason = _find_reason(description, tree, joint, options, moves)
        if reason:
            value, how = _find_value(description, joint, options.hold, state)
            held[name] = HeldJoint(
                name=name, kind=joint.kind, value=value, reason=f"{reason}, {how}" if how else reason
            )
    return held


def _check_hold(description: Description, name: str, value: float) -> None:
    joint = description.joints.get(name)
    if joint is None or joint.kind == "fixed":
        known = [other.name for other in description.joints.values() if other.kind != "fixed"]
        what = "no joint" if joint is None else "a fixed joint, none that moves,"
        raise InputError(f"{what} is called {quoted(name)}{nearest(name, known)}", ("hold", name))
    if joint.kind in ("planar", "floating"):
        raise InputError(f"a {joint.kind} joint has no single value; it is held at 0", ("hold", name))
    if not joint.lower <= value <= joint.upper or abs(value) > MAX_MAGNITUDE:
        raise InputError(f"expected a value from {joint.lower:g} to {joint.upper:g}, got {value:g}", ("hold", name))


def _find_reason(
    description: Description, tree: LinkTree, joint: UrdfJoint, options: ImportOptions, moves: bool
) -> str | None:
    """Why a joint is held; None if it moves the tool."""
    if joint.name in options.hold:
        return "asked for"
    if not moves:
        return "off the chain to the tool"
    if joint.mimic is not None:
        message = f"it mimics {quoted(joint.mimic.joint)} and moves the tool; hold it (--hold {joint.name}=VALUE)"
        raise description.error(message, joint)
    if options.base != "urdf" and joint.kind in ("planar", "floating") and joint.parent == tree.root:
        return "the base is another one"
    if joint.kind == "floating":
        message = (
            "a floating joint moves the tool, and a body in the air has nothing to solve for; give it a base (--base)"
        )
        raise description.error(message, joint)
    return None


def _find_value(
    description: Description, joint: UrdfJoint, hold: Mapping[str, float], state: Mapping[str, float]
) -> tuple[float, str]:
    """Where a joint is held: as asked for, as its master, as in the SRDF, else at 0 or the limit next to it."""
    seen: set[str] = set()
    factor, offset, source = 1.0, 0.0, joint
    while (
        source.name not in hold
        and source.mimic
        and source.name not in seen
        and source.mimic.joint in description.joints
    ):
        seen.add(source.name)
        factor, offset = factor * source.mimic.multiplier, offset + factor * source.mimic.offset
        source = description.joints[source.mimic.joint]
    if source.name in hold:
        value, how = hold[source.name], "--hold"
    elif source.name in state:
        value, how = state[source.name], "SRDF state"
    else:
        value = _clip(source, 0.0)
        how = "" if value == 0.0 else "the limit next to 0"
    if source is not joint:
        value, how = factor * value + offset, f"mimics {source.name}"
    value = _clip(joint, value)
    if not abs(value) <= MAX_MAGNITUDE:
        raise description.error(f"it cannot be held at {value:g}; expected at most {MAX_MAGNITUDE:g}", joint)
    return value, how


def _clip(joint: UrdfJoint, value: float) -> float:
    if joint.kind not in ("revolute", "prismatic"):
        return value
    return min(max(value, joint.lower), joint.upper)
