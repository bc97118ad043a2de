"""Spheres in a robot's file: rows between key points, and free spheres in a frame."""

from typing import Annotated

from pydantic import ConfigDict, Field
from pydantic.config import JsonDict

from ikde.errors import InputError
from ikde.formats.entries import Entry, Number
from ikde.formats.names import Name
from ikde.io.yaml_file import Where
from ikde.model.robot import FreeSpheres, Spacing, SphereRow, Spheres

ROW_OR_FREE: JsonDict = {
    "oneOf": [
        {"required": ["from", "radius"], "properties": {"frame": False, "spheres": False}},
        {
            "required": ["frame", "spheres"],
            "properties": dict.fromkeys(("from", "to", "radius", "count", "spacing"), False),
        },
    ]
}
FreeSphere = Annotated[list[Number], Field(min_length=4, max_length=4)]
Source = Name | dict[Name, Name]
"""The name of an entry in `sources`, or one for each key of the entry that holds numbers."""


class SourcedEntry(Entry):
    """An entry whose numbers have a source."""

    source: Source | None = None


class SphereRowEntry(SourcedEntry):
    """A row of equal spheres between two key points, or free spheres [x, y, z, radius] in a frame."""

    model_config = ConfigDict(json_schema_extra=ROW_OR_FREE)

    component: Name
    start: Name | None = Field(None, alias="from")
    end: Name | None = Field(None, alias="to")
    radius: Number | None = None
    frame: Name | None = None
    spheres: Annotated[list[FreeSphere], Field(min_length=1, max_length=10_000)] | None = None
    count: Annotated[int, Field(strict=True, ge=1, le=10_000)] = 1
    spacing: Spacing = "touching"


def to_spheres(entry: SphereRowEntry, length: float, where: Where) -> Spheres:
    """A row, or free spheres: what either needs, and nothing of the other."""
    is_free = entry.frame is not None or entry.spheres is not None
    for key in entry.model_fields_set & {"start", "end", "radius", "count", "spacing"} if is_free else ():
        alias = {"start": "from", "end": "to"}.get(key, key)
        raise InputError("free spheres have a frame, and x, y, z, radius each; this key is of a row", (*where, alias))
    if entry.frame is not None and entry.spheres is not None:
        spheres = tuple((x * length, y * length, z * length, r * length) for x, y, z, r in entry.spheres)
        return FreeSpheres(component=entry.component, frame=entry.frame, spheres=spheres)
    if entry.start is None or entry.radius is None:
        missing = ("frame" if entry.frame is None else "spheres") if is_free else None
        raise InputError("this key is missing", (*where, missing or ("from" if entry.start is None else "radius")))
    return SphereRow(
        component=entry.component,
        start=entry.start,
        end=entry.end or entry.start,
        radius_m=entry.radius * length,
        count=entry.count,
        spacing=entry.spacing,
    )
