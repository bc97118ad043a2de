"""Write the tables of README.md, docs/speed.md and docs/following.md from what was recorded: nobody types a figure.

python benchmarks/readme_tables.py
"""

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from track_tables import (
    format_between,
    format_methods,
    format_peers_along,
    format_starts,
    format_stops,
    format_whole_paths,
)

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "benchmarks" / "results"
BLOCK = re.compile(r"(<!-- measured: [^>]*-->\n).*?(<!-- end measured -->)", re.DOTALL)


def load(name: str) -> dict[str, Any]:
    """One recorded result."""
    return json.loads((RESULTS / f"{name}.json").read_text())


def format_machine(machine: dict[str, Any]) -> str:
    """One line about what the figures were taken on."""
    clock = machine.get("empty_array_us")
    speed = f"; at that moment it took {clock:.2f} µs to make an empty array (0.1 where nothing slows it down)"
    return f"{machine['cpu']}, one core, Python {machine['python']}, numba {machine['numba']}{speed if clock else ''}"


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
        "`ikde batch` on targets that random collision-free configurations reach, all columns, every answer graded, "
        "the last 64 of each 4,096 by plain numpy as well; the median of interleaved rounds, s of whole processes, "
        "the other figures without their start:",
        "",
        "| run | targets | s | answers a second | µs a target | of it search | peak MB | reached | times one thread |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for cell in record["cells"]:
        gain = " / ".join(f"{gain:.2f}" for gain in sorted(cell.get("gains", ())))
        lines.append(
            f"| {cell['run']} | {cell['targets']:,} | {cell['wall_s']:.1f} | {cell['solutions_a_second']:,.0f} | "
            f"{cell['us_a_row']:.1f} | {cell['search_us_a_row']:.1f} | {cell['peak_memory_mb']:.0f} | "
            f"{cell['reached']:,} | {gain} |"
        )
    return "\n".join(lines)


