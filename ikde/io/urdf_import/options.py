"""What is asked of an import."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Literal, cast, get_args

from ikde.errors import InputError, quoted
from ikde.formats.reading import read_path
from ikde.model.numbers import is_number
from ikde.model.robot import MAX_MAGNITUDE

Base = Literal["urdf", "fixed", "omni", "differential", "mecanum"]
REACH_M = 100.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportOptions:
    """What a URDF does not say; raises `InputError` for a wrong value."""

    tool: str | Mapping[str, str] | None = None
    """The link that targets are for; None: the only leaf that a joint moves. Several links by name: joints that move
    any of them move, and the first one is the tool unless another is chosen (`Robot.with_tool`)."""
    base: Base = "urdf"
    """`urdf`: the file as it is. `fixed`: a floating or planar joint of its root is held. `omni`, `differential`
    and `mecanum`: x, y and a continuous yaw under the root."""
    base_reach_m: float = REACH_M
    """Limits of x and y of a base, either way."""
    hold: Mapping[str, float] = field(default_factory=dict, hash=False)
    """Joints that stay where they are, at so many m or rad."""
    srdf: Path | None = None
    package_paths: tuple[Path, ...] = ()
    """Folders that meshes may lie in, beside the file's own."""
    compare: tuple[tuple[str, str], ...] = ()
    """Pairs of links that are compared although they are adjacent, always touch, or the SRDF leaves them out."""
    mesh_scale: float = 1.0
    """What all meshes are scaled by beside what the file says: 0.001 for meshes in mm."""
    spheres: bool | Path = True
    """Whether links get spheres; a file (cuRobo's, XRDF or SRDF): those that it has for links, and no others."""
    protrusion_m: float = 0.02
    """How far spheres may stand out of the shapes that they cover."""

    @property
    def tools(self) -> dict[str, str]:
        """Links by name, if several are named."""
        return {} if self.tool is None or isinstance(self.tool, str) else dict(self.tool)

    @property
    def first_tool(self) -> str | None:
        """The link that is asked for, the first of several; None if none is."""
        return next(iter(self.tools.values()), None) if self.tools else cast(str | None, self.tool)

    @property
    def drives(self) -> bool:
        """Whether a base that drives is put under the root."""
        return self.base not in ("urdf", "fixed")

    def __post_init__(self) -> None:
        if self.base not in get_args(Base):
            raise InputError(f"expected one of {', '.join(get_args(Base))}, got {quoted(self.base)}", ("base",))
        for key, unit in (("base_reach_m", " m"), ("protrusion_m", " m"), ("mesh_scale", "")):
            value = getattr(self, key)
            if not (is_number(value) and 0.0 < value <= MAX_MAGNITUDE):
                raise InputError(f"expected a number above 0, up to {MAX_MAGNITUDE:g}{unit}", (key,))
        _check_tool(self.tool)
        _check_hold(self.hold)
        check_pairs(self.compare)
        given = {"package_paths": read_folders(self.package_paths, "package_paths")}
        given |= {} if self.srdf is None else {"srdf": read_path(self.srdf, "srdf")}
        given |= {} if isinstance(self.spheres, bool) else {"spheres": read_path(self.spheres, "spheres")}
        for key, paths in given.items():
            object.__setattr__(self, key, paths)  # texts are paths as well


def _check_tool(tool: object) -> None:
    """Raise `InputError` unless this is nothing, a link, or links by name."""
    named = tool.items() if isinstance(tool, Mapping) else [("tool", tool)]
    are_names = all(isinstance(text, str) and text for pair in named for text in pair)
    if tool is not None and not (are_names and named):
        raise InputError(f"expected a link, or links by name, got {quoted(tool)}", ("tool",))


def _check_hold(hold: object) -> None:
    """Raise `InputError` unless these are values by joint."""
    if not isinstance(hold, Mapping):
        raise InputError(f"expected values by joint, such as {{'grip': 0.02}}, got {quoted(hold)}", ("hold",))
    for name, value in hold.items():
        if not (isinstance(name, str) and is_number(value)):
            raise InputError(f"expected a number by the name of a joint, got {quoted(value)}", ("hold", str(name)))


def read_folders(folders: object, where: str) -> tuple[Path, ...]:
    """Paths of folders; raises `InputError` for what are none, a single one among them."""
    if isinstance(folders, str | PathLike) or not isinstance(folders, Iterable):
        raise InputError(f"expected paths of folders, such as ['meshes'], got {quoted(folders)}", (where,))
    return tuple(read_path(folder, where) for folder in folders)


def read_holds(words: Iterable[str]) -> dict[str, float]:
    """Joints and values out of `NAME=VALUE`; raises `InputError` for anything else."""
    held: dict[str, float] = {}
    for word in words:
        name, _, value = word.rpartition("=")
        try:
            held[name] = float(value)
        except ValueError:
            name = ""
        if not name:
            raise InputError(f"expected JOINT=VALUE, in m or rad, got {quoted(word)}", ("hold",))
    return held


def read_tools(words: Iterable[str]) -> str | dict[str, str] | None:
    """A link, or links by name out of `NAME=LINK`; raises `InputError` for several links without names."""
    given = list(words)
    if len(given) <= 1 and "=" not in "".join(given):
        return given[0] if given else None
    tools: dict[str, str] = {}
    for word in given:
        name, _, link = word.partition("=")
        if not (name and link) or name in tools:
            raise InputError(f"expected NAME=LINK, each name once, got {quoted(word)}", ("tool",))
        tools[name] = link
    return tools


def read_pairs(words: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Pairs of links out of `A:B`; raises `InputError` for anything else."""
    pairs = []
    for word in words:
        a, colon, b = word.partition(":")
        if not (a and colon and b):
            raise InputError(f"expected LINK:LINK, got {quoted(word)}", ("compare",))
        pairs.append((a, b))
    return tuple(pairs)


def check_pairs(pairs: Iterable[tuple[str, str]]) -> tuple[tuple[str, str], ...]:
    """Pairs of names as they are; raises `InputError` for anything else, a text among them."""
    checked = []
    for pair in pairs if isinstance(pairs, Iterable) else [pairs]:
        is_pair = not isinstance(pairs, str) and isinstance(pair, tuple | list) and len(pair) == 2
        if not is_pair or not all(isinstance(name, str) for name in pair):
            raise InputError(f"expected pairs of links, such as [('base', 'hand')], got {quoted(pair)}", ("compare",))
        checked.append((pair[0], pair[1]))
    return tuple(checked)
