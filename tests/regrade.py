"""A grader of the tests' own, written from docs/robot_file.md alone: it reads a robot file's text, and nothing of ikde.

Slow and plain on purpose: frames by name, spheres between key points as they stand in the world, all pairs. Units are m
and rad inside; T is the number of configurations.
"""

from itertools import combinations

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

UNITS = {"m": 1.0, "mm": 1e-3, "rad": 1.0, "deg": np.pi / 180.0}
ROUNDING = 1e-12  # of limits whose unit was converted
CHUNK = 2000  # configurations whose spheres are compared at once


class Grader:
    """One robot file, as plain data: its numbers may still be words."""

    def __init__(self, file):
        units = {"length": "m", "angle": "rad"} | file.get("units", {})
        self.length, self.angle = UNITS[units["length"]], UNITS[units["angle"]]
        self.file, self.frames, self.tool = file, file["frames"], file["tool"]
        self.joints = list(file["joints"])
        self.is_prismatic = {name: entry["kind"] == "prismatic" for name, entry in file["joints"].items()}
        missing = {"lower": -np.inf, "upper": np.inf, "home": 0.0}
        self.lower, self.upper, self.home = (self._read_limits(*item) for item in missing.items())
        self.is_endless = np.isinf(self.upper)

    @classmethod
    def of_text(cls, text):
        """Every value is a word until this class reads it as a number: nobody else's rules for numbers hold."""
        return cls(yaml.load(text, Loader=getattr(yaml, "CBaseLoader", yaml.BaseLoader)))

    @property
    def drawn(self):
        """Where to draw configurations: inside the limits; once around home where there are none."""
        ends = (self.lower, self.home - np.pi), (self.upper, self.home + np.pi)
        return tuple(np.where(self.is_endless, around, limit) for limit, around in ends)

    def _read_limits(self, key, missing):
        units = [self.length if self.is_prismatic[name] else self.angle for name in self.joints]
        return np.array([float(entry.get(key, missing)) for entry in self.file["joints"].values()]) * units

    # ---- where everything is

    def place(self, Q):
        """Frame -> (R_world_frame [T, 3, 3], p_world_frame [T, 3]) for configurations Q [T, N]."""
        Q = np.asarray(Q, dtype=float)
        placed = {"world": (np.broadcast_to(np.eye(3), (len(Q), 3, 3)), np.zeros((len(Q), 3)))}
        for name in self.frames:
            self._place(name, Q, placed)
        return placed

    def _place(self, name, Q, placed):
        if name in placed:
            return placed[name]
        entry = self.frames[name]
        R, p = self._place(entry["parent"], Q, placed)
        p = p + R @ (self._vector(entry, "xyz") * self.length)
        R = R @ Rotation.from_euler("xyz", self._vector(entry, "rpy") * self.angle).as_matrix()  # small: fixed axes
        if "joint" in entry:
            axis = self._vector(entry, "axis")
            motion = Q[:, self.joints.index(entry["joint"]), None] * (axis / np.linalg.norm(axis))
            if self.is_prismatic[entry["joint"]]:
                p = p + (R @ motion[:, :, None])[:, :, 0]
            else:
                R = R @ Rotation.from_rotvec(motion).as_matrix()
        placed[name] = R, p
        return placed[name]

    @staticmethod
    def _vector(entry, key):
        return np.array([float(value) for value in entry.get(key, (0, 0, 0))])

    # ---- which components are compared

    def body(self, frame):
        """The frame, at or above this one, that a joint moves; or the world."""
        while frame != "world" and "joint" not in self.frames[frame]:
            frame = self.frames[frame]["parent"]
        return frame

    def components(self):
        """Component -> body, over all approximations."""
        rows = [row for rows in self.file.get("spheres", {}).values() for row in rows]
        return {row["component"]: self.body(row.get("from", row.get("frame"))) for row in rows}

    def adjacent(self):
        """Pair -> why, of all pairs of components that `non_adjacent` leaves out."""
        bodies, found = self.components(), {}
        for a, others in self.file.get("adjacent", {}).get("pairs", {}).items():
            found |= {frozenset((a, b)): f"adjacent: {reason}" for b, reason in others.items()}
        for a, b in combinations(bodies, 2):
            if bodies[a] == bodies[b]:
                found.setdefault(frozenset((a, b)), "one body")
            for child, parent in ((bodies[a], bodies[b]), (bodies[b], bodies[a])):
                if self._below(child) == parent:
                    found.setdefault(frozenset((a, b)), f"joined by joint {self.frames[child]['joint']}")
        compared = {frozenset((a, b)) for a, others in self.file.get("compare", {}).items() for b in others}
        return {pair: reason for pair, reason in found.items() if pair not in compared}

    def _below(self, body):
        """The body that a body's joint hangs on; None for the world, which has no joint."""
        return None if body == "world" else self.body(self.frames[body]["parent"])

    def detector(self, name=None):
        """The entry of a detector, by default the file's own; None if it has none, or for `none`."""
        entries = self.file.get("detectors", {})
        if name is None:
            name = self.file.get("default_detector", next(iter(entries)) if len(entries) == 1 else "none")
        return None if name == "none" else entries[name]

    def compared(self, detector=None):
        """Pairs that a detector compares."""
        entry = self.detector(detector)
        if entry is None:
            return set()
        name = entry.get("pairs", "non_adjacent")
        if name == "non_adjacent":
            return {frozenset(pair) for pair in combinations(self.components(), 2)} - set(self.adjacent())
        return self._listed(name)

    def _listed(self, name):
        entry = self.file["pairs"][name]
        own = {frozenset((a, b)) for a, others in entry.get("pairs", {}).items() for b in others}
        return own.union(*(self._listed(other) for other in entry.get("include", ())))

    def left_out(self, detector=None):
        """Pair -> why, of all pairs of components that a detector does not compare."""
        entry, adjacent = self.detector(detector), self.adjacent()
        if entry is None:
            return {}
        every = {frozenset(pair) for pair in combinations(self.components(), 2)}
        unlisted = f"not in the pair list {entry.get('pairs', 'non_adjacent')}"
        return {pair: adjacent.get(pair, unlisted) for pair in every - self.compared(detector)}

    # ---- how near they come

    def clearances(self, Q, detector=None):
        """Pair -> smallest distance - R_i - R_j [T], m."""
        pairs = sorted(self.compared(detector), key=sorted)
        gaps = {pair: np.empty(len(Q)) for pair in pairs}
        for first in range(0, len(Q), CHUNK):
            rows = slice(first, first + CHUNK)
            spheres = self.spheres(self.detector(detector)["spheres"], Q[rows]) if pairs else {}
            for pair in pairs:
                (a, radii_a), (b, radii_b) = (spheres[component] for component in pair)
                apart = np.linalg.norm(a[:, :, None] - b[:, None], axis=-1)
                gaps[pair][rows] = (apart - radii_a[:, None] - radii_b).min(axis=(1, 2))
        return gaps

    def spheres(self, approximation, Q):
        """Component -> (centres [T, S, 3], radii [S])."""
        placed, centres, radii = self.place(Q), {}, {}
        for row in self.file["spheres"][approximation]:
            if "spheres" in row:
                own = self.length * np.array(row["spheres"], dtype=float)
                R, p = placed[row["frame"]]
                centres.setdefault(row["component"], []).append(p[:, None] + np.einsum("tij,sj->tsi", R, own[:, :3]))
                radii.setdefault(row["component"], []).append(own[:, 3])
                continue
            name, start, end = row["component"], row["from"], row.get("to", row["from"])
            radius, count = float(row["radius"]) * self.length, int(row.get("count", 1))
            line = placed[start][1], placed[end][1]
            centres.setdefault(name, []).append(place_row(*line, radius, count, row.get("spacing", "touching")))
            radii.setdefault(name, []).append(np.full(count, radius))
        return {name: (np.concatenate(centres[name], axis=1), np.concatenate(radii[name])) for name in centres}

    # ---- verdicts

    def grade(self, Q, targets, detector=None):
        """(position errors [T], orientation errors [T], clearances [T]; inf without a pair) of Q [T, N].

        `targets`: kinds [T] of `position`, `axis`, `pose`, and T_world_tool [T, 3, 4], of which an axis target asks for
        the z axis only.
        """
        kinds, T = targets
        R, p = self.place(Q)[self.tool]
        position = np.linalg.norm(p - T[:, :, 3], axis=1)
        turned = Rotation.from_matrix(np.swapaxes(T[:, :, :3], 1, 2) @ R).magnitude()
        tilted = compute_angle(T[:, :, 2], R[:, :, 2])
        orientation = np.select([kinds == "pose", kinds == "axis"], [turned, tilted], 0.0)
        gaps = list(self.clearances(Q, detector).values())
        return position, orientation, np.min(gaps, axis=0) if gaps else np.full(len(Q), np.inf)

    def safe_distance(self, detector=None):
        """At or below this clearance it is a collision, m."""
        entry = self.detector(detector)
        return float(entry.get("safe_distance", 0)) * self.length if entry else 0.0


