"""What one call of `ikde.velocity` costs, beside mink and Pink on the same robot, tasks and limits.

    python benchmarks/velocity.py             # those that are installed; --calls 200

Of a UR5e on mecanum wheels: the tool's pose; and the base's place; and a value of the elbow. mink and Pink weigh their
tasks against each other in one quadratic program (100, 10 and 1, solver daqp); ikde serves them in order of priority.
Ranges and speeds are limited in all three. `far`: the target is out of reach, so speeds are at their limits. Each call
is at another configuration; the figure is the least of the rounds' medians, of the processor's time.
"""

import argparse
import tempfile
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import ikde
from ikde.track.limits import MotionLimits

ROBOT, DT_S, ROUNDS = "ur5e_mecanum", 0.01, 7
START = np.array([0, 0, 0, np.pi, -1.9, 1.9, -1.57, -1.57, 0.0])
BASE, ELBOW = np.array([-0.25, 0.15, 0.3]), 1.5
COSTS = (100.0, 10.0, 1.0)
CASES = {"1 task": (1, 0.05), "2 tasks": (2, 0.05), "3 tasks": (3, 0.05), "3 tasks, far": (3, 2.0)}

Call = Callable[[np.ndarray], object]


def make_ikde(robot: ikde.Robot, pose: np.ndarray, count: int) -> Call:
    """In order of priority."""
    tasks = [
        ikde.VelocityTask.tool(pose, gain=2.0),
        ikde.VelocityTask.base(BASE),
        ikde.VelocityTask.joints({"elbow_joint": ELBOW}),
    ][:count]
    return lambda q: ikde.velocity(robot, q, tasks, dt_s=DT_S)


def make_mink(robot: ikde.Robot, pose: np.ndarray, count: int) -> Call:
    """By weights, on MuJoCo."""
    import mink
    import mujoco

    model = mujoco.MjModel.from_xml_string(ikde.format_mjcf(robot, collision="none"))
    configuration = mink.Configuration(model)
    speed = MotionLimits.of(robot).speed
    limits = [
        mink.ConfigurationLimit(model),
        mink.VelocityLimit(model, dict(zip(robot.joint_names, speed, strict=True))),
    ]
    tool = mink.FrameTask(robot.tool, "body", position_cost=COSTS[0], orientation_cost=0.3 * COSTS[0], gain=2.0 * DT_S)
    tool.set_target(mink.SE3.from_matrix(pose))
    base = mink.PostureTask(model, cost=np.r_[COSTS[1] * np.ones(3), np.zeros(6)], gain=DT_S)
    base.set_target(np.r_[BASE, START[3:]])
    elbow = mink.PostureTask(model, cost=COSTS[2] * (np.arange(9) == 5), gain=DT_S)
    elbow.set_target(np.r_[START[:5], ELBOW, START[6:]])
    tasks = [tool, base, elbow][:count]

    def call(q: np.ndarray) -> object:
        configuration.update(q)
        return mink.solve_ik(configuration, tasks, DT_S, "daqp", damping=1e-6, limits=limits)

    return call


def make_pink(robot: ikde.Robot, pose: np.ndarray, count: int) -> Call:
    """By weights, on Pinocchio."""
    import pink
    import pinocchio
    from pink.limits import ConfigurationLimit, VelocityLimit
    from pink.tasks import FrameTask, PostureTask

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.urdf"
        file.write_text(ikde.format_urdf(robot, collision="none"))
        model = pinocchio.buildModelFromUrdf(str(file))
    data, speed = model.createData(), MotionLimits.of(robot).speed
    limits = [ConfigurationLimit(model), VelocityLimit(model, speed)]
    tool = FrameTask(robot.tool, position_cost=COSTS[0], orientation_cost=0.3 * COSTS[0], gain=2.0 * DT_S)
    tool.set_target(pinocchio.SE3(pose))

    def stretch(q: np.ndarray) -> np.ndarray:
        return np.r_[q[:2], np.cos(q[2]), np.sin(q[2]), q[3:]]  # a joint without limits

    base = PostureTask(cost=np.r_[COSTS[1] * np.ones(3), np.zeros(6)], gain=DT_S)
    base.set_target(stretch(np.r_[BASE, START[3:]]))
    elbow = PostureTask(cost=COSTS[2] * (np.arange(9) == 5), gain=DT_S)
    elbow.set_target(stretch(np.r_[START[:5], ELBOW, START[6:]]))
    tasks = [tool, base, elbow][:count]

    def call(q: np.ndarray) -> object:
        configuration = pink.Configuration(model, data, stretch(q), copy_data=False)
        return pink.solve_ik(configuration, tasks, DT_S, solver="daqp", damping=1e-6, limits=limits, safety_break=False)

    return call


MAKERS = {"ikde": make_ikde, "mink": make_mink, "Pink": make_pink}
NEEDS = {"ikde": (), "mink": ("mink", "daqp"), "Pink": ("pink", "daqp")}


def measure(call: Call, configurations: np.ndarray) -> float:
    """Median of one round, us."""
    seconds = []
    for q in configurations:
        began = time.process_time()
        call(q)
        seconds.append(time.process_time() - began)
    return 1e6 * float(np.median(seconds))


def main() -> None:
    """A table, a row a case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", type=int, default=100)
    calls = parser.parse_args().calls
    robot = ikde.load_robot(ROBOT)
    names = [name for name, needed in NEEDS.items() if all(find_spec(package) for package in needed)]
    configurations = START + 0.1 * np.random.default_rng(0).standard_normal((calls, 9))
    print("| case |", " | ".join(f"{name} [us]" for name in names), "|")
    print("|---|" + "---|" * len(names))
    for case, (count, ahead_m) in CASES.items():
        pose = ikde.forward(robot, START)["tool"].copy()
        pose[0, 3] += ahead_m
        made = {name: MAKERS[name](robot, pose, count) for name in names}
        for call in made.values():
            call(START)
        rounds = [{name: measure(call, configurations) for name, call in made.items()} for _ in range(ROUNDS)]
        least = [min(one[name] for one in rounds) for name in names]
        print(f"| {case} |", " | ".join(f"{value:.0f}" for value in least), "|")


if __name__ == "__main__":
    main()
