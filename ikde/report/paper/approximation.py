"""Table 2 and Figure 7."""

from collections.abc import Mapping
from typing import Any

from ikde.model.robot import Robot
from ikde.report.numbers import fixed
from ikde.report.page import Cell, Column, Gallery, Section, Table, Text
from ikde.report.paper.pictures import draw_robot

NAMES = ("typical", "improved")


def make_approximation(data: Mapping[str, Any], robot: Robot) -> Section:
    """Volumes and degrees beside the print, home with three approximations, and the spheres drawn."""
    exact = data["exact"]
    return Section(
        "Table 2 and Figure 7: sphere approximations",
        (
            _introduce(exact),
            *(_make_volumes(exact, name) for name in NAMES),
            _make_home(exact),
            _draw(data, robot),
        ),
        anchor="table-2",
    )


def _introduce(exact: Mapping[str, Any]) -> Text:
    cells = [row[name] for row in exact["components"] for name in NAMES]
    agree = sum(cell["agrees"] for cell in cells)
    counts = exact["sphere_counts"]
    return Text(
        f"Volumes of the spheres (n 4/3 π R³) and the degree of approximation, part / spheres. {agree} of {len(cells)} "
        f"volumes agree to the five printed digits, and their degrees with them once misprints are put right. The "
        f"typical approximation has {counts['typical']} spheres, the improved one {counts['improved']}."
    )


def _make_volumes(exact: Mapping[str, Any], name: str) -> Table:
    return Table(
        columns=(
            Column("part", align="left"),
            Column("its volume", "mm³", mark="published"),
            Column("spheres (R in mm)", align="left"),
            Column("printed", "mm³", group="volume of the spheres", mark="published"),
            Column("ours", "mm³", group="volume of the spheres", mark="ours"),
            Column("printed", "%", group="degree", mark="published"),
            Column("ours", "%", group="degree", mark="ours"),
            Column("count and radii are", align="left"),
        ),
        rows=tuple(_make_row(row, row[name]) for row in exact["components"]),
        caption=f"Table 2: the {name} approximation",
        note="A degree marked ≠ is a misprint: the printed volumes themselves give ours.",
    )


def _make_row(part: Mapping[str, Any], cell: Mapping[str, Any]) -> tuple[str | Cell, ...]:
    degree = fixed(cell["degree_pct"]["printed"], 2)
    return (
        f"{part['component']}, {part['part']}",
        f"{part['original_mm3']:.4e}",
        cell["spheres"],
        f"{cell['volume_mm3']['printed']:.4e}",
        f"{cell['volume_mm3']['ours']:.4e}",
        Cell(degree, "off") if cell["misprint"] else degree,
        fixed(cell["degree_pct"]["ours"], 2),
        ", ".join(cell["provenance"]),
    )


def _make_home(exact: Mapping[str, Any]) -> Table:
    return Table(
        columns=(
            Column("approximation", align="left"),
            Column("spheres"),
            Column("printed", align="left", mark="published"),
            Column("ours", align="left", mark="ours"),
            Column("clearance", "mm", mark="ours"),
            Column("closest pair", align="left"),
            Column("colliding pairs"),
        ),
        rows=tuple(
            (
                row["detector"],
                str(exact["sphere_counts"][row["detector"]]),
                row["printed"],
                "collides" if row["collides"] else "free",
                fixed(row["clearance_mm"], 2),
                " – ".join(row["pair"]),
                str(len(row["colliding_pairs"])),
            )
            for row in exact["home"]
        ),
        caption="Section 5.3.1: the home configuration",
        note=f"With one sphere a component home {_say_home(exact, 'single')}, with several "
        f"{' and '.join(_say_home(exact, name) for name in NAMES)}.",
    )


def _say_home(exact: Mapping[str, Any], detector: str) -> str:
    row = next(row for row in exact["home"] if row["detector"] == detector)
    return "collides" if row["collides"] else "is free"


def _draw(data: Mapping[str, Any], robot: Robot) -> Gallery:
    q = data["settings"]["figure"]["q"]
    figures = []
    for row in data["exact"]["home"]:
        name = row["detector"]
        spheres = data["exact"]["sphere_counts"][name]
        state = "collides" if row["collides"] else "free"
        figures.append(draw_robot(robot, q, name, caption=f"Figure 7: {name}, {spheres} spheres; home {state}."))
    return Gallery(tuple(figures))
