"""Tables of ikde beside other solvers, from what benchmarks/peers recorded: one case a table, one number a cell."""

from collections.abc import Sequence
from typing import Any

from track_tables import make_head, make_row

Record = dict[str, Any]
CASES = ("pose", "hard pose", "position", "hard position", "paper task 1", "paper task 2")
ARM_CASES = ("ur5 pose", "ur5 hard pose", "pose", "hard pose")
ENOUGH = {"median": 1, "p95": 20, "p99": 100, "max": 1, "mean": 1}  # targets of a round that a figure asks for


def format_peers(record: Record, cases: Sequence[str], adapters: str) -> str:
    """Other solvers beside ikde, a table a case, a row a solver, quickest first."""
    options = record["options"]
    position, orientation = options["tolerance"]
    parts = [
        f"ikde beside other solvers, interleaved, one core each, tolerances {position:g} m and {orientation:g} rad, "
        "limits and self-collision inside success, every answer graded by plain numpy; ms over all targets asked"
        f"{_format_rounds(options.get('rounds', 1))}, {options['limit']:g} s at most; slow solvers are asked fewer. "
        f"How each is used: [benchmarks/peers]({adapters}).",
    ]
    for case in cases:
        if rows := record["cases"].get(case):
            lines = [f"*{case}*:", "", *make_head(("solver", "asked", "solved", *ENOUGH))]
            lines += (make_row(name, *_list_cells(rows[name])) for name in _order(rows))
            parts.append("\n".join(lines))
    if record["missing"]:
        parts.append(f"Not installed: {', '.join(record['missing'])}.")
    return "\n\n".join(parts)


def format_ahead(record: Record) -> str:
    """In which figures of which cases another solver that solves as many is quicker than `ikde.solve`."""
    found = []
    for case, rows in record["cases"].items():
        ours = rows["ikde"]
        for name, row in rows.items():
            if (
                name.startswith("ikde")
                or "ms" not in row
                or row["solved"] * ours["asked"] < ours["solved"] * row["asked"]
            ):
                continue
            ahead = [key for key in ENOUGH if row["ms"][key] < ours["ms"][key]]
            found += [f"{name} on *{case}* ({', '.join(ahead)})"] if ahead else []
    return f"Quicker than `ikde` here: {'; '.join(found)}." if found else "None is quicker than `ikde` in any figure."


def format_arm(record: Record, adapters: str) -> str:
    """Peers that were added later, and cases of an arm on a fixed base."""
    machine = record["machine"]
    return "\n\n".join(
        (
            f"{machine['processor']}, Python {machine['python']}, numba {machine['numba']}; a shared machine.",
            format_peers(record, ARM_CASES, adapters),
            format_ahead(record),
        )
    )


def _format_rounds(rounds: int) -> str:
    return f", of each target the median of {rounds} rounds" if rounds > 1 else ""


def _order(rows: Record) -> list[str]:
    """Names by median time; those that could not be used are left out."""
    used = [name for name, row in rows.items() if "ms" in row]
    return sorted(used, key=lambda name: rows[name]["ms"]["median"])


def _list_cells(row: Record) -> list[str]:
    """Asked, solved, and the times; no percentile of too few targets."""
    asked = row["asked"] // row.get("rounds", 1)
    times = (format_ms(row["ms"][key]) if asked >= enough else "–" for key, enough in ENOUGH.items())
    return [f"{row['asked']:,}{', then stopped' if 'lost' in row else ''}", f"{row['solved']:,}", *times]


def format_ms(value: float) -> str:
    """Two digits, no exponent."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}" if rounded >= 10.0 else f"{rounded:g}" if rounded >= 1e-3 else f"{rounded:.4f}"
