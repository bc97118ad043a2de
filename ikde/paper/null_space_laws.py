"""The laws of [Zhang2022, section 3.2] as they are printed, and what they should be; many configurations side by side.

Every function takes the Jacobians [..., 3, n] of two tasks and what they should do [..., 3], and gives speeds [..., n].
"""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.solver.priority import Level, damped_inverse, null_projector, recurse


def printed(first: Level, second: Level, softest: float = 0.0) -> Floats:
    """(24) with the tool first, (25) with the platform first: J1# x1 + (I - J1# J1) J2# x2.

    The second task is solved as if it were alone, so what the projector takes away of it is missing, and what it does
    to the first task's joints is not taken into account.
    """
    alone = _times(damped_inverse(second.matrix, softest), second.wanted)
    return _times(damped_inverse(first.matrix, softest), first.wanted) + _times(null_projector(first.matrix), alone)


def exact(first: Level, second: Level, softest: float = 0.0) -> Floats:
    """J1# x1 + (J2 N1)# (x2 - J2 J1# x1), with N1 = I - J1# J1: the second as well as the first allows."""
    return recurse([first, second], softest)


def blend(share: Floats | float, one: Floats, other: Floats) -> Floats:
    """(26): share x one + (1 - share) x other, of speeds [..., n]; the share [...] is the same for all of them."""
    share = np.asarray(share)[..., None]
    return share * one + (1.0 - share) * other


def enter(share: Floats, coming: Level, staying: Level, softest: float = 0.0) -> Floats:
    """`coming` gets priority over `staying` step by step, by what is wanted of `staying` [Lee2012].

    `staying` stands first all the time. It asks for a value between its own and what it gets where it is second.
    """
    share = np.asarray(share)[..., None]
    there = _times(staying.matrix, exact(coming, staying, softest))
    between = Level(staying.matrix, share * there + (1.0 - share) * staying.wanted)
    return exact(between, coming, softest)


def smooth(share: Floats | float) -> Floats:
    """From 0 to 1 without a kink, of a share [...] that runs from 0 to 1."""
    share = np.clip(np.asarray(share, dtype=float), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def closed_form_24(tool: Level, platform: Level) -> Floats:
    """What (24) makes of the platform [..., 3], of Jacobians by the platform's speeds: J1 = [Jb Ja], J2 = [I 0].

    Jb^T G x1 + (I - Jb^T G Jb) x2 with G = (Jb Jb^T + Ja Ja^T)^-1.
    """
    Jb, G = tool.matrix[..., :3], _weight(tool)
    return _times(Jb.mT @ G, tool.wanted) + platform.wanted - _times(Jb.mT @ G @ Jb, platform.wanted)


def closed_form_25(tool: Level, platform: Level) -> Floats:
    """What (25) makes of the tool [..., 3]: Jb x2 + Ja Ja^T G x1, so the platform drags it along."""
    Jb, Ja = tool.matrix[..., :3], tool.matrix[..., 3:]
    return _times(Jb, platform.wanted) + _times(Ja @ Ja.mT @ _weight(tool), tool.wanted)


def _weight(tool: Level) -> Floats:
    return np.asarray(np.linalg.inv(tool.matrix @ tool.matrix.mT), dtype=float)


def _times(matrix: Floats, vector: Floats) -> Floats:
    return (matrix @ vector[..., None])[..., 0]
