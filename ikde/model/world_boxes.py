"""Boxes that hold solids, side by side: what kernels leave out most of a world by (`kernels/world_grid.py`)."""

from collections.abc import Sequence

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.flat_arguments import BOX_ROWS, BOXES, HEADER, SOLID_COLUMNS
from ikde.kernels.obstacles import ROUNDING
from ikde.kernels.world_grid import UPRIGHT
from ikde.model.solids import Solid

NOWHERE = -1e30  # m: half an edge of what is no box
TOGETHER, MIN_COLUMNS = 4, 12  # columns that a processor takes at once, and from how many on it does


def make_boxes(rows: Floats, solids: Sequence[Solid]) -> Floats:
    """A box [BOX_ROWS, S] that holds each solid, as in `WorldArrays`, but for what is asked for."""
    found = []
    for row, solid in zip(rows, solids, strict=True):
        middle, half = np.zeros(3), row[13:16].copy()
        if solid.points is not None:
            low, high = solid.points.min(axis=0), solid.points.max(axis=0)
            middle, half = 0.5 * (low + high), 0.5 * (high - low) + sum(solid.size_m)
        elif solid.kind == "half_space":
            half = np.full(3, NOWHERE)
        elif solid.kind != "box":
            radius, height = row[13], row[14]
            half[:] = radius, radius, height
            half[2] = radius if solid.kind == "sphere" else height + (radius if solid.kind == "capsule" else 0.0)
        found.append([*np.zeros(12), *half, ROUNDING, *middle, *np.zeros(6)])
    boxes = np.array(found).T
    turn_boxes(boxes, rows[:, 1:10], rows[:, 10:13])
    return boxes


def turn_boxes(boxes: Floats, axes: Floats, places: Floats) -> None:
    """Columns of the table where their solids have axes [S, 9] and places [S, 3], m; the rest of them stays."""
    boxes[:9], boxes[9:12] = axes.T, np.einsum("sij,js->is", axes.reshape(-1, 3, 3), boxes[16:19]) + places.T
    _set_upright(boxes)


def _set_upright(boxes: Floats) -> None:
    """The boxes along the axes of the world, of those along the solids' own."""
    wide = np.einsum("ijs,js->is", abs(boxes[:9]).reshape(3, 3, -1), boxes[12:15]) + boxes[15]
    boxes[UPRIGHT : UPRIGHT + 3], boxes[UPRIGHT + 3 :] = boxes[9:12] - wide, boxes[9:12] + wide


def find_boxes(whole: Floats) -> Floats:
    """Those of a packed world, as a view."""
    columns = int(whole[BOXES])
    return whole[HEADER + SOLID_COLUMNS * int(whole[0]) :][: BOX_ROWS * columns].reshape(BOX_ROWS, columns)


def stack_boxes(boxes: list[Floats], widest: Floats) -> Floats:
    """Of all solids, side by side; with what is asked for, and boxes of nothing up to a multiple of `TOGETHER`."""
    count = sum(own.shape[1] for own in boxes)
    columns = max(-(-count // TOGETHER) * TOGETHER, MIN_COLUMNS) if count else 0
    whole = np.zeros((BOX_ROWS, columns))
    whole[12:15], whole[UPRIGHT:] = NOWHERE, -NOWHERE
    if count:
        whole[:, :count] = np.concatenate(boxes, axis=1)
        whole[15, :count] += widest
        _set_upright(whole[:, :count])
    return whole
