"""Inverse kinematics for arms and mobile manipulators, clear of themselves and of obstacles, on a CPU.

A target is reached if it is met, inside the joint limits, and neither the robot nor a world is in the way. Robots ship
with ikde, or come from a URDF or a file of yours.

Names are imported when they are first used, so `import ikde` costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # what type checkers and editors see; `tests/test_api.py` holds it to `_HOME`
    from ikde.batch.read import read_batch as read_batch
    from ikde.batch.run import run_batch as run_batch
    from ikde.errors import FileError as FileError
    from ikde.errors import IkdeError as IkdeError
    from ikde.errors import InputError as InputError
    from ikde.errors import VerificationError as VerificationError
    from ikde.io.goal_file import load_goal as load_goal
    from ikde.io.mjcf import format_mjcf as format_mjcf
    from ikde.io.plan_file import load_batch as load_batch
    from ikde.io.plan_file import load_track as load_track
    from ikde.io.robots import load_robot as load_robot
    from ikde.io.robots import robot_names as robot_names
    from ikde.io.trajectory_files import write_trajectory as write_trajectory
    from ikde.io.urdf import format_urdf as format_urdf
    from ikde.io.urdf_import.imported import ImportedUrdf as ImportedUrdf
    from ikde.io.urdf_import.options import ImportOptions as ImportOptions
    from ikde.io.urdf_import.read_urdf import import_urdf as import_urdf
    from ikde.io.urdf_import.read_urdf import read_urdf as read_urdf
    from ikde.io.world_file import load_world as load_world
    from ikde.io.world_file import read_world as read_world
    from ikde.io.world_writer import write_world as write_world
    from ikde.kernels.jit import compile_clock as compile_clock
    from ikde.model.base_region import BaseRegion as BaseRegion
    from ikde.model.collision_model import CollisionModel as CollisionModel
    from ikde.model.compose import compose as compose
    from ikde.model.convention import from_convention as from_convention
    from ikde.model.convention import to_convention as to_convention
    from ikde.model.region import Region as Region
    from ikde.model.robot import Detector as Detector
    from ikde.model.robot import Robot as Robot
    from ikde.model.target import Target as Target
    from ikde.model.target import Targets as Targets
    from ikde.model.world import World as World
    from ikde.paper.surface import check_surface as check_surface
    from ikde.solver.analysis import Analysis as Analysis
    from ikde.solver.analysis import analyze as analyze
    from ikde.solver.check import CheckResult as CheckResult
    from ikde.solver.check import CheckResults as CheckResults
    from ikde.solver.check import check as check
    from ikde.solver.check import check_many as check_many
    from ikde.solver.clear_cloud import clear_cloud as clear_cloud
    from ikde.solver.distinct import solve_distinct as solve_distinct
    from ikde.solver.families import family as family
    from ikde.solver.forward import forward as forward
    from ikde.solver.jacobian import jacobian as jacobian
    from ikde.solver.result import SolveResult as SolveResult
    from ikde.solver.result import StopReason as StopReason
    from ikde.solver.settings import BulkOptions as BulkOptions
    from ikde.solver.settings import DeSettings as DeSettings
    from ikde.solver.settings import SolveSettings as SolveSettings
    from ikde.solver.solve import solve as solve
    from ikde.solver.solve import solve_many as solve_many
    from ikde.solver.verify import Grade as Grade
    from ikde.solver.verify import verify as verify
    from ikde.track.follow_path import follow_path as follow_path
    from ikde.track.limits import MotionLimits as MotionLimits
    from ikde.track.moving import ObjectMotion as ObjectMotion
    from ikde.track.path import ToolPath as ToolPath
    from ikde.track.run import run_track as run_track
    from ikde.track.servo import Servo as Servo
    from ikde.track.servo_result import ServoStep as ServoStep
    from ikde.track.settings import ContinuationSettings as ContinuationSettings
    from ikde.track.settings import OptimizedSettings as OptimizedSettings
    from ikde.track.settings import TypicalSettings as TypicalSettings
    from ikde.track.trajectory import TrackStop as TrackStop
    from ikde.track.trajectory import TrackStopReason as TrackStopReason
    from ikde.track.trajectory import Trajectory as Trajectory
    from ikde.track.velocity import VelocityResult as VelocityResult
    from ikde.track.velocity import velocity as velocity
    from ikde.track.velocity_task import VelocityTask as VelocityTask

__version__ = "0.1.0"

_HOME = {
    "load_batch": "ikde.io.plan_file",
    "run_batch": "ikde.batch.run",
    "read_batch": "ikde.batch.read",
    "load_track": "ikde.io.plan_file",
    "run_track": "ikde.track.run",
    "follow_path": "ikde.track.follow_path",
    "ObjectMotion": "ikde.track.moving",
    "Servo": "ikde.track.servo",
    "ServoStep": "ikde.track.servo_result",
    "ToolPath": "ikde.track.path",
    "MotionLimits": "ikde.track.limits",
    "ContinuationSettings": "ikde.track.settings",
    "OptimizedSettings": "ikde.track.settings",
    "TypicalSettings": "ikde.track.settings",
    "Trajectory": "ikde.track.trajectory",
    "TrackStop": "ikde.track.trajectory",
    "TrackStopReason": "ikde.track.trajectory",
    "write_trajectory": "ikde.io.trajectory_files",
    "velocity": "ikde.track.velocity",
    "VelocityResult": "ikde.track.velocity",
    "VelocityTask": "ikde.track.velocity_task",
    "load_robot": "ikde.io.robots",
    "robot_names": "ikde.io.robots",
    "load_goal": "ikde.io.goal_file",
    "load_world": "ikde.io.world_file",
    "read_world": "ikde.io.world_file",
    "write_world": "ikde.io.world_writer",
    "World": "ikde.model.world",
    "format_urdf": "ikde.io.urdf",
    "import_urdf": "ikde.io.urdf_import.read_urdf",
    "read_urdf": "ikde.io.urdf_import.read_urdf",
    "ImportOptions": "ikde.io.urdf_import.options",
    "ImportedUrdf": "ikde.io.urdf_import.imported",
    "format_mjcf": "ikde.io.mjcf",
    "CollisionModel": "ikde.model.collision_model",
    "Robot": "ikde.model.robot",
    "Detector": "ikde.model.robot",
    "Target": "ikde.model.target",
    "Targets": "ikde.model.target",
    "Region": "ikde.model.region",
    "BaseRegion": "ikde.model.base_region",
    "BulkOptions": "ikde.solver.settings",
    "SolveSettings": "ikde.solver.settings",
    "DeSettings": "ikde.solver.settings",
    "SolveResult": "ikde.solver.result",
    "StopReason": "ikde.solver.result",
    "solve": "ikde.solver.solve",
    "solve_many": "ikde.solver.solve",
    "solve_distinct": "ikde.solver.distinct",
    "family": "ikde.solver.families",
    "forward": "ikde.solver.forward",
    "jacobian": "ikde.solver.jacobian",
    "check": "ikde.solver.check",
    "analyze": "ikde.solver.analysis",
    "Analysis": "ikde.solver.analysis",
    "check_many": "ikde.solver.check",
    "clear_cloud": "ikde.solver.clear_cloud",
    "check_surface": "ikde.paper.surface",
    "CheckResult": "ikde.solver.check",
    "CheckResults": "ikde.solver.check",
    "verify": "ikde.solver.verify",
    "Grade": "ikde.solver.verify",
    "compose": "ikde.model.compose",
    "from_convention": "ikde.model.convention",
    "to_convention": "ikde.model.convention",
    "compile_clock": "ikde.kernels.jit",
    "IkdeError": "ikde.errors",
    "InputError": "ikde.errors",
    "FileError": "ikde.errors",
    "VerificationError": "ikde.errors",
}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'ikde' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME[name]), name)  # the next look-up does not come here: 9 us
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
