"""Naive twins of the kernels: each written from its formula, slow and obvious, in numpy, scipy and Python integers.

Bodies are computed from `RobotArrays`, the kernel's own input. Frames, the Jacobian, sphere centres and everything
that follows from them are computed from the `Robot` itself, so comparing them with a kernel checks `pack` as well.
"""

import numpy as np
from scipy.spatial.transform import Rotation

WORD = 2**64
GOLDEN, MIX_1, MIX_2 = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


# ---- random numbers


def mix(z):
    """The finaliser of splitmix64 [Steele2014, figure 14, variant 13], in Python integers."""
    z = ((z ^ (z >> 30)) * MIX_1) % WORD
    z = ((z ^ (z >> 27)) * MIX_2) % WORD
    return z ^ (z >> 31)


class Stream:
    """A splitmix64 stream [Steele2014]: the state moves on by the golden gamma, the output is its mix."""

    def __init__(self, state):
        self.state = state

    @classmethod
    def for_attempt(cls, seed, target_index, attempt):
        """The stream of one attempt, by the mixing that `seed_stream` documents."""
        word = mix((seed + GOLDEN) % WORD)
        word = mix(word ^ ((target_index * GOLDEN + MIX_1) % WORD))
        return cls(mix(word ^ ((attempt * GOLDEN + MIX_2) % WORD)))

    def word(self):
        """The next 64 bits."""
        self.state = (self.state + GOLDEN) % WORD
        return mix(self.state)

    def uniform(self):
        """The next double in [0, 1): the upper 53 bits as a fraction."""
        return (self.word() >> 11) / 2**53

    def index(self, count):
        """The next integer in 0 .. count-1."""
        return int(self.uniform() * count)


# ---- kinematics


def homogeneous(T):
    """[4, 4] from the upper three rows [3, 4]."""
    return np.vstack([T, [0.0, 0.0, 0.0, 1.0]])


def make_transform(R, p):
    """[4, 4] from a rotation and a translation."""
    return homogeneous(np.column_stack([R, p]))


def compute_bodies(arrays, q):
    """T_world_body [B, 4, 4] from `RobotArrays`: T_parent @ T_local @ (Rz(q) or Tz(q)) [Qiao2021, eq. 3, 5-9]."""
    T_world_body = [np.eye(4)]
    for body in range(1, len(arrays.bodies)):
        parent, coordinate, slides, _ = arrays.bodies[body]
        c, s, value = np.cos(q[coordinate]), np.sin(q[coordinate]), q[coordinate]
        turn = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        slide = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, value], [0, 0, 0, 1]])
        local = homogeneous(arrays.T_parent_body[body])
        T_world_body.append(T_world_body[parent] @ local @ (slide if slides else turn))
    return np.array(T_world_body)


def compute_frames(robot, q):
    """Frame name -> T_world_frame [4, 4], from the `Robot` [Qiao2021, eq. 3, 5-9]; rotations by scipy."""
    T_world = {"world": np.eye(4)}
    for frame in robot.frames:
        T = T_world[frame.parent] @ make_transform(frame.R_parent_frame, frame.p_parent_frame)
        if frame.joint is not None:
            index = robot.joint_names.index(frame.joint)
            if robot.joints[index].kind == "prismatic":
                T = T @ make_transform(np.eye(3), q[index] * frame.axis)
            else:
                T = T @ make_transform(Rotation.from_rotvec(q[index] * frame.axis).as_matrix(), np.zeros(3))
        T_world[frame.name] = T
    return T_world


def compute_jacobian(robot, q):
    """Geometric Jacobian of the tool [6, N]: (z x (p_tool - p_joint), z) for a turn, (z, 0) for a slide."""
    T_world = compute_frames(robot, q)
    frames = {frame.name: frame for frame in robot.frames}
    jacobian = np.zeros((6, len(robot.joints)))
    name = robot.tool
    while name != "world":
        frame = frames[name]
        if frame.joint is not None:
            index = robot.joint_names.index(frame.joint)
            z = T_world[name][:3, :3] @ frame.axis
            if robot.joints[index].kind == "prismatic":
                jacobian[:3, index] = z
            else:
                jacobian[:3, index] = np.cross(z, T_world[robot.tool][:3, 3] - T_world[name][:3, 3])
                jacobian[3:, index] = z
        name = frame.parent
    return jacobian


def compute_position_error(T_world_tool, target):
    """Euclidean distance, m."""
    return np.linalg.norm(T_world_tool[:3, 3] - target.p_world_tool)


