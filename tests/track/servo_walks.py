"""Targets that wander, worlds for a servo to avoid, and what must hold after each of its steps, in plain numpy."""

import numpy as np

import ikde
from ikde.model.base_motion import find_wheels
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps
from ikde.solver.verify import compute_orientation_errors
from ikde.track.certify import bound_all
from ikde.track.certify_world import find_middle

ACCELERATION = {True: 2.0, False: 8.0}  # prismatic, revolute; m/s^2, rad/s^2
ROUNDING, BOUND_M = 1e-9, 1e-5


def limits_of(robot, has_acceleration=True):
    """The usual limits, with accelerations."""
    rows = np.array([ACCELERATION[bool(is_prismatic)] for is_prismatic in robot.is_prismatic])
    return ikde.MotionLimits.of(robot, acceleration=rows if has_acceleration else None)


def draw_world(robot, q, rng, count=20, away_m=0.03, kinds=("box", "sphere", "cylinder")):
    """Objects about a robot that stands free of them at `q`."""
    reach, found, world = 1.1, 0, ikde.World()
    base = ikde.forward(robot, q)[robot.tool][:2, 3] * 0.3
    while found < count:
        p = np.array([*base, 0.6]) + rng.uniform(-reach, reach, 3)
        one = ikde.read_world({"obstacles": {f"object {found}": _draw_object(p, rng, kinds)}}).world
        model = CollisionModel.of(robot).in_world(one, away_m)
        if compute_gaps(model, q)[len(model.pairs) :].min(initial=np.inf) > model.limit_m:
            world, found = world.add(*one.obstacles), found + 1
    return world


def _draw_object(p, rng, kinds):
    size = rng.uniform(0.04, 0.25, 3).tolist()
    kind = kinds[int(rng.integers(len(kinds)))]
    shape = {"box": size, "sphere": {"radius": size[0] / 2}, "cylinder": {"radius": size[0] / 2, "height": size[1]}}
    return {"position": p.tolist(), "rpy": rng.uniform(-3, 3, 3).tolist(), kind: shape[kind]}


def draw_walk(robot, q, rng, steps, dt_s, *, kind="pose", speed_m_s=0.25, jumps=0.002, away_m=0.0, into=None):
    """Targets [steps] that begin at the tool and wander about it; `away_m` draws them outwards, `into` [3] there, m."""
    T = ikde.forward(robot, q)[robot.tool]
    p, R, v, w, centre = T[:3, 3].copy(), T[:3, :3].copy(), np.zeros(3), np.zeros(3), T[:3, 3].copy()
    outwards = rng.standard_normal(3)
    centre = centre + away_m * outwards / np.linalg.norm(outwards) if into is None else np.array(into)
    targets = []
    for _ in range(steps):
        v += dt_s * (-v - 1.0 * (p - centre)) + np.sqrt(dt_s) * speed_m_s * rng.standard_normal(3)
        w += dt_s * -w + np.sqrt(dt_s) * 0.5 * rng.standard_normal(3)
        if rng.random() < jumps:
            p += 0.2 * rng.standard_normal(3)
        p, R = p + dt_s * v, _turn(dt_s * w) @ R
        turned = {"pose": {"R_world_tool": R}, "axis": {"axis_world_tool": R[:, 2]}, "position": {}}[kind]
        targets.append(ikde.Target(p, **turned))
    return targets


def _turn(rotation):
    angle = np.linalg.norm(rotation)
    x, y, z = rotation / max(angle, 1e-12)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def find_offences(servo, starts, steps, dt_s, drive, *, certifies=True):
    """What a walk's steps broke, in words: speeds, accelerations, ranges, and what of ways to a stop is not free."""
    robot, limits, model = servo.robot, servo.limits, servo.collision
    offences = []
    q = np.array([starts, *[step.q for step in steps]])
    stops = np.array([step.q_stop for step in steps])
    dq = np.array([np.zeros(len(starts)), *[step.dq for step in steps]])
    speed = np.sqrt(dq[:, 0] ** 2 + dq[:, 1] ** 2) if drive == "differential" else None
    checked = slice(2, None) if speed is not None else slice(None)
    if (np.abs(dq[:, checked]) > limits.speed[checked] * (1 + 1e-9) + 1e-12).any():
        offences.append("speed")
    if speed is not None and (speed > min(limits.speed[:2]) * (1 + 1e-9)).any():
        offences.append("speed of the base")
    if limits.acceleration is not None:
        change = np.abs(np.diff(dq[:, checked], axis=0)) / dt_s
        if (change > limits.acceleration[checked] * (1 + 1e-9) + 1e-9).any():
            offences.append("acceleration")
    for name, rows in (("q", q), ("stop", stops)):
        if (rows < robot.lower - ROUNDING).any() or (rows > robot.upper + ROUNDING).any():
            offences.append(f"range of {name}")
    return offences + find_collisions(model, q[:-1], stops, drive, certifies=certifies)


def find_collisions(model, q, stops, drive, *, certifies):
    """What of the straight ways (of a base: arcs) from `q` [M, N] to `stops` [M, N] is not free.

    At both ends and three places between, and by the certificate, whose bound may miss by a rounding's width of it.
    """
    if not model.pairs:
        return []
    base, offences = find_wheels(model.robot, drive), []
    middle = find_middle(q, stops, base)
    places = {"standing": q, "quarter": find_middle(q, middle, base), "middle": middle}
    places |= {"third quarter": find_middle(middle, stops, base), "stop": stops}
    for name, rows in places.items():
        room = compute_gaps(model, rows).min(axis=1) - model.limit_m
        if room.min() <= 0.0:
            offences.append(f"{name} {int(room.argmin())}: {room.min():.2g} m")
    if certifies:
        rows = np.empty((2 * len(q), q.shape[1]))
        rows[::2], rows[1::2] = q, stops
        bounds = bound_all(model, rows, drive)[::2].min(axis=1)
        if bounds.min() <= -BOUND_M:
            offences.append(f"way {int(bounds.argmin())}: {bounds.min():.2g} m")
    return offences


def tool_error(robot, q, target, length_m):
    """The servo's one error: of the position, and of the rotation times a length, m; by plain numpy."""
    T = ikde.forward(robot, q)[robot.tool]
    targets = ikde.Targets.of([target])
    turn = compute_orientation_errors(targets, T[None, :3, :3])[0]
    return float(np.hypot(np.linalg.norm(T[:3, 3] - target.p_world_tool), length_m * turn))
