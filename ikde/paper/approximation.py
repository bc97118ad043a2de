"""Table 2 and Figure 7: volumes of the sphere approximations, and their clearance at home."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot, SphereRow
from ikde.model.spheres import approximation_volume_m3
from ikde.paper.columns import label, make_table, mark_off, ours, published
from ikde.paper.inputs import APPROXIMATIONS, Inputs, meant
from ikde.paper.section import Computed, Misprint, PrintedMeantOurs, PrintedOurs, Verdict, draw_robot, judge
from ikde.report.numbers import fixed
from ikde.report.page import Cell, Column, Gallery, Section, Table, Text

DETECTORS = ("single", *APPROXIMATIONS)
SPHERES = "volume of the spheres"
HALF_DIGIT = 5e-5  # relative, at most: what five printed digits leave open of a volume, and so of its degree


@dataclass(frozen=True, slots=True, kw_only=True)
class Volume:
    """A part's spheres in one approximation; the degree is part / spheres."""

    spheres: str
    provenance: list[str]
    volume_mm3: PrintedOurs[float]
    degree_pct: PrintedMeantOurs[float]
    agrees: bool
    misprint: Misprint


@dataclass(frozen=True, slots=True, kw_only=True)
class Component:
    """A row of Table 2."""

    component: str
    part: str
    original_mm3: float
    typical: Volume
    improved: Volume

    def volume(self, approximation: str) -> Volume:
        """Of the typical or the improved approximation."""
        return self.typical if approximation == "typical" else self.improved


@dataclass(frozen=True, slots=True, kw_only=True)
class Home(Verdict):
    """What a detector says of home, beside the print."""

    detector: str
    printed: str

    @property
    def ours(self) -> str:
        """The verdict in the words of the print."""
        return "collides" if self.collides else "free"


@dataclass(frozen=True, slots=True, kw_only=True)
class Approximation(Computed):
    """Table 2, and home by three detectors."""

    components: list[Component]
    home: list[Home]
    sphere_counts: dict[str, int]
    total_volume_mm3: dict[str, float]

    @property
    def volumes(self) -> list[Volume]:
        """All cells of Table 2."""
        return [row.volume(name) for row in self.components for name in APPROXIMATIONS]


def compute_approximation(inputs: Inputs) -> Approximation:
    """Table 2's volumes and degrees as printed and ours, and which detectors are free at home."""
    robot, home, published = inputs.robot, inputs.robot.home, inputs.published["table_2"]
    volumes = {name: approximation_volume_m3(robot, name) for name in DETECTORS}
    return Approximation(
        components=[
            Component(
                component=name,
                part=entry["part"],
                original_mm3=entry["original_mm3"],
                **{key: _compare(robot, (key, name), entry, 1e9 * volumes[key][name]) for key in APPROXIMATIONS},
            )
            for name, entry in published.items()
        ],
        home=[
            Home(detector=name, printed="collides" if name == "single" else "free", **asdict(judge(robot, home, name)))
            for name in DETECTORS
        ],
        sphere_counts={name: sum(row.count for row in robot.approximations[name]) for name in DETECTORS},
        total_volume_mm3={name: 1e9 * sum(volumes[name].values()) for name in DETECTORS},
        settings={"source": "[Qiao2021, Table 2 and section 5.3.1]", "figure": {"q": home.tolist()}},
    )


def _compare(robot: Robot, place: tuple[str, str], entry: Mapping[str, Any], volume: float) -> Volume:
    """One cell: an approximation of a component, the component's print, and the volume of its spheres in mm^3."""
    printed = entry[place[0]]
    degree, right = 100.0 * entry["original_mm3"] / volume, meant(printed)["degree_pct"]
    is_near = abs(degree - right) < 0.0051 + HALF_DIGIT * right
    return Volume(
        spheres=describe_spheres(robot, *place),
        provenance=find_provenance(robot, *place),
        volume_mm3=PrintedOurs(printed=printed["volume_mm3"], ours=volume),
        degree_pct=PrintedMeantOurs(printed=printed["degree_pct"], meant=right, ours=degree),
        agrees=f"{volume:.4e}" == f"{printed['volume_mm3']:.4e}" and is_near,
        misprint=printed.get("misprint"),
    )


