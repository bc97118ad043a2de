"""Tables of followed paths, from what `track.py` and `peers/tracks.py` recorded."""

from collections.abc import Sequence
from statistics import median
from typing import Any

from ikde.report.numbers import significant
from ikde.report.track_comparison import FIGURES, list_cells

Record = dict[str, Any]
FAULTS = ("ended early", "off the path", "collided", "beyond a limit")


def format_methods(record: Record, drives: Sequence[str]) -> str:
    """The paper's methods and ours along its paths, a row a path, base and method."""
    tracks = [one for one in record["tracks"] if one["drive"] in drives]
    seeds = len({run["seed"] for run in tracks[0]["runs"]})
    base = ["base"] if len(drives) > 1 else []
    starts = tracks[0]["dead_ends"]["starts"]
    heads = ["path", *base, "method", *(column.head for column in FIGURES), f"dead ends of {starts}"]
    lines = [
        "The paper's tool paths, 500 samples of 20 ms, by its two methods and by `continuation`: counts and extremes "
        f"over {seeds} seeds, from where `continuation` begins, graded by plain numpy; times are of the first seed, "
        "which ran alone. *A sample* of `continuation` is a step of the motion that it found, as a controller would "
        "take it; *whole path* is all that finding it took, starts and backtracking, where the other two were given "
        "their start. Dead ends are random starts from which the end is not reached. "
        "*Clearance* is certified between samples, too; *σ* is the smallest singular value of the arm's Jacobian in "
        "what the path asks for. `ikde bench track` makes the same as a page with figures:",
        "",
        *make_head(heads),
    ]
    for one in tracks:
        ends = one["dead_ends"]
        for method in dict.fromkeys(run["method"] for run in one["runs"]):
            runs = [run for run in one["runs"] if run["method"] == method]
            last = f"{ends[method]}" if method in ends else "–"
            lines.append(
                make_row(name_task(one["name"]), *([one["drive"]] if base else []), method, *list_cells(runs), last)
            )
    return "\n".join(lines)


def format_between(record: Record) -> str:
    """How far `continuation` leaves the path between samples, and how far a base with wheels slides."""
    ours = [run for one in record["tracks"] for run in one["runs"] if run["method"] == "continuation"]
    off = [run["largest_deviation_mm"] for run in ours]
    sideways = max(run["largest_sideways_m_s"] for run in ours if run["drive"] == "differential")
    return (
        f"Half-way between samples `continuation` is off the path by at most {min(off):.3f} to {max(off):.3f} mm; "
        f"across its middle heading the chord of a base with wheels runs at no more than {sideways:.0e} m/s."
    )


def format_whole_paths(record: Record) -> str:
    """What whole paths take from the same given starts."""
    ratios, ours = [], []
    for one in record["tracks"]:
        reached, seconds = one["dead_ends"]["reached_points"], one["dead_ends"]["search_s"]
        ends = zip(reached["optimized"], reached["continuation"], strict=True)
        both = [k for k, pair in enumerate(ends) if min(pair) == one["points"]]
        theirs, mine = (median(seconds[method][k] for k in both) for method in ("optimized", "continuation"))
        ratios.append(theirs / mine)
        ours.append(1e3 * mine)
    return (
        "From the same random starts, two motions at a time, where both reach the end, `continuation` takes "
        f"{significant(min(ours))} to {significant(max(ours))} ms for a whole path in the middle of the starts, "
        f"backtracking included: {significant(min(ratios), 2)} to {significant(max(ratios), 2)} times less than "
        "`optimized`."
    )


def format_stops(record: Record) -> str:
    """What the dead ends of `optimized` run into most often."""
    parts = []
    for one in record["tracks"]:
        stops = list(one["dead_ends"]["stops"]["optimized"].items())
        if one["drive"] == "differential" and stops:
            most = ", ".join(f"{reason.replace('_', ' ')} ({count})" for reason, count in stops[:3])
            parts.append(f"{name_task(one['name'])}: {most}")
    return f"What stops `optimized` on wheels most often, of all its dead ends: {'; '.join(parts)}."


def format_peers_along(record: Record) -> str:
    """The same paths followed by ikde, Pink and mink, a row a path and way."""
    heads = ("path", "way", "reached", "within 1 mm", "limits broken", "colliding")
    errors = ("largest error [mm]", "RMS [mm]", "largest error [rad]")
    steps = ("clearance at samples [mm]", "between [mm]", "largest step [mm]", "[deg]")
    times = ("a sample, median [ms]", "p99 [ms]", "max [ms]")
    lines = [
        "*Reached*: within 0.001 mm along each axis and 1e-4 rad; errors are of the worst axis. Times are of one "
        f"sample, its median over {record['options']['rounds']} rounds, over the samples.",
        "",
        *make_head((*heads, *errors, *steps, *times)),
    ]
    for task in record["tasks"].values():
        lines += (make_row(name_task(task["name"]), name, *list_way(way)) for name, way in task["ways"].items())
    return "\n".join(lines)


def list_way(way: Record) -> tuple[str, ...]:
    """One way along one path, column by column."""
    certified, degrees = way["certified_clearance_mm"], 57.29577951308232 * way["largest_jump_rad"]
    return (
        f"{way['reached_points']}",
        f"{way['points_within_1_mm']}",
        f"{way['limit_violations']}",
        f"{way['colliding_samples']}",
        *(write_small(max(way[f"{kind}_axis_errors_mm"])) for kind in ("largest", "rms")),
        write_small(way["largest_rotation_error_rad"]) if way["largest_rotation_error_rad"] else "–",
        f"{way['smallest_clearance_mm']:.1f}",
        "–" if certified is None else f"{certified:.1f}",
        f"{1e3 * way['largest_jump_m']:.1f}",
        f"{degrees:.1f}",
        *(significant(way["ms"][key]) for key in ("median", "p99", "max")),
    )


def format_starts(record: Record) -> str:
    """From how many random starts each way gets to the end, and what the others run into."""
    tasks = record["starts"]
    names = [name_task(record["tasks"][task]["name"]) for task in tasks]
    starts = next(iter(tasks.values()))["starts"]
    lines = [
        f"From {starts} random free configurations at the first pose: how many are followed to the end within 1 mm and "
        "0.01 rad, without a collision or a broken limit, and what the others of all tasks run into.",
        "",
        *make_head(["way", *names, *FAULTS]),
    ]
    for name in next(iter(tasks.values()))["ways"]:
        ways = [row["ways"][name] for row in tasks.values()]
        faults = (sum(way.get(fault, 0) for way in ways) for fault in FAULTS)
        lines.append(make_row(name, *(f"{way.get('followed', 0)}" for way in ways), *(f"{count}" for count in faults)))
    return "\n".join(lines)


def write_small(value: float) -> str:
    """Two digits; one and an exponent below a thousandth."""
    return f"{value:.2g}" if value >= 1e-3 or value == 0.0 else f"{value:.0e}".replace("e-0", "e-")


def name_task(name: str) -> str:
    """`task 1` of `Qiao 2022, task 1`."""
    return name.partition(", ")[2] or name


def make_head(heads: Sequence[str]) -> tuple[str, str]:
    """The first two lines of a table."""
    return make_row(*heads), f"|{'---|' * len(heads)}"


def make_row(*cells: str) -> str:
    """One line of a table."""
    return f"| {' | '.join(cells)} |"
