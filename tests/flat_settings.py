"""Settings from flat keywords: what belongs to the DE asks for the method `de`."""

from dataclasses import fields

import ikde

OF_DE = {field.name for field in fields(ikde.DeSettings)}


def flat_settings(base=None, **changes):
    """`base`, or the defaults, with some values changed."""
    de = {name: changes.pop(name) for name in OF_DE & changes.keys()}
    return (base or ikde.SolveSettings()).with_changes(method="de" if de else None, de=de, **changes)
