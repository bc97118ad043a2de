"""What cuRobo's robot files and XRDF say beside spheres: pairs that are ignored, and a home."""

from typing import Any

from ikde.errors import printable
from ikde.io.srdf import DisabledPair, Srdf
from ikde.io.yaml_file import Document, Where
from ikde.model.numbers import is_number
from ikde.model.robot import MAX_MAGNITUDE

Section = dict[Any, Any]


def read_ignored(document: Document, data: Section, where: Where) -> Srdf:
    """Pairs and home of a section of cuRobo's file, or of a whole XRDF, whose `where` is empty.

    Raises:
        FileError: for pairs that are no lists of names, and values that are no numbers, with line and key.
    """
    inner, key = ("self_collision", "ignore") if "format" in data else (None, "self_collision_ignore")
    section = data.get(inner) if inner else data
    section_where = (*where, inner) if inner else where
    ignored = section.get(key) if isinstance(section, dict) else None
    disabled = () if ignored is None else _read_pairs(document, ignored, (*section_where, key))
    home = _read_home(document, data, where)
    return Srdf(
        states=(("", "home", home),) if home else (),
        disabled=disabled,
        is_whole=ignored is not None,
        source=printable(document.path.name),
    )


def _read_pairs(document: Document, ignored: Any, where: Where) -> tuple[DisabledPair, ...]:
    """`{link: [links]}`."""
    if not isinstance(ignored, dict):
        raise document.error("expected links with lists of links", where)
    pairs = []
    for a, others in ignored.items():
        named: list[Any] = [a, *(others or ())] if isinstance(others, list | None) else [None]
        if not all(isinstance(name, str) for name in named):
            raise document.error("expected links with lists of links", where)
        pairs += [DisabledPair(a=named[0], b=b, reason="ignored") for b in named[1:]]
    return tuple(pairs)


def _read_home(document: Document, data: Section, where: Where) -> dict[str, float]:
    """Values by joint; none unless the file has a home for joints that it names."""
    given = data.get("default_joint_positions")
    if isinstance(given, dict):
        names, values, key = list(given), list(given.values()), (*where, "default_joint_positions")
    else:
        cspace = data.get("cspace")
        names, values = (
            (cspace.get(key) for key in ("joint_names", "retract_config")) if isinstance(cspace, dict) else (None, None)
        )
        key = (*where, "cspace", "retract_config")
    if not isinstance(names, list) or not isinstance(values, list):
        return {}
    are_good = all(is_number(value) and abs(value) <= MAX_MAGNITUDE for value in values)  # not for NaN
    if len(names) != len(values) or not are_good:
        raise document.error(f"expected {len(names)} numbers within {MAX_MAGNITUDE:g} of 0, one a joint", key)
    return {name: float(value) for name, value in zip(names, values, strict=True) if isinstance(name, str)}
