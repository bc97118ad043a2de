"""Tables of docs/speed.md and the README, from what the scripts of this folder recorded: one number a cell."""

from typing import Any

from track_tables import make_head, make_row

Record = dict[str, Any]
SHARES = ("median", "p95", "p99", "max")
FIVE = "qiao2021 pose"


def three(value: float) -> str:
    """Three digits, no exponent."""
    return f"{float(f'{value:.3g}'):,.10g}"


def make_spread(times: Record) -> list[str]:
    """Median and tails, a cell each."""
    return [three(times[key]) for key in SHARES]


def format_five(call: Record, bulk: Record, tracks: Record) -> str:
    """The README's numbers: what a robot with a mobile base and nine joints takes."""
    task = next(one for one in tracks["tracks"] if one["drive"] == "differential")
    run = next(run for run in task["runs"] if run["method"] == "continuation")
    rows = (
        ("`ikde.solve` of poses in a loop", call[FIVE]["after"], "µs"),
        (
            "the same after 5 ms of other work, as in a control loop",
            call[f"{FIVE}, after 5 ms of sleep"]["after"],
            "µs",
        ),
        ("`ikde.solve(near=q)`, another `q` each time", call[f"{FIVE}, another near each time"]["after"], "µs"),
        ("`ikde.solve_many` of 100,000 poses, for each", bulk[f"{FIVE} n=100000 threads=1"]["after"], "µs"),
        ("`ikde.run_track`, a path of 500 samples as a whole", [run["search_s"]], "s"),
    )
    lines = [*make_head(("one CPU core, `qiao2021` (9 joints)", "median", "p99", "unit"))]
    for name, times, unit in rows:
        is_spread = len(set(times)) > 1
        lines.append(make_row(name, three(times[0]), three(times[2]) if is_spread else "–", unit))
    return "\n".join(lines)


def format_calls(call: Record) -> str:
    """One target at a time from Python, a row a case."""
    lines = ["Microseconds a call of `ikde.solve`, result object and grade included:", ""]
    lines += make_head(("robot and target", *SHARES))
    lines += (make_row(name, *(three(value) for value in case["after"])) for name, case in call.items())
    return "\n".join(lines)


def format_many(bulk: Record) -> str:
    """Calls of `solve_many`, a row a robot and kind, a column a number of targets."""
    cases = [name for name in bulk if " n=" in name and name.endswith("threads=1")]
    counts = list(dict.fromkeys(int(name.split(" n=")[1].split()[0]) for name in cases))
    lines = [
        "Microseconds a target of `ikde.solve_many` on one thread, the median of all rounds, by the number of targets "
        "of a call; *loop* is `ikde.solve` called once for each:",
        "",
        *make_head(("robot and target", "loop", *(f"{count:,}" for count in counts))),
    ]
    for kind in dict.fromkeys(name.split(" n=")[0] for name in cases):
        times = (bulk.get(f"{kind} n={count} threads=1", {}).get("after", [None])[0] for count in counts)
        loop = bulk[f"{kind} loop"]["after"][0]
        lines.append(make_row(kind, three(loop), *("–" if time is None else three(time) for time in times)))
    return "\n".join(lines)


def format_search(record: Record) -> str:
    """The paper's search, a row a target and detector."""
    heads = ("median", "p95", "max")
    lines = [
        "The paper's search (`--method de`) on its two targets, base within ±0.1 m, until a verified collision-free "
        "solution:",
        "",
        *make_head(
            (
                *("target, detector", "seeds", "solved"),
                *(f"attempts, {name}" for name in heads),
                *(f"ms, {name}" for name in heads),
            )
        ),
    ]
    for name, cell in record["cells"].items():
        attempts = (f"{cell['attempts'][k]:.0f}" for k in heads)
        times = (f"{cell['milliseconds'][k]:,.0f}" for k in heads)
        lines.append(make_row(name, f"{cell['seeds']:,}", f"{cell['solved']:,}", *attempts, *times))
    lines += ["", "The paper reports 1.67 to 1.94 s a solve for the collision detection alone (Table 4)."]
    return "\n".join(lines)


def format_kernels(record: Record) -> str:
    """Nanoseconds a configuration, a row a stage."""
    sets, shares = record["ns"], ("median", "p95")
    lines = [
        "Nanoseconds a configuration in a kernel loop, improved spheres (36 spheres, 35 pairs of components), over 25 "
        "rounds; each row includes the rows above it:",
        "",
        *make_head(("stage", *(f"{name}, {share}" for name in sets for share in shares))),
    ]
    for stage in next(iter(sets.values())):
        cells = (f"{sets[name][stage][share]:,.0f}" for name in sets for share in shares)
        lines.append(make_row(stage, *cells))
    return "\n".join(lines)


def format_start(record: Record) -> str:
    """Start-up, a row a command."""
    heads = [f"{kind}, {share}" for kind in ("wall s", "process s") for share in ("median", "max")]
    lines = ["Whole processes, installed in a fresh environment:", "", *make_head(("command", *heads))]
    for name, row in record["commands"].items():
        cells = (f"{row[kind][share]:.2f}" for kind in ("wall_s", "process_s") for share in ("median", "max"))
        lines.append(make_row(name, *cells))
    return "\n".join(lines)


