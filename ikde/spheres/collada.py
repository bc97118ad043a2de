"""What a DAE shows, counted before another reads it, so that no part of it is missing afterwards."""

from collections.abc import Iterator
from xml.etree.ElementTree import Element

MAX_INSTANCES = 5_000
"""Of nodes and geometries: nodes that name others multiply."""
MAX_LEVELS = 100
ODD = ("skew", "lookat")
"""Places of nodes that are not read."""
PRIMITIVES = ("triangles", "tristrips", "trifans", "polygons", "polylist")
Nodes = dict[str, Element]


def count_triangles(root: Element) -> int:
    """How many triangles its scene shows.

    Raises:
        ValueError: in words, for what is not read or multiplies beyond all measure.
    """
    known = {identity: element for element in root.iter() if (identity := element.get("id"))}
    counts: dict[str, int] = {}
    return sum(_count_geometry(known, url, counts) for url in _walk(known, root))


def _name(element: Element) -> str:
    return element.tag.rpartition("}")[2]


def _find(known: Nodes, url: str, kind: str) -> Element:
    """What a URL inside the file leads to."""
    found = known.get(url.removeprefix("#"))
    if not url.startswith("#") or found is None or _name(found) != kind:
        raise ValueError(f"no {kind} is called {url[:60]!r} in it")
    return found


def _walk(known: Nodes, root: Element) -> Iterator[str]:
    """URLs of the geometries that the scene shows, each as often as it does."""
    scenes = [element for element in root.iter() if _name(element) == "instance_visual_scene"]
    shown = [_find(known, element.get("url", ""), "visual_scene") for element in scenes[:1]]
    waiting = [(node, 1, False) for scene in shown for node in scene if _name(node) == "node"]
    for _ in range(MAX_INSTANCES):
        if not waiting:
            return
        element, level, is_odd = waiting.pop()
        if level > MAX_LEVELS:
            raise ValueError(f"its nodes are nested too deeply; expected at most {MAX_LEVELS} levels")
        is_odd = is_odd or any(_name(child) in ODD for child in element)
        for child in element:
            name, url = _name(child), child.get("url", "")
            if name == "node":
                waiting.append((child, level + 1, is_odd))
            elif name == "instance_node":
                waiting.append((_find(known, url, "node"), level + 1, is_odd))
            elif name == "instance_controller":
                raise ValueError("it has a skin or a morph, which is not read")
            elif name == "instance_geometry":
                if is_odd:
                    raise ValueError(f"a place by {' or '.join(ODD)} is not read")
                yield url
    if waiting:
        raise ValueError(f"it shows too much; expected at most {MAX_INSTANCES:,} nodes")


def _count_geometry(known: Nodes, url: str, counts: dict[str, int]) -> int:
    if url not in counts:
        parts = [part for part in _find(known, url, "geometry") if _name(part) not in ("asset", "extra")]
        if [_name(part) for part in parts] != ["mesh"]:
            raise ValueError(f"the geometry {url[:60]!r} is no mesh")
        counts[url] = sum(_count_primitive(known, part) for part in parts[0])
    return counts[url]


def _count_primitive(known: Nodes, part: Element) -> int:
    """Triangles of one primitive, and of nothing else."""
    name = _name(part)
    if name == "vertices":
        _check_places(known, part)
    if name not in PRIMITIVES:
        return 0
    if any(_name(child) == "ph" for child in part):
        raise ValueError("polygons with holes are not read")
    inputs = [child for child in part if _name(child) == "input"]
    stride = 1 + max((_read(child.get("offset", "0")) for child in inputs), default=0)
    lists = [_read_corners(child, stride) for child in part if _name(child) == "p"]
    if name == "triangles":
        return sum(corners // 3 for corners in lists)
    if name == "polylist":
        lists = [_read(word) for child in part if _name(child) == "vcount" for word in _words(child)]
    return sum(max(0, corners - 2) for corners in lists)


def _check_places(known: Nodes, vertices: Element) -> None:
    """Raise unless corners stand in their source as x, y, z after one another, from the first number on."""
    for child in vertices:
        if child.get("semantic") != "POSITION":
            continue
        source = _find(known, child.get("source", ""), "source")
        for accessor in (element for element in source.iter() if _name(element) == "accessor"):
            names = [param.get("name", "") for param in accessor if _name(param) == "param"]
            if accessor.get("offset", "0") != "0" or accessor.get("stride", "1") != "3" or names != ["X", "Y", "Z"]:
                raise ValueError("expected corners as X, Y and Z, one after the other")


def _words(element: Element) -> list[str]:
    return (element.text or "").split()


def _read_corners(element: Element, stride: int) -> int:
    """How many corners a list of indices has; raises `ValueError` for one below 0, which would count from the end."""
    if "-" in (element.text or ""):
        raise ValueError("expected indices of at least 0")
    return len(_words(element)) // stride


def _read(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"expected a number, got {text[:60]!r}") from None
