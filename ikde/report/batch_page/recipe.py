"""What ran, on what, and how to do it again."""

import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from ikde.batch.manifest import ArmFacts, Manifest
from ikde.report.batch_page.answers import RunAnswers
from ikde.report.markup import verbatim
from ikde.report.page import Block, Code, Column, Facts, Section, Table

BY_JOINT = ("ranges", "near", "weights")  # what is said of each joint, by its name
UNITS = ("m", "rad", "s")


def make_recipe(run: RunAnswers) -> Section:
    """Robot, targets, arms and what differs between them, machine and versions."""
    manifest = run.manifest
    arms = {arm.name: dict(_flatten(_describe(manifest, arm))) for arm in manifest.arms}
    for settings in arms.values():
        if settings.get("settings: method") == settings.get("method"):
            settings.pop("settings: method", None)  # it is one and the same
    keys = list(dict.fromkeys(key for settings in arms.values() for key in settings))
    differing = [key for key in keys if len({settings.get(key) for settings in arms.values()}) > 1]
    blocks: list[Block] = [_state_facts(run)]
    if len(arms) > 1:
        blocks.append(_compare(arms, differing))
    first = next(iter(arms.values()))
    blocks.append(_list_settings({key: first[key] for key in keys if key not in differing}, len(arms)))
    return Section("What ran", tuple(blocks), anchor="recipe")


def _describe(manifest: Manifest, arm: ArmFacts) -> Mapping[str, Any]:
    """Everything about an arm: from the recipe, or what the manifest knows of any arm."""
    known = manifest.recipe.get("arms", {}).get(arm.name)
    return known or {"method": arm.method, "detector": arm.detector, "settings": arm.settings}


def _state_facts(run: RunAnswers) -> Facts:
    manifest, machine = run.manifest, run.manifest.machine
    again, solves = sum(arm.verified.total for arm in run.arms), sum(arm.solves for arm in run.arms)
    detectors = f", detectors {', '.join(manifest.graders)}: all reached" if manifest.graders else ""
    kind = ", ".join(name for name in manifest.recipe.get("targets", {}) if name != "units")
    facts = (
        ("robot", manifest.robot),
        ("targets", f"{manifest.targets:,}{f' ({kind})' if kind else ''}"),
        ("solves of a target", f"{manifest.repeats:,}"),
        ("seed", str(manifest.seed)),
        ("graded again by", f"plain numpy: {again:,} of {solves:,}{detectors}"),
        ("run file", manifest.file or "none, made in Python"),
        ("started", manifest.started),
        ("machine", f"{machine.get('processor')}, {machine.get('cores')} cores, {machine.get('system')}"),
        ("versions", ", ".join(f"{name} {version}" for name, version in manifest.versions.items())),
        ("recipe", manifest.hash),
    )
    return Facts(tuple((name, verbatim(value)) for name, value in facts))


def _compare(arms: Mapping[str, Mapping[str, str]], differing: list[str]) -> Table:
    return Table(
        columns=tuple(Column(title, align="left") for title in ("setting", *arms)),
        rows=tuple((_name(key), *(settings.get(key, "–") for settings in arms.values())) for key in differing),
        caption="What differs between the arms",
        note="" if differing else "Nothing: only their names do.",
    )


def _list_settings(settings: Mapping[str, str], arms: int) -> Table:
    return Table(
        columns=Column.of("setting", "value"),
        rows=tuple((_name(key), value) for key, value in settings.items()),
        caption="What all arms have in common" if arms > 1 else "How it was solved",
        note="Lengths in m, angles in rad; joints in the robot's own convention.",
    )


def _name(key: str) -> str:
    """`settings: position_tolerance_m` as `position tolerance [m]`; names of joints stay as they are."""
    above, _, name = key.removeprefix("settings: ").rpartition(": ")
    if above not in BY_JOINT:
        words = name.split("_")
        unit = f" [{words.pop()}]" if len(words) > 1 and words[-1] in UNITS else ""
        name = " ".join(words) + unit
    return f"{above}: {name}" if above else name


def _flatten(data: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, str]]:
    """Leaves with their keys: `detector: pairs`; a detector that keeps nothing apart and a range each in a line."""
    for key, value in data.items():
        if isinstance(value, Mapping):
            yield from _flatten(value, f"{above}{key}: ")
        else:
            yield f"{above}{key}", _show(value)


def _show(value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list | tuple) and len(value) == 2:
        return " to ".join(map(_show, value))
    return str(value)


def make_again(run: RunAnswers) -> Section:
    """The commands that make run and page again, and the answers in pyarrow and three other libraries."""
    folder = str(run.folder)
    commands = [*([run_command(run)] if run.manifest.file else []), f"ikde report {shlex.quote(folder)}"]
    return Section(
        "Do it again, read on",
        (
            Code("\n".join(commands), caption="To make answers and page again; the same recipe gives the same bits."),
            Code(_read(folder), caption="To read the answers; times stand in `read_batch(..., timing=True)`."),
            Code(_read_on(folder), caption="The same in other libraries, which ikde does not install"),
        ),
        anchor="again",
    )


def run_command(run: RunAnswers) -> str:
    """What makes the answers again; the name of a file is no option, whatever it begins with."""
    file = run.manifest.file or ""
    held = [] if run.manifest.attach is None else [f"--attach={run.manifest.attach}"]
    return shlex.join(["ikde", "batch", f"./{file}" if file.startswith("-") else file, *held, "--out", str(run.folder)])


def _read(folder: str) -> str:
    return "\n".join(
        (
            "import ikde",
            "",
            f"answers = ikde.read_batch({folder!r})  # a pyarrow table, a row a solve",
            'print(answers.group_by("arm").aggregate([("reached", "mean")]).to_pylist())',
        )
    )


def _read_on(folder: str) -> str:
    files = f"{folder}/solutions/*.parquet".replace("'", "''")
    query = f"select arm, avg(reached::int) from '{files}' group by arm"
    return "\n".join(
        (
            "import duckdb, ikde, pandas, polars",
            "",
            f"frame = ikde.read_batch({folder!r}).to_pandas()",
            f"frame = polars.from_arrow(ikde.read_batch({folder!r}))",
            f"duckdb.sql({query!r})",
        )
    )
