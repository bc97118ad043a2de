"""The tree that joints make of links, and the chain in it that moves the tool."""

from dataclasses import dataclass

from ikde.errors import FileError, nearest, quoted, shorten
from ikde.io.urdf_import.description import Description, UrdfJoint

NAMED = 8  # leaves in a message


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkTree:
    """Links with their root, and each one's joint to its parent."""

    root: str
    order: tuple[str, ...]
    """All links, parents first, otherwise as in the file."""
    joint_of: dict[str, UrdfJoint]
    """Of each link but the root."""

    def path(self, link: str) -> tuple[UrdfJoint, ...]:
        """Joints from the root to a link."""
        joints = []
        while link != self.root:
            joints.append(self.joint_of[link])
            link = joints[-1].parent
        return tuple(joints[::-1])


def find_tree(description: Description) -> LinkTree:
    """The tree; raises `FileError` for two roots, a link with two parents and a cycle."""
    joint_of: dict[str, UrdfJoint] = {}
    children: dict[str, list[str]] = {name: [] for name in description.links}
    for joint in description.joints.values():
        if joint.child in joint_of:
            other = joint_of[joint.child].name
            raise description.error(f"its child {quoted(joint.child)} is that of joint {quoted(other)} as well", joint)
        joint_of[joint.child] = joint
        children[joint.parent].append(joint.child)
    roots = [name for name in description.links if name not in joint_of]
    if len(roots) > 1:
        named = f"{len(roots)} links have no parent, {list_names(roots)}; expected one"
        raise FileError(description.path, named, ("link", roots[1]), description.links[roots[1]].line)
    order, waiting = [], roots[:]
    while waiting:
        name = waiting.pop()
        order.append(name)
        waiting += children[name][::-1]
    if len(order) < len(description.links):
        rest = set(order)
        loop = next(name for name in description.links if name not in rest)
        message = "a cycle: following the parents never reaches a root"
        raise description.error(message, joint_of[loop])
    return LinkTree(root=roots[0], order=tuple(order), joint_of=joint_of)


def choose_tool(description: Description, tree: LinkTree, tool: str | None, base_moves: bool = False) -> str:
    """The link that is asked for, or the only leaf that a joint moves; raises `FileError` for anything else.

    If none is moved by a joint of the file but its base is, all leaves are.
    """
    part_of = description.marks.components.get(tool) if tool else None
    if tool and part_of is not None:
        message = f"the link {quoted(tool)} holds spheres of {quoted(part_of)} and is no frame; expected"
        carrier = tree.joint_of[tool].parent
        raise FileError(description.path, f"{message} another link, such as {quoted(carrier)}", ("tool",))
    if tool in description.links:
        return tool
    parents = {joint.parent for joint in tree.joint_of.values()}
    leaves = [link for link in tree.order if link not in parents]
    moved = [leaf for leaf in leaves if any(joint.kind != "fixed" for joint in tree.path(leaf))]
    moved = leaves if base_moves and not moved else moved
    if tool is not None:
        known = nearest(tool, description.links) or f"; its ends are {list_names(moved or leaves)}"
        raise FileError(description.path, f"no link is called {quoted(tool)}{known}", ("tool",))
    if len(moved) != 1:
        found = f"it has {len(moved)} ends: {list_names(moved)}" if moved else "no joint of it moves"
        raise FileError(
            description.path,
            f"which link is the tool? {found}; name one, or a link that carries them: ikde robots import --tool NAME",
            ("tool",),
        )
    return moved[0]


def list_names(names: list[str] | tuple[str, ...]) -> str:
    """The first names, and how many more there are."""
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(shorten(name, 40) for name in names[:NAMED]) + more
