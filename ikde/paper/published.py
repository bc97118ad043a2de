"""What the papers print, and where the print is wrong: data that ships with ikde, read once."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from ikde.io.yaml_file import read_yaml

FOLDER = Path(__file__).parent
APPROXIMATIONS: tuple[str, ...] = ("typical", "improved")
PAIR_LISTS: tuple[str, ...] = ("formula_22", "formula_22_printed", "non_adjacent")


@cache
def load_published() -> dict[str, Any]:
    """Printed numbers of [Qiao2021] by table, formula and section (`qiao2021.yaml` says how they are written)."""
    return dict(read_yaml(FOLDER / "qiao2021.yaml").data or {})


@cache
def load_misprints() -> list[dict[str, str]]:
    """Misprints and puzzles: paper, kind, place, printed, meant, evidence; the entries of docs/misprints.md."""
    return list(read_yaml(FOLDER / "misprints.yaml").data or [])


def meant(entry: Mapping[str, Any]) -> dict[str, Any]:
    """A published entry as it was meant: its misprint, if it has one, put right."""
    return {**entry, **entry.get("misprint", {})}
