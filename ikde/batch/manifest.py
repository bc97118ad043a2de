"""The manifest of a run: recipe, what it was started on, and the parts to expect. Written before anything else.

A run may come from anywhere: everything in it is checked, and nothing in its folder may be a link.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, ConfigDict, Field, StringConstraints, TypeAdapter, ValidationError

from ikde.batch.machine import describe_machine, describe_versions
from ikde.batch.parts import MAX_PARTS, PLAIN_NAME, SOLUTIONS, TIMING, Part, list_parts
from ikde.batch.plan import Arm, Batch
from ikde.batch.spec import MAX_ARMS, MAX_GRADERS
from ikde.errors import FileError, format_path, quoted
from ikde.formats.atomic import replace_all
from ikde.formats.entries import Count
from ikde.formats.reading import read_json

MANIFEST = "manifest.json"
REPORT = "report"  # where `ikde report` puts its page
REPORT_FILES = ("report.html", "report.md")
FORMAT = "ikde batch 3"
EARLIER = ("ikde batch 1", "ikde batch 2")  # with other columns: a pair was one word, a verdict was never null
SHOWN = 3  # differences that are spelt out

PlainName = Annotated[str, StringConstraints(pattern=f"^{PLAIN_NAME.pattern}$")]


def _check_recipe(recipe: Mapping[str, Any]) -> Mapping[str, Any]:
    arms, targets = recipe.get("arms", {}), recipe.get("targets", {})
    if not (isinstance(targets, dict) and isinstance(arms, dict) and all(isinstance(a, dict) for a in arms.values())):
        raise ValueError("arms and targets of a recipe are mappings")
    return recipe


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmFacts:
    """An arm as the manifest knows it."""

    __pydantic_config__ = ConfigDict(extra="forbid")
    name: PlainName
    method: str
    detector: str
    settings: Mapping[str, Any]
    world: str | None = None
    """The name of the world that it solves in, if the run has any."""
    world_file: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What stands in `manifest.json`."""

    __pydantic_config__ = ConfigDict(extra="forbid")
    format: str
    name: str
    hash: str
    recipe: Annotated[Mapping[str, Any], AfterValidator(_check_recipe)]
    file: str | None
    robot: str
    arms: Annotated[tuple[ArmFacts, ...], Field(min_length=1, max_length=MAX_ARMS)]
    graders: Annotated[tuple[PlainName, ...], Field(max_length=MAX_GRADERS)]
    targets: Count
    repeats: Count
    solves: Count
    """Of one arm."""
    seed: int
    chunk: Count
    """Solves a part."""
    parts: Annotated[int, Field(ge=1, le=MAX_PARTS)]
    """Of all arms."""
    started: str
    """UTC, ISO 8601."""
    versions: Mapping[str, str]
    machine: Mapping[str, Any]
    attach: str | None = None
    """What was picked up beside what the file says, as it was typed."""

    @property
    def has_worlds(self) -> bool:
        """Whether answers say in which world they are."""
        return any(arm.world is not None for arm in self.arms)

    def world_of(self, name: str) -> str | None:
        """The world of an arm."""
        return next(arm.world for arm in self.arms if arm.name == name)

    def list_parts(self) -> Iterator[Part]:
        """All parts, finished or not, in the order of the answers."""
        return list_parts([arm.name for arm in self.arms], self.solves, self.chunk)


def make_manifest(batch: Batch) -> Manifest:
    """The manifest of a run that starts now, here."""
    arms = tuple(map(_describe_arm, batch.arms))
    return Manifest(
        format=FORMAT,
        name=batch.name,
        hash=batch.hash,
        recipe=batch.recipe,
        file=batch.file,
        robot=batch.robot.name,
        arms=arms,
        graders=tuple(grader.name for grader in batch.graders),
        targets=batch.source.count,
        repeats=batch.repeats,
        solves=batch.solves,
        seed=batch.seed,
        chunk=batch.chunk,
        parts=len(arms) * -(-batch.solves // batch.chunk),
        started=datetime.now(UTC).isoformat(timespec="seconds"),
        versions=describe_versions(),
        machine=describe_machine(),
        attach=batch.attach,
    )


def _describe_arm(arm: Arm) -> ArmFacts:
    detector, settings = arm.problem.collision.name, asdict(arm.problem.settings)
    place = {"world": arm.world, "world_file": arm.world_file}
    return ArmFacts(name=arm.name, method=arm.method, detector=detector, settings=settings, **place)


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write it whole or not at all; raises `FileError`."""
    text = json.dumps(asdict(manifest), indent=1, ensure_ascii=False, allow_nan=False)
    replace_all(folder, {MANIFEST: text.encode()})


def refuse_links(folder: Path, *names: str) -> None:
    """Raise `FileError` for a link: what stands behind it is not the run's."""
    for name in names:
        if (folder / name).is_symlink():
            raise FileError(folder / name, "is a symbolic link; a run holds none")


def read_manifest(folder: Path) -> Manifest:
    """Read the manifest of a run; raises `FileError` for a folder without one, or with links."""
    refuse_links(folder, MANIFEST, SOLUTIONS, TIMING)
    try:
        data = read_json(folder / MANIFEST, follow=False)
    except FileError as error:
        raise FileError(folder, f"holds no run of ikde: {MANIFEST}: {error.message}") from None
    if isinstance(data, dict) and data.get("format") in EARLIER:
        # Columns of another format mean something else: parts of both must not be mixed.
        message = f"holds a run of an earlier ikde ({data['format']!r}, expected {FORMAT!r}); name another folder"
        raise FileError(folder, message)
    try:
        manifest = TypeAdapter(Manifest).validate_python(data)
    except ValidationError as error:
        where = format_path(error.errors()[0]["loc"]) or "all of it"
        raise FileError(folder, f"holds no run of ikde: its {MANIFEST} was not written by ikde ({where})") from None
    names = [arm.name for arm in manifest.arms]
    parts = len(names) * -(-manifest.solves // manifest.chunk)
    if (
        manifest.format != FORMAT
        or (manifest.solves, manifest.parts) != (manifest.targets * manifest.repeats, parts)
        or len(set(names)) < len(names)
    ):
        raise FileError(folder, f"holds no run of ikde: its {MANIFEST} was not written by ikde, or contradicts itself")
    return manifest


def describe_difference(there: Any, now: Any) -> str:
    """The first keys in which two recipes differ: `settings.strategy: 'rand/1' there, 'best/1' now`."""
    old, new = dict(_flatten(there)), dict(_flatten(now))
    keys = [key for key in {**old, **new} if key not in old or key not in new or old[key] != new[key]]
    lines = [f"{format_path(key)}: {_show(key, old)} there, {_show(key, new)} now" for key in keys[:SHOWN]]
    more = [f"and {len(keys) - SHOWN} more"] if len(keys) > SHOWN else []
    return "; ".join([*lines, *more])


def _flatten(data: Any, where: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Every leaf with its path."""
    if not isinstance(data, Mapping | list | tuple) or not data:
        yield where, data
        return
    for key, value in data.items() if isinstance(data, Mapping) else enumerate(data):
        yield from _flatten(value, (*where, key))


def _show(key: Any, leaves: Mapping[Any, Any]) -> str:
    return quoted(leaves[key]) if key in leaves else "nothing"
