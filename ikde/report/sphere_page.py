"""Spheres of a robot's links as a page: a table, and each link from three sides."""

from collections.abc import Sequence
from dataclasses import dataclass

from ikde import __version__
from ikde.io.urdf_import.imported import CoveredLink
from ikde.kernels.arrays import Floats
from ikde.plot.covers import plot_cover
from ikde.plot.images import to_png
from ikde.report.markup import verbatim
from ikde.report.page import Code, Column, Figure, Notice, Number, Numbers, Page, Section, Table, Text

DPI = 110
EXPLAINED = (
    "Covered is the share of the surface that is proved to lie inside spheres: a triangle whose corners lie in one "
    "sphere lies in it, any other is halved. Protrusion is how far spheres stand out of the shapes at most: the radius "
    "of a sphere without the depth of its centre. An empty cell was not checked: of cylinders, capsules and spheres "
    "only what was made here is known."
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnLink:
    """A link as it is shown."""

    cover: CoveredLink
    triangles: Floats
    """[T, 3, 3] m, in the link."""
    centres: Floats
    """[S, 3] m"""
    radii: Floats
    """[S] m"""


def make_sphere_page(name: str, links: Sequence[DrawnLink], command: str, warnings: Sequence[str] = ()) -> Page:
    """The page; `command` makes it again, `name` is the robot's."""
    return Page(
        title=f"Spheres of {name}",
        lead=(*(Notice(verbatim(warning)) for warning in warnings), _headline(links)),
        sections=(
            Section("Links", (_make_table(links), Text(EXPLAINED))),
            *(Section(own.cover.link, (_draw(own),), anchor=f"link-{k}") for k, own in enumerate(links)),
            Section("Again", (Code(command),)),
        ),
        footer=f"Made by ikde {__version__}.",
    )


def _headline(links: Sequence[DrawnLink]) -> Numbers:
    covered = [own.cover.covered for own in links if own.cover.covered is not None]
    out = [own.cover.protrusion_m for own in links if own.cover.protrusion_m is not None]
    items = [Number(f"{sum(own.cover.spheres for own in links):,}", "spheres", f"on {len(links)} links")]
    if covered:
        items.append(Number(_percent(min(covered)), "covered", f"the least of {len(covered)} links, by proof"))
    if out:
        items.append(Number(f"{1e3 * max(out):.3g} mm", "protrusion", f"at most, of {len(out)} links"))
    return Numbers(tuple(items))


def _make_table(links: Sequence[DrawnLink]) -> Table:
    heads = ("link", "shapes", "how made", ">spheres", ">covered", ">protrusion [mm]")
    rows = tuple(
        (
            own.cover.link,
            own.cover.shapes,
            own.cover.how,
            str(own.cover.spheres),
            "" if own.cover.covered is None else _percent(own.cover.covered),
            "" if own.cover.protrusion_m is None else f"{1e3 * own.cover.protrusion_m:.3g}",
        )
        for own in links
    )
    return Table(columns=Column.of(*heads), rows=rows, caption="Every link that has spheres.")


def _percent(share: float) -> str:
    """Never rounded up to all."""
    return "100 %" if share == 1.0 else f"{min(100.0 * share, 99.9999):.4f} %"


def _draw(own: DrawnLink) -> Figure:
    image = to_png(plot_cover(own.triangles, own.centres, own.radii), dpi=DPI)
    count = own.cover.spheres
    caption = f"{count} {'sphere' if count == 1 else 'spheres'}: {own.cover.how}"
    alt = f"shapes and spheres of {own.cover.link} from the front, from the side and from above"
    return Figure(image=image, alt=alt, caption=verbatim(caption))