def describe_spheres(robot: Robot, approximation: str, component: str) -> str:
    """Counts and radii of a component's spheres, as in `3 x R80 + 1 x R80` (mm), rows in their order."""
    rows = [row for row in robot.approximations[approximation] if row.component == component]
    return " + ".join(f"{row.count} x R{1e3 * row.radius_m:g}" for row in rows if isinstance(row, SphereRow))


def find_provenance(robot: Robot, approximation: str, component: str) -> list[str]:
    """Kinds of the sources of a component's rows: what is derived, and whether anything of it is calibrated."""
    rows = robot.approximations[approximation]
    named = {("spheres", approximation, index) for index, row in enumerate(rows) if row.component == component}
    return sorted({source.kind for path, source in robot.provenance.items() if path[:3] in named})


def show_approximation(data: Approximation, inputs: Inputs) -> Section:
    """Volumes and degrees beside the print, home with three approximations, and the spheres drawn."""
    return Section(
        "Table 2 and Figure 7: sphere approximations",
        (
            _introduce(data),
            *(_make_volumes(data, name) for name in APPROXIMATIONS),
            _make_home(data),
            _draw(data, inputs.robot),
        ),
        anchor="table-2",
    )


def _introduce(data: Approximation) -> Text:
    volumes, counts = data.volumes, data.sphere_counts
    return Text(
        f"Volumes of the spheres (n 4/3 π R³) and the degree of approximation, part / spheres. "
        f"{sum(volume.agrees for volume in volumes)} of {len(volumes)} "
        f"volumes agree to the five printed digits, and their degrees with them once misprints are put right. The "
        f"typical approximation has {counts['typical']} spheres, the improved one {counts['improved']}."
    )


def _make_volumes(data: Approximation, name: str) -> Table:
    return make_table(
        ((row, row.volume(name)) for row in data.components),
        label("part", lambda row: f"{row[0].component}, {row[0].part}"),
        published("its volume", "mm³", lambda row: f"{row[0].original_mm3:.4e}"),
        label("spheres (R in mm)", lambda row: row[1].spheres),
        published("printed", "mm³", lambda row: f"{row[1].volume_mm3.printed:.4e}", SPHERES),
        ours("ours", "mm³", lambda row: f"{row[1].volume_mm3.ours:.4e}", SPHERES),
        published("printed", "%", lambda row: _format_degree(row[1]), "degree"),
        ours("ours", "%", lambda row: fixed(row[1].degree_pct.ours, 2), "degree"),
        label("count and radii are", lambda row: ", ".join(row[1].provenance)),
        caption=f"Table 2: the {name} approximation",
        note="A degree marked ≠ is a misprint: the printed volumes themselves give ours.",
    )


def _format_degree(volume: Volume) -> str | Cell:
    return mark_off(fixed(volume.degree_pct.printed, 2), not volume.misprint)


def _make_home(data: Approximation) -> Table:
    single, *several = ("collides" if row.collides else "is free" for row in data.home)
    return make_table(
        data.home,
        label("approximation", lambda row: row.detector),
        (Column("spheres"), lambda row: str(data.sphere_counts[row.detector])),
        label("printed", lambda row: row.printed, mark="published"),
        label("ours", lambda row: row.ours, mark="ours"),
        ours("clearance", "mm", lambda row: fixed(row.clearance_mm, 2)),
        label("closest pair", lambda row: " – ".join(row.pair)),
        (Column("colliding pairs"), lambda row: str(len(row.colliding_pairs))),
        caption="Section 5.3.1: the home configuration",
        note=f"With one sphere a component home {single}, with several {' and '.join(several)}.",
    )


def _draw(data: Approximation, robot: Robot) -> Gallery:
    figures = []
    for row in data.home:
        caption = f"Figure 7: {row.detector}, {data.sphere_counts[row.detector]} spheres; home {row.ours}."
        figures.append(draw_robot(CollisionModel.of(robot, row.detector), robot.home.tolist(), caption=caption))
    return Gallery(tuple(figures))
