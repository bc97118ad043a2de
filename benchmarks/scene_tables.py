"""Tables of grasp poses among obstacles beside other programs, from `scene_peers.py` and `scene_checks.py`."""

from typing import Any

from track_tables import make_head, make_row

Record = dict[str, Any]
FIGURES = ("median", "p95", "p99", "max")
ENOUGH = {"median": 1, "p95": 20, "p99": 100, "max": 1}  # problems that a figure asks for


def format_scene_peers(record: Record, adapters: str) -> str:
    """Other solvers beside ikde, a table a robot, quickest first."""
    options = record["options"]
    position, orientation = options["tolerance"]
    parts = [
        f"{record['machine']['cpu']}, a machine that others used as well: so milliseconds of a processor, not of a "
        f"clock. Every {options['every']}th problem, the same scenes, spheres, pairs, limits and targets for "
        f"all, {position:g} m and {orientation:g} rad, problem by problem interleaved, one core each; of a target the "
        f"median of {options['rounds']} rounds, {options['limit']:g} s at most, and those that need more than "
        f"{options['share']:g} s for a robot are asked fewer. Every answer is graded from the text of URDF and scene, "
        "and by coal on all pairs. *Ratio*: of medians, over the problems that both were asked. *New*: loading a scene "
        f"and the first answer in it. How each is used: [benchmarks/peers]({adapters}).",
    ]
    for robot, found in record["robots"].items():
        lines = [f"*{robot}*:", "", *make_head(("solver", "solved", *FIGURES, "ratio", "new"))]
        lines += [_make_peer_row(name, found["rows"][name]) for name in _order(found["rows"])]
        parts.append("\n".join(lines))
    out = {
        name: why
        for found in record["robots"].values()
        for name, row in found["rows"].items()
        if (why := row.get("lost"))
    }
    reasons = [f"{name} ({why})" for name, why in {**record["missing"], **out}.items()]
    return "\n\n".join([*parts, *([f"Not asked, or not to the end: {'; '.join(reasons)}."] if reasons else [])])


def format_scene_ahead(record: Record) -> str:
    """In which figures of which robot another one that solves as many is quicker than `ikde.solve`."""
    found = []
    for robot, part in record["robots"].items():
        ours = part["rows"]["ikde"]
        for name, row in part["rows"].items():
            if name == "ikde" or "ms" not in row or row["solved"] * ours["asked"] < ours["solved"] * row["asked"]:
                continue
            ahead = [key for key in FIGURES if row["ms"][key] < ours["ms"][key] and row["asked"] >= ENOUGH[key]]
            ahead += ["new"] if _sum_new(row) < _sum_new(ours) else []
            found += [f"{name} on *{robot}* ({', '.join(ahead)})"] if ahead else []
    return f"Quicker than `ikde` here: {'; '.join(found)}." if found else "None is quicker than `ikde` in any figure."


def format_scene_checks(record: Record) -> str:
    """The check alone: a row a way, a column a robot."""
    robots = record["robots"]
    heads = ["free configurations, µs", *(f"{name} ({one['spheres']} spheres)" for name, one in robots.items())]
    kernel = next(iter(next(iter(robots.values()))["us"]["free"]))
    lines = [
        "The check alone, the same configurations for all, each in its scene: microseconds of a configuration that is "
        "free, so that nothing ends early, the median over the scenes, and in brackets the multiple of the first row; "
        "interleaved. " + " ".join(_count_verdicts(name, one) for name, one in robots.items()),
        "",
        *make_head(heads),
    ]
    for way in next(iter(robots.values()))["us"]["free"]:
        cells = []
        for one in robots.values():
            us, first = (one["us"]["free"][key]["median"] for key in (way, kernel))
            cells.append(f"{us:,.3g} ({_format(us / first)})")
        lines.append(make_row(way, *cells))
    return "\n".join(lines)


def _make_peer_row(name: str, row: Record) -> str:
    cells = [_format(row["ms"][key]) if row["asked"] >= ENOUGH[key] else "–" for key in FIGURES]
    return make_row(name, f"{row['solved']} of {row['asked']}", *cells, _format(row["ratio"]), _format(_sum_new(row)))


def _order(rows: Record) -> list[str]:
    """Names by median time; those that could not be used are left out."""
    return sorted((name for name, row in rows.items() if "ms" in row), key=lambda name: rows[name]["ms"]["median"])


def _sum_new(row: Record) -> float:
    return row["ms_load"] + row["ms_first"]


def _format(value: float) -> str:
    """Two digits, no exponent."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}" if rounded >= 10.0 else f"{rounded:g}"


def _count_verdicts(robot: str, one: Record) -> str:
    differ = "none differs" if one["differ"] == 0 else f"{one['differ']} differ"
    return f"{robot}: {one['scenes']} scenes, {one['verdicts_compared']:,} verdicts on random configurations, {differ}."
