"""What mink and Pink share: a quadratic program for the next small motion, which keeps limits and distance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from protocol import Peer, Setup

STEPS, CLEARANCE_M = 40, 1e-3


@dataclass(frozen=True, kw_only=True)
class Manner:
    """How the program is posed."""

    dt_s: float = 1.0
    position_cost: float = 1.0
    orientation_cost: float | Sequence[float] = 0.0
    """A number, or one for each axis of the tool."""
    posture_cost: float = 0.0
    """Of what turns, against where it was put to begin with; 0: no such task."""
    lm_damping: float = 0.1
    damping: float = 1e-6
    approach: float
    """Share of the room between two spheres that one step may use up."""
    range_gain: float
    """The same of the room to the end of a range."""
    speed: np.ndarray | None = None
    """[N] m/s or rad/s; None for any."""
    is_split: bool = False
    """True if several steps share what the speed allows in one `dt_s`."""
    solver: str = "daqp"
    solver_options: Mapping[str, float] = field(default_factory=dict)

    @property
    def frame_costs(self) -> dict[str, Any]:
        """What both libraries' `FrameTask` is made with."""
        names = ("position_cost", "orientation_cost", "lm_damping")
        return {name: getattr(self, name) for name in names}


class Program:
    """One library's model of a robot and its program."""

    task: Any
    """The library's `FrameTask`."""
    posture: Any = None
    """The library's `PostureTask`, if there is one."""
    span: Any = None
    """What a split sample may still use: its `centre` is where the sample began."""

    @property
    def tasks(self) -> list[Any]:
        """All that cost."""
        return [self.task] if self.posture is None else [self.task, self.posture]

    def begin(self, q: np.ndarray) -> Any:
        """The configuration at joint values [N], from now on the posture that is cheapest."""
        configuration = self.configure(q)
        if self.posture is not None:
            self.posture.set_target_from_configuration(configuration)
        return configuration

    def pose(self, p: np.ndarray, R: np.ndarray) -> Any:
        """The library's SE3."""
        raise NotImplementedError

    def configure(self, q: np.ndarray) -> Any:
        """The library's configuration at joint values [N]."""
        raise NotImplementedError

    def rotation(self, configuration: Any) -> np.ndarray:
        """R_world_tool [3, 3]."""
        raise NotImplementedError

    def step(self, configuration: Any) -> np.ndarray | None:
        """The velocity of the next step, None if the program has no answer."""
        raise NotImplementedError


class Span:
    """Joint values that the speed limits leave to one sample, however many steps it takes."""

    def __init__(self, reach: np.ndarray) -> None:
        self.reach, self.centre = reach, np.zeros(len(reach))
        self.G = np.vstack([np.eye(len(reach)), -np.eye(len(reach))])

    def room(self, q: np.ndarray) -> np.ndarray:
        """[2 N] up and down from joint values [N]."""
        moved = q - self.centre
        return np.concatenate([self.reach - moved, self.reach + moved])


class Differential(Peer):
    """Gauss-Newton steps from a collision-free configuration, started again when they lead nowhere."""

    program: Program
    manner: Manner

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """SE3."""
        return self.program.pose(p, R)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Runs from collision-free seeds."""
        self.program.task.set_target(target)
        draw = self.setup.checker.draw_free
        return self.restart(lambda: self.descend(self.program.configure(draw())), deadline)

    def descend(self, configuration: Any) -> np.ndarray | None:
        """One run."""
        program, dt_s = self.program, self.manner.dt_s
        for _ in range(STEPS):
            error = program.task.compute_error(configuration)
            if self.setup.keeps(error[:3], error[3:]):
                return configuration.q.copy()
            v = program.step(configuration)
            if v is None:
                return None
            configuration.integrate_inplace(v, dt_s)
        return None


def orientation_cost(setup: Setup) -> float:
    """Cost of the frame task's turn in both."""
    return 0.5 if setup.is_pose else 0.0
