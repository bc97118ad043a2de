"""What a robot holds, as it is typed."""

import pytest

from ikde.errors import InputError
from ikde.formats.attached import read_attached


def test_objects_frames_and_what_they_may_touch():
    assert read_attached("mug=tool") == [("mug", "tool", ())]
    assert read_attached("mug = tool:table+left finger, lid=tool") == [
        ("mug", "tool", ("table", "left finger")),
        ("lid", "tool", ()),
    ]


@pytest.mark.parametrize("text", ["", "mug", "mug=", "=tool", "mug=tool,", "mug=tool:", "mug=tool:table+"])
def test_what_is_no_such_text_is_refused(text):
    with pytest.raises(InputError, match=r"^attach: expected OBJECT=FRAME or OBJECT=FRAME:T\+T, got '"):
        read_attached(text)
