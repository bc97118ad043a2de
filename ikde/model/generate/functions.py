"""The functions that a module brings for its robot, as text: a step, the same in lanes, and the collision check."""

import numpy as np

from ikde.kernels.arrays import COORDINATE, PRISMATIC, Floats, RobotArrays
from ikde.kernels.tables import LANES
from ikde.model.generate.collision import Test, find_root, group_by_guard, reach_name, write_margin
from ikde.model.generate.kinematics import write_bodies
from ikde.model.generate.proofs import estimate_hits
from ikde.model.generate.step import Step, write_step
from ikde.model.generate.writer import NAME, Writer

INDENT = "    "
SETTINGS = (
    "damping",
    "least_damping",
    "rotation_length",
    "largest_step",
    "position_tolerance",
    "orientation_tolerance",
)
MET = "position <= position_tolerance and orientation <= orientation_tolerance"


def format_step(robot: RobotArrays, kind: str) -> str:
    """`take_step`, the twin of `tables.take_step`."""
    writer, written = Writer(), set[str]()
    step = write_step(writer, robot, kind)
    first, rest = writer.lines([step.position, step.orientation], written), writer.lines(step.next_q, written)
    target = [f"{name} = target.T_world_tool[index, {i}, {j}]" for name, i, j in _target_names()]
    load = [f"q{k} = q[{k}]" for k in range(len(step.next_q))]
    store = [f"q[{k}] = {name}" for k, name in enumerate(step.next_q)]
    body = [*first, *_errors(step), f"if {MET}:", f"{INDENT}return position, orientation", *rest, *store]
    return _function(
        "take_step(robot, target, index, ranges, descent, q, buffers)",
        "One damped least-squares step on `q` [N] in place; returns the errors before it, m and rad.",
        [*_used([*_settings(robot), *target, *load, *_sines(robot)], body), *body, "return position, orientation"],
    )


def format_steps(robot: RobotArrays, kind: str) -> str:
    """`take_steps`, the same step in every lane: the compiler turns the loop into vector instructions."""
    writer = Writer()
    step = write_step(writer, robot, kind)
    lines = writer.lines([step.position, step.orientation, *step.next_q], set())
    target = [f"{name} = T[{_lane(4 * i + j)}]" for name, i, j in _target_names()]
    load = [f"q{k} = q[{_lane(k)}]" for k in range(len(step.next_q))]
    store = [f"q[{_lane(k)}] = q{k} if met else {name}" for k, name in enumerate(step.next_q)]
    body = [*lines, *_errors(step), f"met = {MET}", *store]
    body += [f"errors[{_lane(0)}] = position", f"errors[{_lane(1)}] = orientation"]
    loop = [*_used([*target, *load, *_sines(robot)], body), *body]
    return _function(
        "take_steps(robot, target, row, ranges, descent, q, T, errors, trial, buffers)",
        "A step in every lane: `q` [N * LANES], `T` [12 * LANES], `errors` [2 * LANES] in m and rad.",
        [*_used(_settings(robot), loop), "for i in range(LANES):", *(INDENT + line for line in loop)],
    )


def format_find(robot: RobotArrays, tests: list[Test], lower: Floats, upper: Floats) -> str:
    """`find_collision`, the twin of `tables.find_collision`: pair by pair, those that collide most often first."""
    writer, written = Writer(), set[str]()
    root = find_root(robot, tests)
    poses = write_bodies(writer, robot, root)
    body = []
    for pair in order_pairs(robot, tests, lower, upper):
        for guard, guarded in group_by_guard(writer, poses, [test for test in tests if test.pair == pair], root):
            margins = [write_margin(writer, poses, test, root) for test in guarded]
            found = " or ".join(f"{margin} <= 0.0" for margin in margins)
            if guard is None:
                body += [*writer.lines(margins, written), f"if {found}:", f"{INDENT}return np.int64({pair})"]
                continue
            body += [*writer.lines(guard.values, written), f"if {guard.condition}:"]
            inside = [*writer.lines(margins, set(written)), f"if {found}:", f"{INDENT}return np.int64({pair})"]
            body += [INDENT + line for line in inside]
    load = [f"q{k} = q[{k}]" for k in range(len(lower))]
    return _function(
        "find_collision(robot, collision, q, buffers)",
        "Index of a pair within the safe distance at `q` [N], the likeliest first, or -1.",
        [*_reaches(tests), *_used([*load, *_sines(robot)], body), *body, "return np.int64(-1)"],
    )


def order_pairs(robot: RobotArrays, tests: list[Test], lower: Floats, upper: Floats) -> list[int]:
    """Pairs in the order in which to test them: most hits not seen before for the least work first."""
    hits = estimate_hits(robot, tests, lower, upper)
    rows = {
        pair: [k for k, test in enumerate(tests) if test.pair == pair] for pair in dict.fromkeys(t.pair for t in tests)
    }
    left, order = np.ones(hits.shape[1], dtype=bool), []
    while rows:
        best = max(rows, key=lambda pair: (hits[rows[pair]].any(axis=0) & left).sum() / len(rows[pair]))
        left &= ~hits[rows.pop(best)].any(axis=0)
        order.append(best)
    return order


def _target_names() -> list[tuple[str, int, int]]:
    rotation = [(f"m{i}{j}", i, j) for i in range(3) for j in range(3)]
    return [*rotation, *((f"t_{'xyz'[i]}", i, 3) for i in range(3))]


def _lane(row: int) -> str:
    return f"i + {row * LANES}" if row else "i"


def _settings(robot: RobotArrays) -> list[str]:
    ranges = [
        f"{side}{k} = ranges[{row}, {k}]" for k in _coordinates(robot) for row, side in enumerate(("lower", "upper"))
    ]
    return [*(f"{name} = descent.{name}" for name in SETTINGS), *ranges]


def _sines(robot: RobotArrays) -> list[str]:
    revolute = robot.bodies[1:][robot.bodies[1:, PRISMATIC] == 0]
    return [f"s{k}, c{k} = sin_cos(q{k})" for k in sorted(set(revolute[:, COORDINATE].tolist()))]


def _coordinates(robot: RobotArrays) -> list[int]:
    return sorted(set(robot.bodies[1:, COORDINATE].tolist()))


def _errors(step: Step) -> list[str]:
    """A position target has no orientation error to compute."""
    return [] if isinstance(step.orientation, str) else [f"orientation = {step.orientation!r}"]


def _reaches(tests: list[Test]) -> list[str]:
    lines = ["safe_distance = collision.safe_distance"]
    for reach in sorted({test.reach for test in tests}):
        lines.append(f"{reach_name(reach)} = ({reach!r} + safe_distance) * ({reach!r} + safe_distance)")
    return lines


def _used(lines: list[str], later: list[str]) -> list[str]:
    """Those of the lines whose names are used later on."""
    kept: list[str] = []
    names = set(NAME.findall("\n".join(later)))
    for line in reversed(lines):
        left, right = line.split(" = ", 1)
        if names.intersection(NAME.findall(left)):
            kept.append(line)
            names.update(NAME.findall(right))
    return kept[::-1]


def _function(signature: str, docstring: str, body: list[str]) -> str:
    lines = ["@leaf_kernel", f"def {signature}:", f'{INDENT}"""{docstring}"""', *(INDENT + line for line in body)]
    return "\n".join(lines) + "\n"
