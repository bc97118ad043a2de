"""Distances to keep from a world as they are written: `10,gripper=0`."""

from ikde.errors import InputError, quoted


def read_margins(text: str | None, length_m: float) -> tuple[float, dict[str, float]]:
    """The distance for all, m, and those of components by name, from `10,gripper=0` in units of `length_m`.

    Raises:
        InputError: for what is no such text.
    """
    margins: dict[str, float] = {}
    for word in [] if text is None else text.split(","):
        name, equals, value = word.rpartition("=")
        name = name.strip()
        try:
            if equals and not name:
                raise ValueError("a component without a name")
            margin_m = float(value) * length_m
        except ValueError:
            raise InputError(f"expected a distance or component=distance, got {quoted(word)}", ("margin",)) from None
        if name in margins:
            raise InputError("this margin is given twice", ("margin", *([name] if name else [])))
        margins[name] = margin_m
    return margins.pop("", 0.0), margins
