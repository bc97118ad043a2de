"""What the papers print, and where the print is wrong: data that ships with ikde, read once."""

from functools import cache
from pathlib import Path
from typing import Any

from ikde.io.yaml_file import read_yaml

FOLDER = Path(__file__).parent.parent / "bench"


@cache
def load_published() -> dict[str, Any]:
    """Printed numbers of [Qiao2021] by table, formula and section (`bench/qiao2021.yaml` says how they are written)."""
    return dict(read_yaml(FOLDER / "qiao2021.yaml").data or {})


@cache
def load_misprints() -> list[dict[str, str]]:
    """Misprints and puzzles: paper, kind, place, printed, meant, evidence; the entries of docs/misprints.md."""
    return list(read_yaml(FOLDER / "misprints.yaml").data or [])
