"""The manifest of a run: recipe, what it was started on, and the parts to expect. Written before anything else."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from ikde.batch.machine import describe_machine, describe_versions
from ikde.batch.parts import PLAIN_NAME, Part, list_parts
from ikde.batch.plan import Batch
from ikde.errors import FileError, format_path, quoted
from ikde.files.atomic import write_atomically

MANIFEST = "manifest.json"
REPORT = "report"  # where `ikde report` puts its page
REPORT_FILES = ("report.html", "report.md")
FORMAT = "ikde batch 2"
EARLIER = ("ikde batch 1",)  # `verified` was true where nothing had graded, and there was no `self_collision`
SHOWN = 3  # differences that are spelt out


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmFacts:
    """An arm as the manifest knows it."""

    name: str
    method: str
    detector: str
    settings: Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What stands in `manifest.json`."""

    format: str
    name: str
    hash: str
    recipe: Mapping[str, Any]
    file: str | None
    robot: str
    arms: tuple[ArmFacts, ...]
    graders: tuple[str, ...]
    targets: int
    repeats: int
    solves: int
    """Of one arm."""
    seed: int
    chunk: int
    """Solves a part."""
    parts: int
    """Of all arms."""
    started: str
    """UTC, ISO 8601."""
    versions: Mapping[str, str]
    machine: Mapping[str, Any]

    def list_parts(self) -> Iterator[Part]:
        """All parts, finished or not, in the order of the answers."""
        return list_parts([arm.name for arm in self.arms], self.solves, self.chunk)


def make_manifest(batch: Batch) -> Manifest:
    """The manifest of a run that starts now, here."""
    arms = tuple(
        ArmFacts(
            name=arm.name,
            method=arm.method,
            detector=arm.problem.detector.name if arm.problem.detector else "none",
            settings=asdict(arm.problem.settings),
        )
        for arm in batch.arms
    )
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
    )


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write it whole or not at all; raises `FileError`."""
    path = folder / MANIFEST
    text = json.dumps(asdict(manifest), indent=1, ensure_ascii=False, allow_nan=False)
    try:
        write_atomically(path, text.encode())
    except OSError as error:
        raise FileError(path, f"cannot be written: {error.strerror}") from None


def read_manifest(folder: Path) -> Manifest:
    """Read the manifest of a run; raises `FileError` for a folder that holds none of this format."""
    try:
        data = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        if data["format"] != FORMAT:
            raise _refuse_format(folder, data["format"])
        arms = tuple(ArmFacts(**arm) for arm in data.pop("arms"))
        if not all(PLAIN_NAME.fullmatch(arm.name) for arm in arms):  # they name the files that are read
            raise ValueError(arms)
        return Manifest(arms=arms, graders=tuple(data.pop("graders")), **data)
    except OSError as error:
        raise FileError(folder, f"holds no run of ikde: {MANIFEST}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise FileError(folder, f"holds no run of ikde: its {MANIFEST} is none of ours") from None


def _refuse_format(folder: Path, found: Any) -> Exception:
    """Columns of another format mean something else: parts of both must not be mixed."""
    if found not in EARLIER:
        return ValueError(found)
    return FileError(folder, f"holds a run of an earlier ikde ({found!r}, expected {FORMAT!r}); name another folder")


def describe_difference(there: Any, now: Any) -> str:
    """The first keys in which two recipes differ: `settings.strategy: 'rand/1' there, 'best/1' now`."""
    old, new = dict(_flatten(there)), dict(_flatten(now))
    keys = [key for key in {**old, **new} if key not in old or key not in new or old[key] != new[key]]
    lines = [f"{format_path(key)}: {_show(old, key)} there, {_show(new, key)} now" for key in keys[:SHOWN]]
    more = [f"and {len(keys) - SHOWN} more"] if len(keys) > SHOWN else []
    return "; ".join([*lines, *more])


def _flatten(data: Any, where: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """Every leaf with its path."""
    if not isinstance(data, Mapping | list | tuple) or not data:
        yield where, data
        return
    for key, value in data.items() if isinstance(data, Mapping) else enumerate(data):
        yield from _flatten(value, (*where, key))


def _show(leaves: Mapping[Any, Any], key: Any) -> str:
    if key not in leaves:
        return "nothing"
    return quoted(leaves[key])
