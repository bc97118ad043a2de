"""The page of a robot's spheres."""

import numpy as np

from ikde.io.urdf_import.imported import CoveredLink
from ikde.report.html import render_html
from ikde.report.markdown import render_markdown
from ikde.report.page import Table
from ikde.report.sphere_page import DrawnLink, make_sphere_page
from tests.mesh_bodies import box


def make(name, covered, protrusion_m):
    cover = CoveredLink(
        link=name, shapes="1 mesh", spheres=1, covered=covered, protrusion_m=protrusion_m, how="<greedy>"
    )
    return DrawnLink(cover=cover, triangles=box(0.1, 0.1, 0.1), centres=np.full((1, 3), 0.05), radii=np.array([0.09]))


LINKS = [make("fore", 0.9999999, 0.0123), make("<b>hand", None, None)]


def test_the_table_has_every_link_and_rounds_nothing_up_to_all():
    page = make_sphere_page("arm", LINKS, "ikde robots spheres arm.yaml", ["a *note*"])
    (table,) = (block for block in page.sections[0].blocks if isinstance(block, Table))
    assert table.texts() == [
        ["fore", "1 mesh", "<greedy>", "1", "99.9999 %", "12.3"],
        ["<b>hand", "1 mesh", "<greedy>", "1", "", ""],
    ]
    assert [section.title for section in page.sections] == ["Links", "fore", "<b>hand", "Again"]
    assert "2 links" in str(page.lead)


def test_it_is_one_file_with_pictures_and_no_markup_of_strangers():
    page = make_sphere_page("arm", LINKS, "ikde robots spheres arm.yaml", ["a *note*"])
    html = render_html(page)
    assert html.count("data:image/png;base64,") == 2
    assert "<b>hand" not in html
    assert "a *note*" in html
    assert "arm.yaml" in render_markdown(page)


def test_all_is_said_to_be_all():
    page = make_sphere_page("arm", [make("fore", 1.0, 0.02)], "x")
    (table,) = (block for block in page.sections[0].blocks if isinstance(block, Table))
    assert table.texts()[0][4] == "100 %"
