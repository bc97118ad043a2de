"""How many answers have a joint that a full turn inside its limits would bring nearer to `near`, else home.

    python -m benchmarks.turns                 # ours, 300 poses of each robot
    PYTHONPATH=../other_checkout python benchmarks/turns.py

Public calls only, so that any checkout can be asked. One call a target, then many at once, with and without `near`.
"""

import numpy as np

import ikde

COUNT = 300
ROBOTS = ("ur5", "panda", "qiao2021")


def count_wound(robot: ikde.Robot, Q: np.ndarray, centre: np.ndarray) -> int:
    """Rows of `Q` [T, N] with a joint that one turn inside the limits brings nearer to `centre` [N]."""
    wound = np.zeros(len(Q), dtype=bool)
    turning = np.array([joint.kind != "prismatic" for joint in robot.joints])
    for turned in (Q - 2.0 * np.pi, Q + 2.0 * np.pi):
        nearer = np.abs(turned - centre) < np.abs(Q - centre) - 1e-9
        wound |= (nearer & turning & (robot.lower <= turned) & (turned <= robot.upper)).any(axis=1)
    return int(wound.sum())


def measure(name: str) -> dict[str, str]:
    """How many of the reached answers are wound up, by how they were asked for."""
    robot, rng = ikde.load_robot(name), np.random.default_rng(0)
    T = ikde.forward(robot, rng.uniform(robot.lower, robot.upper, (COUNT, len(robot.joints))))["tool"]
    targets = [ikde.Target(pose[:3, 3], R_world_tool=pose[:3, :3]) for pose in T]
    near, told = rng.uniform(robot.lower, robot.upper), {}
    for words, centre, options in (("", robot.home, {}), (", near", near, {"near": near})):
        rows = ikde.solve_many(robot, targets, **options)
        ones = [ikde.solve(robot, target, **options) for target in targets]
        single = np.array([result.q for result in ones if result.reached])
        for how, Q in ((f"many{words}", rows.q[rows.reached]), (f"one{words}", single)):
            told[how] = f"{count_wound(robot, Q, centre)} of {len(Q)}"
    return told


def main() -> None:
    """Print a line a robot."""
    for name in ROBOTS:
        print(f"{name:10}" + "   ".join(f"{how}: {count}" for how, count in measure(name).items()), flush=True)


if __name__ == "__main__":
    main()