def place_row(start, end, radius, count, spacing):
    """Centres [T, count, 3] of a row of spheres between points [T, 3]."""
    middle = 0.5 * (start + end)
    if count == 1:
        return middle[:, None]
    k = np.arange(count)[:, None]
    if spacing == "even":
        return start[:, None] + k / (count - 1) * (end - start)[:, None]
    direction = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
    return middle[:, None] + (k - 0.5 * (count - 1)) * 2.0 * radius * direction[:, None]


def compute_angle(a, b):
    """Angle [T] between unit vectors [T, 3], exact near 0 and near pi (Kahan)."""
    return 2.0 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1))


def find_faults(grader, Q, figures, tolerances, *, detector=None, frozen=None, near=None):
    """What is wrong with answers Q [T, N] if they are called reached: name -> which [T].

    `figures` [T, 3] are those of `grade`, and nothing is allowed for rounding in them. Joint values are given 1e-12:
    their limits' units are converted, and the last bit depends on how. `frozen`: joint -> value that it must have.
    `near` [N]: where whole turns should have brought the joints, home without it.
    """
    position, orientation, clearance = figures.T
    values = np.array([(frozen or {}).get(name, np.nan) for name in grader.joints])
    lower, upper = grader.lower - ROUNDING, grader.upper + ROUNDING
    return {
        "out of position tolerance": ~(position <= tolerances[0]),
        "out of orientation tolerance": ~(orientation <= tolerances[1]),
        "outside the limits": ~((lower <= Q) & (upper >= Q)).all(axis=1),
        "a full turn nearer is inside the limits": _is_wound(grader, Q, grader.home if near is None else near, values),
        "frozen joint moved": (np.abs(Q - values) > ROUNDING).any(axis=1),
        "in collision": ~(clearance > grader.safe_distance(detector)),
    }


def _is_wound(grader, Q, centre, frozen):
    """Whether a full turn of a joint of Q [T, N] that is not `frozen` [N], else NaN, brings it nearer `centre` [N]."""
    slides = np.array(list(grader.is_prismatic.values()))
    wound = np.zeros(len(Q), dtype=bool)
    for turned in (Q - 2.0 * np.pi, Q + 2.0 * np.pi):
        fits = (grader.lower + ROUNDING <= turned) & (turned <= grader.upper - ROUNDING) & np.isnan(frozen) & ~slides
        wound |= (fits & (np.abs(turned - centre) < np.abs(Q - centre) - ROUNDING)).any(axis=1)
    return wound
