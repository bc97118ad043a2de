"""What a step of a servo gives, and what held it."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel

HeldKind = Literal["speed", "acceleration", "range", "pair", "object", "base", "wheels", "distance", "reach", "target"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """The constraint that keeps the tool from its target."""

    kind: HeldKind
    """`speed`, `acceleration` and `range` of a joint; a `pair` of components; a component and an `object`; the place of
    a `base`, its `wheels`, the largest `distance` of the tool; `reach`: no joint brings the tool nearer; `target`: it
    is none."""
    names: tuple[str, ...]
    """The joint (`v`: of a base on arcs, along its heading), both components, or the component and the object."""
    value: float | None = None
    """What it is now: m/s or rad/s, the joint's value, or the distance in m; of `reach` the error that stays."""
    limit: float | None = None
    """What it may be at most, or of a distance at least."""
    text: str = ""
    """In words."""

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """What is nearer than it may be."""

    pair: tuple[str, str]
    """Two components, or a component and an obstacle; of several the deepest."""
    depth_m: float
    """By how much, m."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class ServoStep:
    """Where a step leads, how well it does, and what holds it."""

    q: Floats
    """[N] the next configuration, m and rad."""
    dq: Floats
    """[N] the speeds at its end, m/s and rad/s."""
    position_error_m: float | None
    """Of the tool at `q` from its target; None of a target that is none."""
    orientation_error_rad: float | None
    """Of what the target asks of the orientation: 0 if nothing."""
    error_m: float | None
    """Both as one: the root of the sum of squares, a rotation counts `rotation_length_m` a rad. Steps lower this."""
    reached: bool
    """Whether the tool is within the tolerances of the limits."""
    is_braking: bool
    """Whether it brakes because there is nothing better that is proved to stop in time, or no target."""
    stop_is_free: bool
    """Whether braking from here is proved to stay inside the ranges and clear, but for what was in contact before.

    It is false only if the world was changed, or the robot began elsewhere.
    """
    q_stop: Floats
    """[N] where it would stop if it braked."""
    _collision: CollisionModel
    _least: tuple[float, int]
    _hold: Callable[[], Held | None]

    def __repr__(self) -> str:
        error = "no target" if self.error_m is None else f"error {1e3 * self.error_m:.3g} mm"
        return f"<ServoStep: {error}{f', held by {self.held_by}' if self.held_by else ''}>"

    @cached_property
    def held_by(self) -> Held | None:
        """The constraint that holds the tool; None if the target is reached, or nothing does."""
        return self._hold()

    @property
    def clearance_m(self) -> float | None:
        """Distance of what has the least room, m; None without a detector: not checked."""
        least, place = self._least
        return least + self._collision.extra_m(place) if place >= 0 else None

    @property
    def nearest(self) -> tuple[str, str] | None:
        """What that is: two components, or a component and an obstacle."""
        place = self._least[1]
        return self._collision.name_pair(place) if place >= 0 else None

    @property
    def contact(self) -> Contact | None:
        """What is nearer than it may be at `q`, the deepest of them; None if all is free, or nothing is checked."""
        least, place = self._least
        if place < 0 or least > self._collision.limit_m:
            return None
        return Contact(pair=self._collision.name_pair(place), depth_m=self._collision.limit_m - least)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        held, contact = self.held_by, self.contact
        return {
            "q": self.q.tolist(),
            "dq": self.dq.tolist(),
            "position_error_m": self.position_error_m,
            "orientation_error_rad": self.orientation_error_rad,
            "reached": self.reached,
            "is_braking": self.is_braking,
            "stop_is_free": self.stop_is_free,
            "clearance_m": self.clearance_m,
            "held_by": None if held is None else {"kind": held.kind, "names": list(held.names), "text": held.text},
            "contact": None if contact is None else {"pair": list(contact.pair), "depth_m": contact.depth_m},
        }