def format_engines(record: dict[str, Any]) -> str:
    """One target at a time and in bulk, a row a set."""
    lines = [
        "`ikde.solve` and `ikde.solve_many` with default settings (1e-5 m, 1e-4 rad unless said otherwise), every "
        "answer graded; microseconds a target on one core. *Kernel*: a clock in compiled code around each target of "
        "the engine `lm`; *Python*: `ikde.solve` in a loop, with its result object and grade; *bulk*: `solve_many`. "
        "*Hard*: low targets of which at least nine answers in ten collide. Kernel and Python: for each target the "
        f"median of {record['rounds']} rounds. Of *bulk*, the grader takes {record['sets'][0]['grader_us']:.2f} µs:",
        "",
        "| set | reached | at 1e-9 m, rad | kernel median / p95 / p99 / max | Python median / p95 / p99 / max | bulk | "
        "bulk at 1e-6 |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in record["sets"]:
        times = [format_spread(row[key]) for key in ("kernel_us", "python_us")]
        tight, fine = row["1e-6 m, 1e-6 rad"], row["1e-9 m, 1e-9 rad"]
        name = f"{row['robot']}, {'hard ' if row['hard'] else ''}{row['kind']}"
        lines.append(
            f"| {name} | {row['reached']:,} of {row['targets']:,} | {fine['reached']:,} | {times[0]} | {times[1]} | "
            f"{row['bulk_us']:.2f} | {tight['bulk_us']:.2f} |"
        )
    return "\n".join(lines)


def format_spread(times: dict[str, float]) -> str:
    """Median and tails."""
    return " / ".join(three(times[key]) for key in ("median", "p95", "p99", "max"))


def three(value: float) -> str:
    """Three digits, no exponent."""
    return f"{float(f'{value:.3g}'):,.10g}"


def format_ablation(record: dict[str, Any]) -> str:
    """What each idea buys, a row a variant; then the width of the vectors."""
    columns = ("lanes us", "singly us", "attempts", "steps", "check all ns", "check free ns", "check lanes ns")
    lines = [
        f"{record['targets']:,} pose targets of qiao2021 at 1e-6 m and 1e-6 rad, inside compiled code; medians of "
        f"{record['rounds']} interleaved rounds. The checks are forward kinematics and yes/no self-collision on random "
        "(*all*) and on free configurations, one by one and in lanes:",
        "",
        "| variant | µs a target in lanes | one by one | attempts | steps | check ns, all | free | in lanes |",
        f"|---|{'---|' * len(columns)}",
    ]
    rows = dict(record["variants"])
    if "variants" in record["wide"]:
        rows["all ideas, vectors of 512 bits"] = record["wide"]["variants"]["all ideas"]
    for name, row in rows.items():
        lines.append(f"| {name} | {' | '.join(three(row[c]) if c in row else '' for c in columns)} |")
    widths = record["vectors"]["all ideas"]
    registers = ", ".join(f"`{name}` names ymm registers {found['ymm']:,} times" for name, found in widths.items())
    return "\n".join([*lines, "", f"In the machine code of what runs in lanes, {registers}."])


def format_memetic(record: dict[str, Any]) -> str:
    """Evaluations until solved, a row a method, a column a problem."""
    problems = record["problems"]
    lines = [
        f"Evaluations until solved, median / p95, over {next(iter(next(iter(problems.values())).values()))['targets']} "
        f"targets a problem, {record['settings']['budget']:,} at most; the share solved where it is not all of them:",
        "",
        f"| method | {' | '.join(problems)} |",
        f"|---|{'---|' * len(problems)}",
    ]
    for method in next(iter(problems.values())):
        lines.append(f"| {method} | {' | '.join(format_race(rows[method]) for rows in problems.values())} |")
    return "\n".join(lines)


def format_race(row: dict[str, Any]) -> str:
    """One cell."""
    share = "" if row["solved"] == row["targets"] else f" ({row['solved'] / row['targets']:.0%})"
    counts = (f"{row[key]:,.0f}" if row[key] is not None else "more" for key in ("median", "p95"))
    return f"{' / '.join(counts)}{share}"


PEER_TABLES = (("pose", "hard pose"), ("position", "hard position"), ("paper task 1", "paper task 2"))
ARM_TABLES = (("ur5 pose", "ur5 hard pose"), ("pose", "hard pose"))
ENOUGH = {"median": 1, "p95": 20, "p99": 100, "max": 1, "mean": 1}  # targets of a round that a figure asks for


def format_peers(record: dict[str, Any], tables: Sequence[tuple[str, str]], adapters: str) -> str:
    """Other solvers beside ikde, a row a solver, quickest first; two cases a table."""
    options = record["options"]
    position, orientation = options["tolerance"]
    lines = [
        f"ikde beside other solvers, interleaved, one core each, tolerances {position:g} m and {orientation:g} rad, "
        "limits and self-collision inside success, every answer graded by plain numpy; ms over all targets asked, "
        f"median / p95 / p99 / max / mean{format_rounds(options.get('rounds', 1))} ({options['limit']:g} s at most, "
        f"slow ones are asked fewer). How each is used: [benchmarks/peers]({adapters}).",
    ]
    for names in tables:
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


def format_rounds(rounds: int) -> str:
    """What is taken of several rounds."""
    return f" of each target's median over {rounds} rounds" if rounds > 1 else ""


def format_ahead(record: dict[str, Any]) -> str:
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


def order_peers(rows: dict[str, Any]) -> list[str]:
    """Names by median time; those that could not be used are left out."""
    used = [name for name, row in rows.items() if "ms" in row]
    return sorted(used, key=lambda name: rows[name]["ms"]["median"])


def format_peer(row: dict[str, Any]) -> str:
    """One cell: how many were solved of how many, and the times; no percentile of too few targets."""
    if "ms" not in row:
        return "-"
    asked = row["asked"] // row.get("rounds", 1)
    times = " / ".join(format_ms(row["ms"][key]) if asked >= n else "-" for key, n in ENOUGH.items())
    share = f"{row['solved'] / row['asked']:.2%}".replace(".00", "")
    return f"{share} of {row['asked']:,}{', then stopped' if 'lost' in row else ''}: {times}"


def format_ms(value: float) -> str:
    """Two digits, no exponent."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}" if rounded >= 10.0 else f"{rounded:g}" if rounded >= 1e-3 else f"{rounded:.4f}"


def make_readme() -> str:
    """Everything between the README's markers."""
    engines = load("engines")
    note = "a shared virtual machine whose clock swings by a factor of 1.5, which is what p95 and max show"
    return join(
        f"{format_machine(engines['machine'])}; {note}.",
        format_engines(engines),
        format_peers(load("peers"), PEER_TABLES[:1], "benchmarks/peers/README.md"),
        "Four more cases: [docs/speed.md](docs/speed.md#other-solvers).",
        format_methods(load("track"), ("differential",)),
        "On both bases, and beside Pink and mink: [docs/following.md](docs/following.md#measured).",
        format_batch(load("batch_scale")),
        format_start(load("start_up")),
    )


def make_speed() -> str:
    """Everything between the markers of docs/speed.md."""
    ablation = load("ablation")
    return join(
        f"{format_machine(ablation['machine'])}.",
        "## What each idea buys",
        format_ablation(ablation),
        "## Other solvers",
        format_peers(load("peers"), PEER_TABLES, "../benchmarks/peers/README.md"),
        format_ahead(load("peers")),
        "### RoboPlan, and an arm on a fixed base",
        format_arm(load("peers_arm")),
        "## Differential evolution",
        format_memetic(load("memetic")),
        format_search(load("paper_search")),
        "## Data-driven kernels",
        format_kernels(load("kernel_times")),
    )


def format_arm(record: dict[str, Any]) -> str:
    """Peers that were added later, and cases of an arm that alone may move."""
    machine = record["machine"]
    return join(
        f"{machine['processor']}, Python {machine['python']}, numba {machine['numba']}; others used the machine, too.",
        format_peers(record, ARM_TABLES, "../benchmarks/peers/README.md"),
        format_ahead(record),
    ).rstrip()


def make_following() -> str:
    """What was measured of our methods."""
    record = load("track")
    return join(
        f"{format_machine(record['machine'])}.",
        format_methods(record, ("differential", "omnidirectional")),
        format_between(record),
        format_whole_paths(record),
        format_stops(record),
    )


def make_following_peers() -> str:
    """The same beside others."""
    record = load("peer_tracks")
    return join(f"{format_machine(record['machine'])}.", format_peers_along(record), format_starts(record))


def join(*parts: str) -> str:
    """Paragraphs."""
    return "\n\n".join(parts) + "\n"


def insert(page: str, *blocks: str) -> str:
    """A page with its blocks, in their order, made anew."""
    made = iter(blocks)
    return BLOCK.sub(lambda match: f"{match[1]}{next(made)}{match[2]}", page)


if __name__ == "__main__":
    pages = {
        "README.md": (make_readme(),),
        "docs/speed.md": (make_speed(),),
        "docs/following.md": (make_following(), make_following_peers()),
    }
    for name, made in pages.items():
        path = ROOT / name
        path.write_text(insert(path.read_text(), *made))
