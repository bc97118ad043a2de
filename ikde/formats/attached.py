"""What a robot holds as it is typed: `mug=tool`, or `mug=tool:table+finger` with what it may touch."""

from typing import NamedTuple

from ikde.errors import InputError, quoted


class Held(NamedTuple):
    """An object, the frame that holds it, and what it may touch."""

    name: str
    frame: str
    may_touch: tuple[str, ...]


def read_attached(text: str) -> list[Held]:
    """Objects in the order in which they are picked up, from `mug=tool:table+finger,lid=tool`.

    Raises:
        InputError: for what is no such text.
    """
    found: list[Held] = []
    for word in text.split(","):
        name, _, place = word.strip().partition("=")
        frame, colon, touched = place.partition(":")
        may_touch = tuple(part.strip() for part in touched.split("+")) if colon else ()
        if not (name.strip() and frame.strip() and all(may_touch)):
            raise InputError(f"expected OBJECT=FRAME or OBJECT=FRAME:T+T, got {quoted(word)}", ("attach",))
        found.append(Held(name.strip(), frame.strip(), may_touch))
    return found
