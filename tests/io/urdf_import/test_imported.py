"""What the robot's file says of its import."""

from ikde.io.urdf_import.imported import CoveredLink, describe_cover, list_notes
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from tests.urdf_texts import FINGERS, extend, write


def test_the_notes_hold_what_the_file_cannot_show(tmp_path):
    text = extend(FINGERS).replace('<sphere radius="0.1"/>', "<cone/>")
    notes = list_notes(read_urdf(write(tmp_path, text), ImportOptions(tool="tip")))
    assert notes[0] == f"Imported from {tmp_path / 'arm.urdf'}; m and rad."
    assert notes[1] == "frozen: grip (prismatic) at 0.01: off the chain to the tool, the limit next to 0"
    assert notes[3:5] == [
        "home: 0, or mid-range where 0 is outside the limits",
        "pairs: none, self-collision is not checked",
    ]
    assert notes[5].startswith("warning: line 3: a collision element of base_link is left out")


def test_how_a_link_is_covered_is_said():
    known = {"link": "fore", "shapes": "1 mesh", "spheres": 28}
    made = CoveredLink(**known, covered=0.9995, protrusion_m=0.02, how="fitted to the mesh")
    assert describe_cover(made) == (
        "fore: 28 for 1 mesh, fitted to the mesh; 99.95 % proved to be covered; at most 20 mm out"
    )
    given = CoveredLink(**known, covered=None, protrusion_m=None, how="as in a.yml (cuRobo)")
    assert describe_cover(given) == "fore: 28 for 1 mesh, as in a.yml (cuRobo)"


def test_spheres_of_shapes_stand_in_the_notes_and_those_that_are_spheres_do_not(tmp_path):
    text = extend("").replace('<sphere radius="0.1"/>', '<box size="0.1 0.1 0.1"/>')
    notes = list_notes(read_urdf(write(tmp_path, text)))
    made = [note for note in notes if note.startswith("spheres of")]
    assert len(made) == 1
    assert made[0].startswith("spheres of base_link: 8 for 1 box, rows and grids in closed form; 100 % proved")
