"""The path that the tool is asked to follow: a pose for every sample, and one half-way to the next."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, read_only
from ikde.model.target import Targets
from ikde.track.slerp import PathOrientation, slerp

MAX_SAMPLES = 10**6
MIN_STEP_S, MAX_STEP_S = 1e-9, 1e6


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToolPath:
    """Poses of the tool in the world, a sample every `dt_s` seconds. Sample k is due at k dt; sample 0 is the start.

    Arrays are copied and become read-only.

    Raises:
        InputError: for wrong shapes, NaN, fewer than two samples, a matrix that is no rotation, or neighbours half a
            turn apart.
    """

    name: str = "path"
    dt_s: float
    p_world_tool: Floats
    """[K + 1, 3] m"""
    orientation: PathOrientation = "free"
    """What is asked of the tool's orientation: nothing, the direction of its z axis, or all of it."""
    R_world_tool: Floats = None  # type: ignore[assignment]  # a free path needs none
    """[K + 1, 3, 3]; of an axis path only the last column is asked for, of a free one nothing (identities)."""
    p_half: Floats = None  # type: ignore[assignment]
    """[K, 3] m: where the tool should be at (k + 1/2) dt; by default on the chord."""
    R_half: Floats = None  # type: ignore[assignment]
    """[K, 3, 3]: its orientation there; by default on the shortest rotation."""

    def __post_init__(self) -> None:
        if not MIN_STEP_S <= self.dt_s <= MAX_STEP_S:
            message = f"expected {MIN_STEP_S:g} to {MAX_STEP_S:g} s, got {self.dt_s}"
            raise InputError(message, ("dt_s",))
        targets = self._read("", self.p_world_tool, self.R_world_tool)
        if not 2 <= len(targets) <= MAX_SAMPLES + 1:
            message = f"expected 1 to {MAX_SAMPLES:,} samples after the start, got {len(targets) - 1}"
            raise InputError(message, ("p_world_tool",))
        p, R = targets.p_world_tool, targets.R_world_tool
        middles = np.arange(0.5, len(p) - 1)
        p_half = 0.5 * (p[:-1] + p[1:]) if self.p_half is None else self.p_half
        R_half = self._between(R, middles) if self.R_half is None else self.R_half
        half = self._read("half", p_half, R_half)
        if len(half) != len(p) - 1:
            raise InputError(f"expected {len(p) - 1} poses, one fewer than samples, got {len(half)}", ("p_half",))
        own = {"p_world_tool": p, "R_world_tool": R, "p_half": half.p_world_tool, "R_half": half.R_world_tool}
        for key, array in own.items():
            object.__setattr__(self, key, read_only(array))

    def __repr__(self) -> str:
        return f"<ToolPath {self.name}: {self.samples} samples of {self.dt_s:g} s, orientation {self.orientation}>"

    @classmethod
    def through(
        cls,
        p_world_tool: ArrayLike,
        *,
        dt_s: float,
        R_world_tool: ArrayLike | None = None,
        axis_world_tool: ArrayLike | None = None,
        name: str = "path",
    ) -> Self:
        """A path through positions [K + 1, 3] in m, with rotations [K + 1, 3, 3] or tool axes [K + 1, 3] or neither.

        Raises:
            InputError: as `Targets`, with the row.
        """
        targets = Targets(p_world_tool, R_world_tool, axis_world_tool)
        asked: PathOrientation = (
            "pose" if R_world_tool is not None else "axis" if axis_world_tool is not None else "free"
        )
        p, R = targets.p_world_tool, targets.R_world_tool
        return cls(name=name, dt_s=dt_s, p_world_tool=p, orientation=asked, R_world_tool=R)

    @property
    def samples(self) -> int:
        """K: samples after the start."""
        return len(self.p_world_tool) - 1

    @property
    def duration_s(self) -> float:
        """Time from the start to the last sample, s."""
        return self.samples * self.dt_s

    @property
    def times_s(self) -> Floats:
        """When each sample is due [K + 1], s."""
        return np.arange(self.samples + 1.0) * self.dt_s

    def targets(self) -> Targets:
        """What is asked at the samples 0 .. K."""
        return self._read("", self.p_world_tool, self.R_world_tool)

    def half_targets(self) -> Targets:
        """What is asked half-way between the samples, [K]."""
        return self._read("half", self.p_half, self.R_half)

    def _between(self, R: Floats, at: Floats) -> Floats:
        try:
            return slerp(self.orientation, R, at)
        except InputError as error:
            raise InputError(error.message, ("R_world_tool", *error.where)) from None

    def _read(self, suffix: str, p: Floats, R: Floats | None) -> Targets:
        """The arrays as targets, which checks them."""
        try:
            if self.orientation == "free":
                return Targets(p)
            if R is None:
                raise InputError(f"a path of orientation {self.orientation!r} needs rotations", ("R_world_tool",))
            if self.orientation == "axis":
                return Targets(p, axis_world_tool=np.asarray(R, dtype=float)[..., 2])
            return Targets(p, R_world_tool=R)
        except InputError as error:
            name, *row = error.where
            raise InputError(error.message, (str(name).replace("world_tool", suffix or "world_tool"), *row)) from None
