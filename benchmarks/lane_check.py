"""A collision check in lanes, which bulk searches do without: one at a time stops at the first pair that touches."""

from ikde.kernels.arrays import RobotArrays
from ikde.model.generate import functions
from ikde.model.generate.collision import Test, find_root, write_margin
from ikde.model.generate.kinematics import write_bodies
from ikde.model.generate.writer import Writer


def format_judge(robot: RobotArrays, tests: list[Test]) -> str:
    """`judge_lanes`: the smallest margin of every lane, without a branch."""
    writer = Writer()
    root = find_root(robot, tests)
    poses = write_bodies(writer, robot, root)
    margins = [write_margin(writer, poses, test, root) for test in tests]
    while len(margins) > 1:  # a tree, so that neighbours do not wait for each other
        halves = zip(margins[::2], margins[1::2], strict=False)
        odd = margins[-1:] if len(margins) % 2 else []
        margins = [writer.let(f"least_{a}", f"min({a}, {b})") for a, b in halves] + odd
    lines = writer.lines(margins, set())
    load = [f"q{k} = q[{functions._lane(k)}]" for k in functions._coordinates(robot)]
    body = [*lines, f"out_free[i] = {margins[0] if margins else '1.0'} > 0.0"]
    loop = [*functions._used([*load, *functions._sines(robot)], body), *body]
    return functions._function(
        "judge_lanes(collision, q, out_free)",
        "Whether each lane of `q` [N * LANES] is free of self-collision, into `out_free` [LANES].",
        [*functions._reaches(tests), "for i in range(LANES):", *(functions.INDENT + line for line in loop)],
    )