def format_batch(record: Record) -> str:
    """Runs of `ikde batch`, a row a run."""
    heads = ("run", "targets", "reached", "s", "answers a second", "µs a target", "of it search", "peak MB")
    gains = ("speed-up, least", "median", "largest")
    lines = [
        "`ikde batch` on targets that random collision-free configurations reach, all columns, every answer graded, "
        "the last 64 of each 4,096 by plain numpy as well; the median of interleaved rounds, s of whole processes, "
        "the other figures without their start; *speed-up* over one thread, of the rounds:",
        "",
        *make_head((*heads, *gains)),
    ]
    for cell in record["cells"]:
        gain = sorted(cell.get("gains", ()))
        shown = [f"{gain[k]:.2f}" for k in (0, len(gain) // 2, -1)] if gain else ["–"] * 3
        lines.append(
            make_row(
                *(cell["run"], f"{cell['targets']:,}", f"{cell['reached']:,}", f"{cell['wall_s']:.1f}"),
                *(f"{cell['solutions_a_second']:,.0f}", f"{cell['us_a_row']:.1f}", f"{cell['search_us_a_row']:.1f}"),
                *(f"{cell['peak_memory_mb']:.0f}", *shown),
            )
        )
    return "\n".join(lines)


def format_engines(record: Record) -> str:
    """One target at a time and in bulk, a row a set."""
    return "\n\n".join((_format_reached(record), _format_kernel_times(record), _format_bulk(record)))


def _name_set(row: Record) -> str:
    return f"{row['robot']}, {'hard ' if row['hard'] else ''}{row['kind']}"


def _format_reached(record: Record) -> str:
    lines = [
        "Sets of targets, all reached by random collision-free configurations, and how many are reached at 1e-5 m and "
        "1e-4 rad, the default, and at 1e-9 m and 1e-9 rad. *Hard*: low targets of which at least nine answers in ten "
        "collide:",
        "",
        *make_head(("set", "targets", "reached", "at 1e-9")),
    ]
    for row in record["sets"]:
        fine = row["1e-9 m, 1e-9 rad"]["reached"]
        lines.append(make_row(_name_set(row), f"{row['targets']:,}", f"{row['reached']:,}", f"{fine:,}"))
    return "\n".join(lines)


def _format_kernel_times(record: Record) -> str:
    lines = [
        "Microseconds a target on one core, for each target the median of "
        f"{record['rounds']} rounds: of the engine `lm` by a clock in compiled code, without Python and the grade:",
        "",
        *make_head(("set", *SHARES)),
    ]
    lines += (make_row(_name_set(row), *make_spread(row["kernel_us"])) for row in record["sets"])
    return "\n".join(lines)


def _format_bulk(record: Record) -> str:
    lines = [
        f"Of `solve_many` on one thread, 10,000 targets; the grader takes {record['sets'][0]['grader_us']:.2f} µs:",
        "",
        *make_head(("set", "at 1e-5 m, 1e-4 rad", "at 1e-6 m, 1e-6 rad")),
    ]
    for row in record["sets"]:
        tight = row["1e-6 m, 1e-6 rad"]["bulk_us"]
        lines.append(make_row(_name_set(row), f"{row['bulk_us']:.2f}", f"{tight:.2f}"))
    return "\n".join(lines)


def format_ablation(record: Record) -> str:
    """What each idea buys, a row a variant; then the width of the vectors."""
    columns = ("lanes us", "singly us", "attempts", "steps", "check all ns", "check free ns", "check lanes ns")
    lines = [
        f"{record['targets']:,} pose targets of qiao2021 at 1e-6 m and 1e-6 rad, inside compiled code; medians of "
        f"{record['rounds']} interleaved rounds. The checks are forward kinematics and yes/no self-collision on random "
        "(*all*) and on free configurations, one by one and in lanes:",
        "",
        *make_head(
            ("variant", "µs a target in lanes", "one by one", "attempts", "steps", "check ns, all", "free", "in lanes")
        ),
    ]
    rows = dict(record["variants"])
    if "variants" in record["wide"]:
        rows["all ideas, vectors of 512 bits"] = record["wide"]["variants"]["all ideas"]
    for name, row in rows.items():
        lines.append(make_row(name, *(three(row[c]) if c in row else "–" for c in columns)))
    widths = record["vectors"]["all ideas"]
    registers = ", ".join(f"`{name}` names ymm registers {found['ymm']:,} times" for name, found in widths.items())
    return "\n".join([*lines, "", f"In the machine code of what runs in lanes, {registers}."])


def format_memetic(record: Record) -> str:
    """Evaluations until solved, a row a method, a column a problem; one table a figure."""
    problems = record["problems"]
    targets = next(iter(next(iter(problems.values())).values()))["targets"]
    parts = [
        f"Differential evolutions on {targets} targets a problem, {record['settings']['budget']:,} evaluations of a "
        "target at most. The targets that were solved:"
    ]
    for title, key in ((None, "solved"), ("Median of the evaluations:", "median"), ("Their p95:", "p95")):
        lines = [*([title, ""] if title else []), *make_head(("method", *problems))]
        for method in next(iter(problems.values())):
            figures = (rows[method][key] for rows in problems.values())
            lines.append(make_row(method, *("more" if figure is None else f"{figure:,.0f}" for figure in figures)))
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def format_first_hour(record: Record) -> str:
    """Each command of docs/first_hour.md, the first time and once more."""
    machine = record["machine"]
    lines = [
        f"{machine['cpu']}, {machine['cores']} cores, Python {machine['python']}, numba {machine['numba']}; load "
        f"{record['load']:.1f} at the end. Wall seconds, and *process* seconds (user and system, of all threads and "
        "children that it waited for); *again* is the same command once more, with what the first has compiled:",
        "",
        *make_head(("command", "wall s", "process s", "again, wall s", "again, process s")),
    ]
    for row in record["rows"]:
        times = (row.get(when, {}).get(key) for when in ("first", "again") for key in ("wall_s", "process_s"))
        lines.append(make_row(f"`{row['command']}`", *("–" if t is None else f"{t:.1f}" for t in times)))
    return "\n".join(lines)
