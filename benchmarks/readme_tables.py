"""Write the README's tables from the recorded results, so that nobody types a figure.

python benchmarks/readme_tables.py
"""

import json
import re
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "benchmarks" / "results"
BLOCK = re.compile(r"(<!-- measured: [^>]*-->\n).*?(<!-- end measured -->)", re.DOTALL)


def load(name: str) -> dict[str, Any]:
    """One recorded result."""
    return json.loads((RESULTS / f"{name}.json").read_text())


def format_machine(machine: dict[str, Any]) -> str:
    """One line about what the figures were taken on."""
    return f"{machine['cpu']}, one core, Python {machine['python']}, numba {machine['numba']}"


def format_search(record: dict[str, Any]) -> str:
    """The paper's search, a row a cell."""
    lines = [
        "The paper's search (`--method de`) on its two targets, base within ±0.1 m, until a verified collision-free "
        "solution:",
        "",
        "| target, detector | solved | attempts median / p95 / max | ms median / p95 / max |",
        "|---|---|---|---|",
    ]
    for name, cell in record["cells"].items():
        attempts = " / ".join(f"{cell['attempts'][k]:.0f}" for k in ("median", "p95", "max"))
        times = " / ".join(f"{cell['milliseconds'][k]:.0f}" for k in ("median", "p95", "max"))
        lines.append(f"| {name} | {cell['solved']:,} of {cell['seeds']:,} | {attempts} | {times} |")
    lines += ["", "The paper reports 1.67 to 1.94 s a solve for the collision detection alone (Table 4)."]
    return "\n".join(lines)


def format_kernels(record: dict[str, Any]) -> str:
    """Nanoseconds a configuration, a row a stage."""
    sets = record["ns"]
    lines = [
        "Nanoseconds a configuration in a kernel loop, improved spheres (36 spheres, 35 pairs of components), median "
        "[p95] over 25 rounds; each row includes the rows above it:",
        "",
        f"| stage | {' | '.join(sets)} |",
        f"|---|{'---|' * len(sets)}",
    ]
    for stage in next(iter(sets.values())):
        cells = [f"{sets[name][stage]['median']:.0f} [{sets[name][stage]['p95']:.0f}]" for name in sets]
        lines.append(f"| {stage} | {' | '.join(cells)} |")
    return "\n".join(lines)


def format_start(record: dict[str, Any]) -> str:
    """Start-up, a row a command."""
    lines = [
        "Whole processes, installed in a fresh environment:",
        "",
        "| command | wall s median / max | process s median / max |",
        "|---|---|---|",
    ]
    for name, row in record["commands"].items():
        wall = f"{row['wall_s']['median']:.2f} / {row['wall_s']['max']:.2f}"
        process = f"{row['process_s']['median']:.2f} / {row['process_s']['max']:.2f}"
        lines.append(f"| {name} | {wall} | {process} |")
    return "\n".join(lines)


def format_batch(record: dict[str, Any]) -> str:
    """Runs of `ikde batch`, a row a run."""
    lines = [
        "`ikde batch`, whole processes; a *blink* searches next to nothing (population 6, one generation), so its "
        "time is "
        "reading, grading by plain numpy, tabulating and writing; *de* is best/1 with 50 restarts, base within ±0.1 m:",
        "",
        "| run | targets | s | µs a target | of it search | peak MB | reached |",
        "|---|---|---|---|---|---|---|",
    ]
    for cell in record["cells"]:
        search = f"{cell['search_us_a_row']:.0f}" if "search_us_a_row" in cell else ""
        lines.append(
            f"| {cell['run']} | {cell['targets']:,} | {cell['wall_s']:.0f} | {cell['us_a_row']:.0f} | {search} | "
            f"{cell['peak_memory_mb']:.0f} | {cell['reached']:,} |"
        )
    return "\n".join(lines)


PEER_TABLES = (("pose", "hard pose"), ("position", "hard position"), ("paper task 1", "paper task 2"))


def format_peers(record: dict[str, Any]) -> str:
    """Other solvers beside ikde, a row a solver, quickest first; two cases a table."""
    options = record["options"]
    position, orientation = options["tolerance"]
    lines = [
        f"ikde beside other solvers, interleaved, one core each, tolerances {position:g} m and {orientation:g} rad, "
        "limits and self-collision inside success, every answer graded by plain numpy; ms over all targets asked, "
        f"median / p95 / p99 / max ({options['limit']:g} s at most). How each is used: "
        "[benchmarks/peers](benchmarks/peers/README.md).",
    ]
    for names in PEER_TABLES:
        cases = [name for name in names if name in record["cases"]]
        if cases:
            lines += ["", f"| solver | {' | '.join(cases)} |", f"|---|{'---|' * len(cases)}"]
            lines += [
                f"| {peer} | {' | '.join(format_peer(record['cases'][case].get(peer, {})) for case in cases)} |"
                for peer in order_peers(record["cases"][cases[0]])
            ]
    if record["missing"]:
        lines += ["", f"Not installed: {', '.join(record['missing'])}."]
    return "\n".join(lines)


def order_peers(rows: dict[str, Any]) -> list[str]:
    """Names by median time; those that could not be used are left out."""
    used = [name for name, row in rows.items() if "ms" in row]
    return sorted(used, key=lambda name: rows[name]["ms"]["median"])


def format_peer(row: dict[str, Any]) -> str:
    """One cell: how many were solved of how many, and the times."""
    if "ms" not in row:
        return "-"
    times = " / ".join(format_ms(row["ms"][key]) for key in ("median", "p95", "p99", "max"))
    share = f"{row['solved'] / row['asked']:.2%}".replace(".00", "")
    return f"{share} of {row['asked']:,}: {times}"


def format_ms(value: float) -> str:
    """Two digits, no exponent."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}" if rounded >= 10.0 else f"{rounded:g}" if rounded >= 1e-3 else f"{rounded:.4f}"


def make_block() -> str:
    """Everything between the README's markers."""
    search, kernels = load("paper_search"), load("kernel_times")
    note = "a shared virtual machine whose clock swings by a factor of 1.5, which is what p95 and max show"
    parts = [
        f"{format_machine(search['machine'])}; {note}.",
        format_search(search),
        format_kernels(kernels),
        format_batch(load("batch_scale")),
        format_start(load("start_up")),
    ]
    if (RESULTS / "peers.json").exists():
        parts.append(format_peers(load("peers")))
    return "\n\n".join(parts) + "\n"


def insert(readme: str) -> str:
    """The README with its block made anew."""
    return BLOCK.sub(lambda match: f"{match[1]}{make_block()}{match[2]}", readme)


if __name__ == "__main__":
    path = ROOT / "README.md"
    path.write_text(insert(path.read_text()))
