"""Random robot files as text: trees, offsets, turns and slides in any order, bare links, driving bases, 1 to 12 joints.

Drawn for docs/robot_file.md, not for ikde's objects, so that reading the file is part of what is tested.
"""

from itertools import combinations

import numpy as np
import yaml

from tests.regrade import Grader

MAX_JOINTS = 12
SAMPLES = 300  # configurations that tell how often a robot is free
MIN_FREE = 0.2  # of them
WIDE = np.pi * np.array([1.0, 1.0, 2.0, 3.0])
ENDLESS = 0.15  # of the joints that turn
WORDS = ("j", "Gelenk ", "axis-", "関節")


def random_robot_text(seed):
    """The text of a robot file; the same for the same seed. Most robots have free configurations, a few have none."""
    file = _Draft(np.random.default_rng(seed), seed).finish()
    return yaml.dump(file, Dumper=getattr(yaml, "CSafeDumper", yaml.SafeDumper), sort_keys=False, allow_unicode=True)


class _Draft:
    """A robot file that grows; lengths in m and angles in rad until it is finished."""

    def __init__(self, rng, seed):
        self.rng, self.name = rng, f"random {seed}"
        self.endless = np.random.default_rng([seed, 1])  # of its own: all else is drawn as if there were limits
        self.joints, self.frames, self.spheres, self.bodies = {}, {}, {}, {"world": ["world"]}
        self.word = str(rng.choice(WORDS))
        count = int(rng.integers(1, MAX_JOINTS + 1))
        self.drives = count >= 4 and rng.random() < 0.25
        if self.drives:
            self._add_base()
        if count - len(self.joints) >= 6 and rng.random() < 0.25:
            count -= 6
            self._add_links(count)
            self._add_ur_arm()
        else:
            self._add_links(count)
        held = self.last if rng.random() < 0.9 else str(rng.choice(list(self.bodies)[1:]))
        self.tool = self._add_fixed("tip", held) if rng.random() < 0.8 else held
        if rng.random() < 0.95:
            self._add_spheres()

    # ---- frames and joints

    @property
    def last(self):
        """The body that was added last."""
        return list(self.bodies)[-1]

    def _add_base(self):
        room = float(self.rng.choice([0.6, 2.0, 5.0]))
        for axis in ((1, 0, 0), (0, 1, 0)):
            self._add_joint(self.last, "prismatic", (-room, room), axis=axis, plain=True)
        self._add_joint(self.last, "revolute", (-np.pi, np.pi), axis=[0, 0, 1], plain=True)

    def _add_links(self, count):
        """A chain with branches: joints until there are so many."""
        while len(self.joints) < count:
            parent = self.last if self.rng.random() < 0.8 else str(self.rng.choice(list(self.bodies)))
            if self.drives:
                parent = self.last if parent in list(self.bodies)[:3] else parent
            self._add_joint(parent, str(self.rng.choice(["revolute", "revolute", "prismatic"])))

    def _add_ur_arm(self):
        """Six turns as Universal Robots order them, which have a closed form."""
        a, d = self.rng.uniform(0.2, 0.6, 2), self.rng.uniform(0.05, 0.15, 4)
        for xyz, axis in (
            ((0, 0, d[0]), (0, 0, 1)),
            ((0, d[1], 0), (0, 1, 0)),
            ((0, 0, a[0]), (0, 1, 0)),
            ((0, 0, a[1]), (0, 1, 0)),
            ((0, d[2], 0), (0, 0, 1)),
            ((0, 0, d[3]), (0, 1, 0)),
        ):
            self._add_joint(self.last, "revolute", axis=axis, xyz=xyz, plain=True)

    def _add_joint(self, parent, kind, limits=None, *, axis=None, xyz=(0, 0, 0), plain=False):
        """A frame that a joint moves, with up to two fixed frames on it; `plain`: not turned, and at `xyz` exactly."""
        name, frame = f"{self.word}{len(self.joints)}", f"f{len(self.joints)}"
        lower, upper = limits or self._draw_limits(kind)
        home = float(self.rng.uniform(lower, upper)) if self.rng.random() < 0.5 or not lower <= 0.0 <= upper else 0.0
        self.joints[name] = {"kind": kind, "lower": lower, "upper": upper, "home": home}
        if kind == "revolute" and lower < upper and self.endless.random() < ENDLESS:
            self.joints[name] = {"kind": "continuous", "home": home}
        self.frames[frame] = {
            "parent": parent if plain else str(self.rng.choice(self.bodies[parent])),
            **({"xyz": xyz} if plain else self._draw_offset()),
            "joint": name,
            "axis": self._draw_axis() if axis is None else axis,
        }
        self.bodies[frame] = [frame]
        for k in range(int(self.rng.integers(0, 3))):
            self._add_fixed(f"{frame} point {k}", frame)

    def _add_fixed(self, name, body):
        self.frames[name] = {"parent": str(self.rng.choice(self.bodies[body])), **self._draw_offset(least=0.05)}
        self.bodies[body].append(name)
        return name

    def _draw_limits(self, kind):
        if self.rng.random() < 0.08:  # frozen
            return (float(self.rng.uniform(-1.0, 1.0)),) * 2
        if kind == "prismatic":
            far = 1.0 if self.rng.random() < 0.95 else 30.0
            return -far * float(self.rng.uniform(0.0, 0.8)), far * float(self.rng.uniform(0.1, 1.5))
        if self.rng.random() < 0.6:
            half = float(self.rng.choice(WIDE))
            return -half, half
        lower, upper = np.sort(self.rng.uniform(-np.pi, np.pi, 2)).tolist()
        return lower, upper

    def _draw_offset(self, least=0.0):
        """Entries `xyz` and `rpy`: some zero, some right angles, some anything."""
        rng = self.rng
        xyz = rng.uniform(-0.4, 0.4, 3) * rng.integers(0, 2, 3) + rng.uniform(least, 2.0 * least, 3)
        how = rng.random()
        rpy = rng.uniform(-np.pi, np.pi, 3) if how < 0.4 else 0.5 * np.pi * rng.integers(-2, 3, 3)
        return {"xyz": xyz} if how > 0.7 else {"xyz": xyz, "rpy": rpy}

    def _draw_axis(self):
        if self.rng.random() < 0.5:
            return self.rng.normal(size=3)
        return np.eye(3)[self.rng.integers(3)] * self.rng.choice([-1.0, 1.0, 2.0])

    # ---- spheres, pairs, detectors

    def _add_spheres(self):
        """Rows on some bodies: a driving base carries all of them, or the world and the slides may have some, too."""
        bodies = list(self.bodies)[3 if self.drives and self.rng.random() < 0.7 else 0 :]
        for body in (body for body in bodies if self.rng.random() < 0.65):
            for k in range(1 if self.rng.random() < 0.85 else 2):
                for _ in range(int(self.rng.integers(1, 3))):
                    self._add_row(f"part {k} of {body}", body)

    def _add_row(self, component, body):
        rng = self.rng
        start, end = (str(name) for name in rng.choice(self.bodies[body], 2))
        count = int(rng.integers(1, 6)) if start != end else 1
        row = {"component": component, "from": start, "radius": float(rng.uniform(0.02, 0.12))}
        row |= {} if start == end and rng.random() < 0.7 else {"to": end}
        row |= {} if count == 1 and rng.random() < 0.7 else {"count": count}
        row |= {} if rng.random() < 0.5 else {"spacing": str(rng.choice(["touching", "even"]))}
        coarse = {"component": component, "from": start, "to": end, "radius": float(rng.uniform(0.05, 0.15))}
        self.spheres.setdefault("fine", []).append(row)
        self.spheres.setdefault("coarse", []).append(coarse)

    def finish(self):
        """The file as plain data, in its own units; frames in any order."""
        names = list(self.frames)
        self.rng.shuffle(names)
        frames = {name: self.frames[name] for name in names}
        file = {"name": self.name, "title": "drawn", "joints": self.joints, "frames": frames, "tool": self.tool}
        file |= self._make_detectors(file) if self.spheres else {}
        return _to_plain(_to_millimetres(file) if self.rng.random() < 0.5 else file)

    def _make_detectors(self, file):
        """One detector or several, with spheres small enough for free configurations; none if nothing can touch."""
        safe = float(self.rng.choice([0.0, 0.0, 0.01, 0.05]))
        own = {"spheres": "fine", "safe_distance": safe}
        extra = {"spheres": self.spheres, "detectors": {"own": own}}
        if not Grader(file | extra).compared():
            own["pairs"] = "listed"
            extra["pairs"] = {"listed": {"pairs": self._find_moving_pairs(file | extra)}}
        wide = {**own, "spheres": "coarse"}
        if self.rng.random() < 0.95:
            self._make_room(file | extra | {"detectors": {"own": own, "wide": wide}})
        if not Grader(file | extra).compared():
            return {}
        if "pairs" not in extra:
            extra |= self._list_adjacent(Grader(file | extra))
            extra |= self._add_detectors(file | extra) if self.rng.random() < 0.4 else {}
        return extra

    def _find_moving_pairs(self, file):
        """Pairs that lie on two bodies, but those that touch everywhere."""
        bodies = Grader(file).components()
        pairs = [[a, b] for a, b in combinations(bodies, 2) if bodies[a] != bodies[b]]
        listed = {"pairs": {"listed": {"pairs": _nest(pairs)}}}
        hits = self._find_hits(Grader(file | listed), "own") if pairs else {}
        return _nest(pair for pair in pairs if not hits[frozenset(pair)].all())

    def _make_room(self, file):
        """Shrink the spheres until enough configurations are free, or for as long as it makes sense."""
        grader = Grader(file)
        for _ in range(8):
            hits = [hit for name in ("own", "wide") for hit in self._find_hits(grader, name).values() if not hit.all()]
            if not hits or 1.0 - np.any(hits, axis=0).mean() >= MIN_FREE:
                return
            for row in (*self.spheres["fine"], *self.spheres["coarse"]):
                row["radius"] *= 0.6

    def _list_adjacent(self, grader):
        """What touches nearly everywhere, and now and then another pair; one is left to compare."""
        hits = self._find_hits(grader, "own")
        listed = [sorted(pair) for pair, hit in hits.items() if hit.mean() > 0.9 or self.rng.random() < 0.03]
        if not 0 < len(listed) < len(hits):
            return {}
        return {"adjacent": {"pairs": {a: dict.fromkeys(b, "drawn: no harm") for a, b in _nest(listed).items()}}}

    def _find_hits(self, grader, detector):
        Q = np.random.default_rng(0).uniform(*grader.drawn, (SAMPLES, len(grader.joints)))
        safe = grader.safe_distance(detector)
        return {pair: gaps <= safe for pair, gaps in grader.clearances(Q, detector).items()}

    def _add_detectors(self, file):
        """Lists of pairs, one of which includes the other, and a coarse approximation."""
        compared = sorted(sorted(pair) for pair in Grader(file).compared())
        some = [pair for pair in compared if self.rng.random() < 0.6] or compared[:1]
        few = some[: max(1, len(some) // 2)]
        lists = {"few": {"pairs": _nest(few)}, "some": {"pairs": _nest(some[len(few) :]), "include": ["few"]}}
        detectors = {
            **file["detectors"],
            "all": {"spheres": "coarse", "pairs": "non_adjacent"},
            "some": {"spheres": "fine", "pairs": "some", "safe_distance": 0.02},
            "few": {"spheres": "coarse", "pairs": "few"},
        }
        return {"pairs": lists, "detectors": detectors, "default_detector": str(self.rng.choice(list(detectors)))}


def _nest(pairs):
    """{a: [b, ...]}."""
    nested = {}
    for a, b in pairs:
        nested.setdefault(a, []).append(b)
    return nested


def _to_plain(value):
    """Lists and floats in place of arrays."""
    if isinstance(value, dict):
        return {key: _to_plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_to_plain(entry) for entry in value]
    return float(value) if isinstance(value, np.floating) else int(value) if isinstance(value, np.integer) else value


def _to_millimetres(file):
    """The same robot in mm and deg."""
    for joint in file["joints"].values():
        unit = 1e3 if joint["kind"] == "prismatic" else 180.0 / np.pi
        joint |= {key: float(joint[key] * unit) for key in ("lower", "upper", "home") if key in joint}
        joint["home"] = min(max(joint["home"], joint.get("lower", -np.inf)), joint.get("upper", np.inf))
    for frame in file["frames"].values():
        frame |= {key: [v * u for v in frame[key]] for key, u in (("xyz", 1e3), ("rpy", 180.0 / np.pi)) if key in frame}
    for row in (row for rows in file.get("spheres", {}).values() for row in rows):
        row["radius"] *= 1e3
    for detector in file.get("detectors", {}).values():
        detector["safe_distance"] = detector.get("safe_distance", 0.0) * 1e3
    return {"units": {"length": "mm", "angle": "deg"}, **file}