def compute_orientation_error(T_world_tool, target):
    """Norm of the rotation vector by scipy; the angle between two unit vectors by 2 atan2(|a - b|, |a + b|) (Kahan)."""
    if target.kind == "position":
        return 0.0
    if target.kind == "axis":
        a, b = T_world_tool[:3, 2], target.R_world_tool[:, 2]
        return 2.0 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))
    return Rotation.from_matrix(target.R_world_tool.T @ T_world_tool[:3, :3]).magnitude()


# ---- spheres


def place_row(row, start, end):
    """Centres of a row between two points: multiples of 2R about the middle, or even [Qiao2021, eq. 12, 13, 16]."""
    if row.count == 1:
        return [0.5 * (start + end)]
    if row.spacing == "even":
        return [start + k / (row.count - 1) * (end - start) for k in range(row.count)]
    direction = (end - start) / np.linalg.norm(end - start)
    middle = 0.5 * (start + end)
    return [middle + (k - 0.5 * (row.count - 1)) * 2.0 * row.radius_m * direction for k in range(row.count)]


def list_spheres(robot, detector, q, *, by_transformation=False):
    """All spheres that the detector's pairs look at, component by component: (component, world centre [3], radius).

    By key points the row is laid between the key points where they are now. By transformation it is laid once, at
    q = 0, and then carried along by the frame of its first key point.
    """
    T_world, T_zero = compute_frames(robot, q), compute_frames(robot, np.zeros(len(q)))
    looked_at = {component for pair in robot.pair_lists[detector.pairs] for component in pair}
    rows = robot.approximations[detector.spheres]
    spheres = []
    for component in dict.fromkeys(row.component for row in rows):
        for row in rows:
            if row.component != component or component not in looked_at:
                continue
            now = T_zero if by_transformation else T_world
            for centre in place_row(row, now[row.start][:3, 3], now[row.end][:3, 3]):
                if by_transformation:
                    p_start = np.linalg.inv(T_zero[row.start]) @ [*centre, 1.0]
                    spheres.append((component, (T_world[row.start] @ p_start)[:3], row.radius_m))
                else:
                    spheres.append((component, centre, row.radius_m))
    return spheres


def compute_pair_clearances(spheres, pairs):
    """Smallest |C_i - C_j| - R_i - R_j of each pair of components, m [Qiao2021, eq. 19]."""
    centres = np.array([centre for _, centre, _ in spheres])
    radii = np.array([radius for _, _, radius in spheres])
    where = {name: [k for k, sphere in enumerate(spheres) if sphere[0] == name] for name, _, _ in spheres}
    clearances = []
    for a, b in pairs:
        i, j = np.array(where[a]), np.array(where[b])
        distances = np.linalg.norm(centres[i][:, None] - centres[j][None], axis=2)
        clearances.append((distances - radii[i][:, None] - radii[j][None]).min())
    return np.array(clearances)


def compute_clearance(robot, detector, q):
    """Smallest clearance over all pairs, m, and the index of its pair; brute force."""
    clearances = compute_pair_clearances(list_spheres(robot, detector, q), robot.pair_lists[detector.pairs])
    return clearances.min(), int(clearances.argmin())


def compute_depth(robot, detector, q):
    """Penetration beyond the safe distance, m: 0 when clearance > safe distance [Qiao2021, eq. 21]; in nm steps."""
    clearance, _ = compute_clearance(robot, detector, q)
    steps = max(np.rint((detector.safe_distance_m - clearance) / 1e-9), 1.0)
    return 0.0 if clearance > detector.safe_distance_m else float(steps * 1e-9)


# ---- surface points


def make_directions(rings, columns):
    """Unit vectors (cos m, sin m cos n, sin m sin n) [Qiao2021, eq. 11] of a grid, and its covering angle in rad.

    No direction is farther from the grid than half the diagonal of a cell, hypot(dm, dn) / 2, as sin m <= 1.
    """
    m = np.linspace(0.0, np.pi, rings + 1)
    n = np.arange(columns) * 2.0 * np.pi / columns
    directions = [(np.cos(a), np.sin(a) * np.cos(b), np.sin(a) * np.sin(b)) for a in m for b in n]
    return np.array(directions), 0.5 * np.hypot(np.pi / rings, 2.0 * np.pi / columns)


