"""Finer spheres where two links touch often: of the smaller one, and only where few cover it."""

import pytest

from ikde.io.urdf_import import finer
from ikde.io.urdf_import.imported import list_notes
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from tests.urdf_texts import joint, write


def body(name, shape, at):
    return f'<link name="{name}"><collision><origin xyz="{at}"/><geometry>{shape}</geometry></collision></link>'


def make_arm(gap):
    """A small box that turns over a bar, `gap` m away from it; in half a turn it passes over it once."""
    turn = '<origin xyz="0 0 0"/><axis xyz="0 0 1"/><limit lower="-1.6" upper="1.6" velocity="1" effort="1"/>'
    return "".join(
        [
            '<robot name="arm">',
            body("bar", '<box size="0.4 0.4 0.1"/>', "0.2 0 -0.05"),
            body("mast", '<sphere radius="0.01"/>', "0 0 0.5"),
            body("finger", '<box size="0.06 0.06 0.06"/>', f"0.3 0 {gap + 0.03}"),
            joint("stand", "revolute", "bar", "mast", turn),
            joint("turn", "revolute", "mast", "finger", turn),
            "</robot>",
        ]
    )


def read(folder, gap, **options):
    imported = read_urdf(write(folder, make_arm(gap)), ImportOptions(tool="finger", **options))
    return imported, {link.link: link for link in imported.links}


def test_the_smaller_of_two_links_that_touch_often_is_covered_finer(tmp_path):
    imported, links = read(tmp_path, 0.028)
    coarse = links["bar"]
    assert links["finger"].how.endswith(", half the protrusion")
    assert links["finger"].protrusion_m <= 0.01 < coarse.protrusion_m <= 0.02
    assert not coarse.how.endswith(", half the protrusion")
    assert not any("touch" in warning for warning in imported.warnings)
    assert any(
        line.startswith("spheres of finger: ") and ", half the protrusion" in line for line in list_notes(imported)
    )


def test_without_it_they_touch_often(tmp_path, monkeypatch):
    monkeypatch.setattr(finer, "MAX_SPHERES", 0)
    imported, links = read(tmp_path, 0.028)
    assert not links["finger"].how.endswith(", half the protrusion")
    assert any("most often these touch: bar - finger" in warning for warning in imported.warnings)


def test_links_that_are_clear_stay_as_asked(tmp_path):
    imported, links = read(tmp_path, 0.1)
    assert not any(link.how.endswith(", half the protrusion") for link in links.values())
    assert not imported.warnings


@pytest.mark.parametrize("spheres", [1, 14, 15])
def test_only_what_few_spheres_cover_is_covered_anew(spheres):
    def own(count, protrusion_m=0.02):
        report = type("Report", (), {"protrusion_m": protrusion_m})
        return type("Own", (), {"radii": [0.1] * count, "report": report})

    covered = {"large": own(40), "small": own(spheres), "given": own(2, None)}
    frame_of = {"large": "frame", "small": "small", "given": "given"}
    often = (("frame", "small"), ("small", "frame"), ("given", "frame"), ("frame", "other"))
    assert finer.choose_finer(often, covered, frame_of) == (["small"] if spheres <= finer.MAX_SPHERES else [])
