"""What will be followed: a path, and all that its motion depends on, with every name resolved, in m, rad and s."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Self, TypedDict, TypeVar, Unpack

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.base_motion import base_carries, find_wheels, usual_drive
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Drive, Robot
from ikde.solver.joints import JointValues, read_configuration
from ikde.solver.problem import Freeze, make_problem
from ikde.solver.settings import SolveSettings, check_seed
from ikde.track.limits import MotionLimits
from ikde.track.moving import Moving, MovingWorld, check_moving, place_at
from ikde.track.path import ToolPath
from ikde.track.settings import TrackSettings, check_method
from ikde.track.spec import TrackMethod

NO_MECANUM_LIMIT = "a track limits the wheel speed of a differential drive alone, not of a mecanum one"

Settings = TypeVar("Settings", bound=TrackSettings)


class Moves(TypedDict, total=False):
    """What moves about a robot."""

    moving: Moving


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TrackPlan:
    """Everything about a track but where its motion goes.

    Raises:
        InputError: for an unknown method or drive, for a drive or limits that do not fit the robot, and for settings
            of another method.
    """

    name: str
    collision: CollisionModel
    """What counts as self-collision, of the robot with the ranges that the file asks for."""
    path: ToolPath
    drive: Drive
    method: TrackMethod
    limits: MotionLimits
    start: Floats | None
    """Configuration to start in [N], m and rad; None to choose one."""
    seed: int
    frozen: Mapping[str, float] = field(default_factory=dict)
    """Joints that must not move, and where they stand, m or rad."""
    settings: TrackSettings | None = None
    """Of the method; None for its usual ones."""
    file: str | None = None
    """The file it was read from, for the record only."""
    world_file: str | None = None
    """That of the world, as it was named there, likewise."""
    moving: Moving = field(default_factory=dict)
    """Obstacles of the world that move; the collision model has them where they are at the start."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "seed", check_seed(self.seed))
        check_method(self.method, self.settings)
        find_wheels(self.robot, self.drive)
        self.limits.check(self.robot)
        if self.drive == "mecanum" and self.limits.wheel_speed_rad_s is not None and self.method != "typical":
            raise InputError(NO_MECANUM_LIMIT, ("limits", "wheel_speed_rad_s"))
        check_moving(self.collision, self.moving, self.path.duration_s)
        if self.moving and self.method != "continuation":
            message = f"obstacles that move need the method continuation, {self.method} does not know them"
            raise InputError(message, ("moving",))
        object.__setattr__(self, "collision", place_at(self.collision, self.moving, 0.0))
        if self.base_drive == "differential" and not base_carries(self.collision):
            message = "a base on arcs must carry all that can collide; say omnidirectional, or leave out the rest"
            raise InputError(message, ("detector",))

    @classmethod
    def of(
        cls,
        robot: Robot,
        path: ToolPath,
        *,
        drive: Drive | None = None,
        method: TrackMethod = "continuation",
        limits: MotionLimits | None = None,
        start: JointValues | None = None,
        seed: int = 0,
        collision: CollisionChoice = None,
        freeze: Freeze | None = None,
        settings: TrackSettings | None = None,
        **moves: Unpack[Moves],
    ) -> Self:
        """A path, with what `follow_path` takes; raises `InputError` for what does not fit the robot."""
        q = None if start is None else read_start(robot, start)
        if moving := moves.get("moving"):
            collision = CollisionModel.of(robot, collision)
            check_moving(collision, moving, path.duration_s)
            collision = place_at(collision, moving, 0.0)  # where the world has it does not matter
        problem = make_problem(robot, SolveSettings(), collision=collision, near=q, freeze=freeze)
        return cls(
            name=path.name,
            collision=problem.collision,
            path=path,
            drive=usual_drive(robot) if drive is None else drive,
            method=method,
            limits=MotionLimits.of(robot) if limits is None else limits,
            start=q,
            seed=seed,
            frozen={name: float(problem.lower[robot.joint_names.index(name)]) for name in problem.frozen},
            settings=settings,
            **moves,
        )

    def __repr__(self) -> str:
        asked = f"{self.robot.name}, {self.method}, {self.drive}, {self.path.samples} points"
        return f"<TrackPlan {self.name}: {asked}>"

    @property
    def robot(self) -> Robot:
        """The robot of the collision model."""
        return self.collision.robot

    @property
    def base_drive(self) -> Drive:
        """How the base moves: `typical` ignores the drive, every joint moves independently."""
        return "omnidirectional" if self.method == "typical" else self.drive

    def make_moving(self) -> MovingWorld | None:
        """The obstacles that move, made ready; None where none does."""
        return MovingWorld.of(self.collision, self.moving, self.path.times_s)

    def settings_of(self, kind: type[Settings]) -> Settings:
        """The settings of a method: the plan's own if they are of this kind, else the usual ones."""
        return self.settings if isinstance(self.settings, kind) else kind()

    def with_changes(
        self,
        *,
        method: TrackMethod | None = None,
        drive: Drive | None = None,
        seed: int | None = None,
        start: JointValues | None = None,
    ) -> Self:
        """The plan with this instead of what its file says; None for what stays. `start` is in m and rad.

        Raises:
            InputError: as the plan itself, for a start that does not fit the robot, and for a drive without wheels
                whose speed is limited.
        """
        q = None if start is None else read_start(self.robot, start)
        given = {"method": method, "drive": drive, "seed": seed, "start": q}
        plan = replace(self, **{key: value for key, value in given.items() if value is not None})
        has_limit = plan.limits.wheel_speed_rad_s is not None and plan.method != "typical"  # which keeps none
        if plan.drive == "omnidirectional" and has_limit:
            raise InputError(f"an omnidirectional drive has no wheels, but {self.name} limits their speed", ("drive",))
        return plan


def read_start(robot: Robot, start: JointValues) -> Floats:
    """A given start as an array [N]; raises `InputError` at `start` for what is none."""
    try:
        return read_configuration(robot, start)
    except InputError as error:
        raise InputError(error.message, ("start", *error.where[1:])) from None