def compute_surface_from_centres(centres, radii, directions):
    """Points p = C + R (cos m, sin m cos n, sin m sin n) [Qiao2021, eq. 11]: [S, K, 3] from centres [S, 3]."""
    return np.array([[c + r * d for d in directions] for c, r in zip(centres, radii, strict=True)])


def compute_surface_gap(points, radii, group_of, pairs, covering_angle):
    """Smallest |p_i - p_j| - covering_angle (R_i + R_j) over the pairs, by brute force [Qiao2021, eq. 18, 20]."""
    smallest, closest = np.inf, -1
    for index, (a, b) in enumerate(pairs):
        for i in np.flatnonzero(group_of == a):
            for j in np.flatnonzero(group_of == b):
                distance = np.linalg.norm(points[i][:, None] - points[j][None], axis=2).min()
                gap = distance - covering_angle * (radii[i] + radii[j])
                if gap < smallest:
                    smallest, closest = gap, index
    return smallest, closest


# ---- differential evolution

# v = ... as vectors: x the population [NP, N], i the current member, b the best, r five drawn members, F the weight.
MUTATIONS = {
    "rand/1": lambda x, i, b, r, F: x[r[0]] + F * (x[r[1]] - x[r[2]]),  # [Storn1997]
    "best/1": lambda x, i, b, r, F: x[b] + F * (x[r[0]] - x[r[1]]),  # [Storn1997]
    "rand/2": lambda x, i, b, r, F: x[r[0]] + F * (x[r[1]] - x[r[2]]) + F * (x[r[3]] - x[r[4]]),  # [Storn1997]
    "best/2": lambda x, i, b, r, F: x[b] + F * (x[r[0]] - x[r[1]]) + F * (x[r[2]] - x[r[3]]),  # [Storn1997]
    "rand-to-best/1": lambda x, i, b, r, F: x[r[0]] + F * (x[b] - x[r[1]]),  # [Qiao2022]
    "rand-to-best/2": lambda x, i, b, r, F: x[r[0]] + F * (x[b] - x[r[1]]) + F * (x[r[2]] - x[r[3]]),  # [Qiao2022]
    "current-to-best/1": lambda x, i, b, r, F: x[i] + F * (x[b] - x[i]) + F * (x[r[0]] - x[r[1]]),  # [Das2011]
    "current-to-best/2": lambda x, i, b, r, F: (
        x[i] + F * (x[b] - x[i]) + F * (x[r[0]] - x[r[1]]) + F * (x[r[2]] - x[r[3]])
    ),  # [Das2011]
}


def repair_bound(repair, stream, value, parent, lower, upper):
    """Bring one coordinate back into its range: each repair in words of `SolveSettings.bounds`."""
    if lower <= value <= upper or repair == "none":
        return value
    if repair == "redraw":
        return lower + stream.uniform() * (upper - lower)
    nearest_bound = min(max(value, lower), upper)
    return {"clip": nearest_bound, "parent": parent, "midpoint": 0.5 * (parent + nearest_bound)}[repair]


def draw_members(stream, population, current):
    """Five distinct members, none of them the current one, each drawn again until it is new."""
    drawn = []
    while len(drawn) < 5:
        candidate = stream.index(population)
        if candidate != current and candidate not in drawn:
            drawn.append(candidate)
    return drawn


def compute_score(problem, target, q):
    """(depth, cost) and whether `q` meets the target; tuples compare by Deb's rules [Deb2000].

    The depth is computed for every trial under `feasibility`: the kernel's short cuts must not change the outcome.
    """
    T_world_tool = compute_frames(problem.robot, q)[problem.robot.tool]
    position = compute_position_error(T_world_tool, target)
    orientation = compute_orientation_error(T_world_tool, target)
    # A solve aims 1e-12 below both tolerances, see `solver.problem.ROUNDING`.
    position_tolerance = problem.settings.position_tolerance_m - 1e-12
    orientation_tolerance = problem.settings.orientation_tolerance_rad - 1e-12
    cost = position + orientation * position_tolerance / orientation_tolerance
    meets = position <= position_tolerance and orientation <= orientation_tolerance
    if problem.collision.detector is None or problem.settings.evolution.collision == "reject":
        return (0.0, cost), meets
    depth = compute_depth(problem.robot, problem.collision.detector, q)
    return (depth, cost), meets and depth == 0.0


