"""Sets of planning problems as MotionBenchMaker writes them: a scene file, and a request file beside it."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from ikde.errors import FileError, InputError
from ikde.formats.error_path import prefix_errors
from ikde.formats.reading import read_bytes
from ikde.io.scene_values import as_list, as_mapping, as_name, as_number, get
from ikde.io.yaml_file import read_yaml

SCENE = re.compile(r"scene(.*\.(?:ya?ml|json))")
MAX_PAIRS = 100_000  # of a folder


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenePair:
    """A scene and its request."""

    family: str
    """The folder, relative to that of the set."""
    name: str
    scene: Path
    request: Path

    @property
    def digest(self) -> str:
        """SHA-256 of both files' bytes, hex."""
        return sha256(b"\0".join(sha256(read_bytes(path)).digest() for path in (self.scene, self.request))).hexdigest()


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked of the joints, by name, m and rad, in no order."""

    start: Mapping[str, float]
    goal: Mapping[str, float]


def find_pairs(folder: Path) -> dict[str, list[ScenePair]]:
    """Family -> its pairs, each in order of names: files `scene*.yaml` with `request*.yaml` beside them, at any depth.

    Raises:
        FileError: for a folder that cannot be read or holds none, and for a scene without its request.
    """
    families: dict[str, list[ScenePair]] = {}
    try:
        for scene, rest in _list_scenes(folder):
            request = scene.with_name(f"request{rest}")
            if not request.is_file():
                raise FileError(scene, f"has no {request.name} beside it, which would say what is asked in it")
            family = scene.parent.relative_to(folder).as_posix()
            family = folder.resolve().name if family == "." else family.removeprefix("problems/")
            pair = ScenePair(family=family, name=f"{family}/{scene.stem}", scene=scene, request=request)
            families.setdefault(family, []).append(pair)
    except OSError as error:
        raise FileError(folder, f"cannot be read: {error.strerror or error}") from None
    if not families:
        raise FileError(folder, "holds no scene*.yaml with a request*.yaml beside it")
    return families


def _list_scenes(folder: Path) -> Iterator[tuple[Path, str]]:
    """Scenes and what their names and those of their requests share."""
    if not folder.is_dir():
        raise FileError(folder, "expected a folder of scenes and requests")
    found = sorted(path for path in folder.rglob("scene*") if SCENE.fullmatch(path.name))
    if len(found) > MAX_PAIRS:
        raise FileError(folder, f"holds {len(found):,} scenes; expected at most {MAX_PAIRS:,}")
    for path in found:
        yield path, path.name.removeprefix("scene")


def read_request(path: Path) -> Request:
    """Where joints are at first, and where they should go; raises `FileError` where that is not said."""
    document = read_yaml(path)
    try:
        data = as_mapping(document.data)
        return Request(start=_read_start(data), goal=_read_goal(data))
    except FileError:
        raise
    except InputError as error:
        raise document.error(error.message, error.where) from None


def _read_start(data: Mapping[str, Any]) -> dict[str, float]:
    with prefix_errors("start_state", "joint_state"):
        state = as_mapping(as_mapping(data.get("start_state")).get("joint_state"))
        names, values = as_list(state.get("name")), as_list(state.get("position"))
        if len(names) != len(values):
            raise InputError(f"{len(names)} names, but {len(values)} positions")
        return {as_name(name): as_number(value) for name, value in zip(names, values, strict=True)}


def _read_goal(data: Mapping[str, Any]) -> dict[str, float]:
    with prefix_errors("goal_constraints"):
        goals = as_list(data.get("goal_constraints"))
        if len(goals) != 1:
            raise InputError(f"expected one goal, got {len(goals)}")
        with prefix_errors(0, "joint_constraints"):
            found: dict[str, float] = {}
            for place, entry in enumerate(as_list(as_mapping(goals[0]).get("joint_constraints"))):
                with prefix_errors(place):
                    name = as_name(get(as_mapping(entry), "joint_name"))
                    if name in found:
                        raise InputError(f"{name!r} is asked twice", ("joint_name",))
                    with prefix_errors("position"):
                        found[name] = as_number(get(as_mapping(entry), "position"))
            if not found:
                raise InputError("expected the goal's joint values: a goal of another kind is not read")
            return found
