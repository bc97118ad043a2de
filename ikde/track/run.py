"""A loaded track file run as it says, or with what the caller wants otherwise."""

from ikde.errors import InputError
from ikde.solver.joints import JointValues
from ikde.track.follow_path import follow_path
from ikde.track.plan import TrackPlan
from ikde.track.spec import Drive, TrackMethod
from ikde.track.trajectory import Trajectory


def run_track(
    plan: TrackPlan,
    *,
    method: TrackMethod | None = None,
    drive: Drive | None = None,
    seed: int | None = None,
    start: JointValues | None = None,
) -> Trajectory:
    """Follow a track file's path inside its limits.

    Args:
        plan: what `load_track` gives.
        method: `continuation`, or one of the paper's; None for the plan's.
        drive: `differential` or `omnidirectional`; None for the plan's.
        seed: same seed, same bits; None for the plan's.
        start: the configuration at the first pose, [N] or by joint name, m and rad; None for the plan's.

    Returns:
        The motion, as far as it goes. `stop` says where and why it ended before the path did.

    Raises:
        InputError: for what is no plan, an unknown method or drive, and a start that is elsewhere or collides.
        FileError: the same, with file, line and key, if that is what the file says.
    """
    if not isinstance(plan, TrackPlan):
        raise InputError(f"expected what `load_track` gives, got {type(plan).__name__}; `follow_path` takes a path")
    plan = plan.with_changes(method=method, drive=drive, seed=seed, start=start)
    try:
        return follow_path(
            plan.robot,
            plan.path,
            drive=plan.drive,
            method=plan.method,
            limits=plan.limits,
            start=plan.start,
            seed=plan.seed,
            collision=plan.collision,
        )
    except InputError as error:
        if not error.where or error.where[0] in plan.replaced:
            raise
        raise plan.blame(error.message, error.where) from None