def make_trial(problem, stream, x, i, best):
    """Mutation, binomial crossover [Storn1997] and bound repair, coordinate by coordinate as the stream is consumed."""
    settings = problem.settings.evolution
    drawn = draw_members(stream, len(x), i)
    forced = stream.index(x.shape[1])
    donor = MUTATIONS[settings.strategy](x, i, best, drawn, settings.weight)
    trial = x[i].copy()
    for k in range(len(trial)):
        if k == forced or stream.uniform() < settings.crossover:
            trial[k] = repair_bound(settings.bounds, stream, donor[k], x[i, k], problem.lower[k], problem.upper[k])
    return trial


def evolve(problem, target, stream):
    """One attempt of differential evolution [Storn1997]: (population, scores, best member, met?, evaluations).

    The scores are (depth, cost). The search ends at the first trial that meets the target and is not worse than its
    parent; that trial then stands in the population.
    """
    settings, joints = problem.settings.evolution, len(problem.robot.joints)
    population, in_place = settings.population, settings.update == "in_place"
    x, scores = np.zeros((population, joints)), [(np.inf, np.inf)] * population
    evaluations, best = 0, 0
    for generation in range(settings.generations + 1):
        next_x, next_scores = x.copy(), list(scores)
        for i in range(population):
            if generation == 0:
                trial = problem.near
                if i > 0 or problem.near is None:
                    middle = 0.5 * (problem.lower + problem.upper)
                    width = settings.start_share * (problem.upper - problem.lower)
                    trial = middle + np.array([stream.uniform() - 0.5 for _ in range(joints)]) * width
            else:
                trial = make_trial(problem, stream, x, i, best)
            score, meets = compute_score(problem, target, trial)
            evaluations += 1
            if score > scores[i]:
                continue
            next_x[i], next_scores[i] = trial, score
            if meets:
                x[i], scores[i] = trial, score
                return x, scores, i, True, evaluations
            if in_place:
                x[i], scores[i] = trial, score
                best = i if score <= scores[best] else best
        x, scores = next_x, next_scores
        if not in_place:
            best = min(range(population), key=lambda i: scores[i])
    return x, scores, best, False, evaluations


# ---- damped least squares


def compute_turn(T_world_tool, target):
    """(axis * 2 sin(angle / 2), its size): from scipy's rotation vector; for axes z_tool x z_target, sin(angle)."""
    if target.kind == "position":
        return np.zeros(3), 0.0
    if target.kind == "axis":
        a, b = T_world_tool[:3, 2], target.R_world_tool[:, 2]
        turn = np.cross(a, b)
        return turn, np.linalg.norm(turn) if a @ b >= 0.0 else 2.0 - np.linalg.norm(turn)
    rotation = Rotation.from_matrix(target.R_world_tool @ T_world_tool[:3, :3].T).as_rotvec()
    angle = np.linalg.norm(rotation)
    half = max(np.cos(angle / 2.0), 1e-2)  # near half a turn the sine fades, and the error counts as 2
    turn = rotation * (np.sin(angle) / half / angle if angle > 0.0 else 1.0)
    return turn, np.linalg.norm(turn) if half > 1e-2 else 2.0


def take_step(robot, target, lower, upper, descent, q):
    """(q after one damped step, position error, orientation error before it); `descent`: `DescentArrays`."""
    T_world_tool = compute_frames(robot, q)[robot.tool]
    turn, orientation = compute_turn(T_world_tool, target)
    away = target.p_world_tool - T_world_tool[:3, 3]
    position = np.linalg.norm(away)
    if position <= descent.position_tolerance and orientation <= descent.orientation_tolerance:
        return q, position, orientation
    J = compute_jacobian(robot, q)
    error = np.concatenate([away, descent.rotation_length * turn])
    if target.kind == "position":
        J, error = J[:3], error[:3]
    else:
        z = T_world_tool[:3, 2]
        across = np.eye(3) - np.outer(z, z) if target.kind == "axis" else np.eye(3)
        J[3:] = descent.rotation_length * across @ J[3:]
    pull = J.T @ error
    held = ((q >= upper - 1e-12) & (pull >= 0.0)) | ((q <= lower + 1e-12) & (pull <= 0.0))
    J = np.where(held, 0.0, J)
    damping = descent.damping * error @ error + descent.least_damping
    dq = J.T @ np.linalg.solve(J @ J.T + damping * np.eye(len(J)), error)
    dq *= min(1.0, descent.largest_step / max(np.abs(dq).max(), 1e-300))
    return np.clip(q + dq, lower, upper), position, orientation
