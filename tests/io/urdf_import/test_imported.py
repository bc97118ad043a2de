"""What the robot's file says of its import."""

from ikde.io.urdf_import.imported import list_notes
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from tests.urdf_texts import FINGERS, extend, write


def test_the_notes_hold_what_the_file_cannot_show(tmp_path):
    text = extend(FINGERS).replace('<sphere radius="0.1"/>', "<cone/>")
    notes = list_notes(read_urdf(write(tmp_path, text), ImportOptions(tool="tip")))
    assert notes[0] == f"Imported from {tmp_path / 'arm.urdf'}; m and rad."
    assert notes[1] == "frozen: grip (prismatic) at 0.01: off the chain to the tool, the limit next to 0"
    assert notes[3] == "home: 0, or mid-range"
    assert notes[4].startswith("warning: line 3: a collision element of base_link is left out")
