"""Random questions about a robot file, asked of all calls of ikde that solve; `tests.regrade` grades the answers.

Targets come from the file as well: half from random configurations, half from anywhere around.
"""

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

import ikde
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.solver.settings import BulkOptions
from tests.regrade import find_faults

KINDS = ("position", "axis", "pose")
HOW = {"many": 0.7, "one": 0.2, "distinct": 0.1}  # shares of the questions
METHODS = {"lm": 0.55, "auto": 0.26, "memetic": 0.16, "de": 0.03}
METHODS_OF_UR_ARMS = {"analytic": 0.2, "lm": 0.38, "auto": 0.25, "memetic": 0.15, "de": 0.02}
RESTARTS = {"lm": (8, 64), "analytic": (1, 16), "auto": (1,), "memetic": (1, 2), "de": (1,)}
MOST = {
    "lm": 250,
    "analytic": 250,
    "auto": 60,
    "memetic": 40,
    "de": 5,
}  # targets of one question; what costs more is asked fewer
MAX_BY_CALL = {"many": 250, "one": 10, "distinct": 2}
FIGURES = 1e-9  # m or rad, how far told figures may be from the grader's, of targets within a metre


@dataclass(frozen=True, kw_only=True)
class Question:
    """Targets, and how they are asked for."""

    kinds: np.ndarray
    T_world_tool: np.ndarray
    tolerances: tuple[float, float]
    method: str
    restarts: int
    how: str
    detector: str | None
    near: np.ndarray | None
    freeze: dict
    seed: int

    def __len__(self):
        return len(self.kinds)


@dataclass(frozen=True, kw_only=True)
class Answers:
    """Configurations that came back, each with the row of its target, and what was said of it."""

    rows: np.ndarray
    q: np.ndarray
    reached: np.ndarray
    figures: np.ndarray  # [A, 3] position error, orientation error, clearance (inf without a pair)
    collides: list  # None where nothing was compared
    verified: list  # None where plain numpy did not grade
    methods: list


@dataclass(kw_only=True)
class Tally:
    """What was asked, and what is wrong."""

    counts: Counter = field(default_factory=Counter)
    faults: list = field(default_factory=list)
    largest_gap: float = 0.0  # between figures told and graded, m or rad, of targets within a metre

    def __iadd__(self, other):
        self.counts += other.counts
        self.faults += other.faults
        self.largest_gap = max(self.largest_gap, other.largest_gap)
        return self


# ---- questions


def draw_questions(grader, rng, total, *, most=250, **options):
    """Questions with `total` targets together, none with more than `most`; options as for `draw_question`."""
    while total > 0:
        question = draw_question(grader, rng, min(most, total), **options)
        yield question
        total -= len(question)


def draw_question(grader, rng, most, *, kinds=KINDS, detectors=None, methods=METHODS):
    """One question with at most so many targets, of these kinds, under one of these detectors; None for all."""
    how, method = _choose(rng, HOW), _choose(rng, methods)
    kinds = ("pose",) if method == "analytic" else kinds
    count = min(most, MOST[method], MAX_BY_CALL[how])
    freeze = _draw_freeze(grader, rng) if rng.random() < 0.2 else {}
    near = _far_out(grader, rng.uniform(*grader.drawn)) if rng.random() < 0.15 else None
    least = -9.0 if rng.random() < 0.9 else -12.0
    detectors = detectors or [None, None, None, "none", *grader.file.get("detectors", {})]
    mixed = rng.choice(kinds, count) if rng.random() < 0.6 else np.full(count, rng.choice(kinds))
    return Question(
        kinds=mixed,
        T_world_tool=draw_poses(grader, rng, count, freeze),
        tolerances=(10.0 ** rng.uniform(least, -1.0), min(10.0 ** rng.uniform(least, 0.6), 3.0)),
        method=method,
        restarts=int(rng.choice(RESTARTS[method])),
        how=how,
        detector=detectors[rng.integers(len(detectors))],
        near=near,
        freeze=freeze,
        seed=int(rng.integers(2**63)),
    )


def draw_poses(grader, rng, count, freeze=None):
    """Poses [count, 3, 4] of the tool: half of random configurations, some at limits, half from around those."""
    Q = rng.uniform(*grader.drawn, (count, len(grader.joints)))
    Q = np.where(rng.random(Q.shape) < 0.05, rng.choice(grader.drawn, count), Q)
    for name, value in (freeze or {}).items():
        Q[:, grader.joints.index(name)] = value
    R, p = grader.place(Q)[grader.tool]
    anywhere = p.mean(axis=0) + rng.normal(size=p.shape) * (1.5 * p.std(axis=0) + 0.05)
    is_reachable = rng.random(count) < 0.5
    turned = Rotation.random(count, rng=rng).as_matrix()
    R, p = np.where(is_reachable[:, None, None], R, turned), np.where(is_reachable[:, None], p, anywhere)
    return np.concatenate([R, p[:, :, None]], axis=2)


def _choose(rng, shares):
    return str(rng.choice(list(shares), p=list(shares.values())))


def _draw_freeze(grader, rng):
    """Up to a third of the joints, each at a value inside its limits."""
    count = int(rng.integers(1, max(2, len(grader.joints) // 3 + 1)))
    chosen = rng.choice(len(grader.joints), count, replace=False)
    lower, upper = grader.drawn
    values = _far_out(grader, np.array([rng.uniform(*ends) for ends in zip(lower, upper, strict=True)]))
    return {grader.joints[k]: float(values[k]) for k in chosen}


def _far_out(grader, q):
    """Joints without limits several turns away."""
    return np.where(grader.is_endless, 5.0 * q, q)


# ---- answers


def ask(robot, question, threads=None):
    """What ikde answers."""
    position, orientation = question.tolerances
    settings = ikde.SolveSettings(
        method=question.method,
        restarts=question.restarts,
        position_tolerance_m=position,
        orientation_tolerance_rad=orientation,
    )
    freeze = question.freeze or None
    options = {"seed": question.seed, "collision": question.detector, "near": question.near, "freeze": freeze}
    targets = [_make_target(kind, T) for kind, T in zip(question.kinds, question.T_world_tool, strict=True)]
    if question.how == "many":
        options |= {"bulk": BulkOptions(threads=threads, explain=False)}
        return _read_rows(ikde.solve_many(robot, targets, settings, **options))
    if question.how == "one":
        return _read_results([[ikde.solve(robot, target, settings, **options)] for target in targets])
    return _read_results([ikde.solve_distinct(robot, target, 3, settings, **options) for target in targets])


def _make_target(kind, T):
    p, R = T[:, 3], T[:, :3]
    if kind == "pose":
        return ikde.Target(p, R)
    return ikde.Target(p, axis_world_tool=R[:, 2]) if kind == "axis" else ikde.Target(p)


def _read_rows(rows):
    return Answers(
        rows=np.arange(len(rows)),
        q=rows.q,
        reached=rows.reached,
        figures=np.column_stack([rows.position_error_m, rows.orientation_error_rad, rows.clearance_m]),
        collides=rows.collision.tolist(),
        verified=rows.verified.tolist(),
        methods=[row.method for row in rows],
    )


def _read_results(lists):
    results = [result for found in lists for result in found]
    clearances = [np.inf if result.clearance_m is None else result.clearance_m for result in results]
    return Answers(
        rows=np.repeat(np.arange(len(lists)), [len(found) for found in lists]),
        q=np.array([result.q for result in results]),
        reached=np.array([result.reached for result in results]),
        figures=np.column_stack(
            [[r.position_error_m for r in results], [r.orientation_error_rad for r in results], clearances]
        ),
        collides=[result.collision for result in results],
        verified=[result.verified for result in results],
        methods=[result.method for result in results],
    )


# ---- grades


def grade_answers(grader, question, answers):
    """The tally of one question's answers: what is called reached and is not, and what is told and is not so."""
    own = np.column_stack(grader.grade(answers.q, _asked(question, answers), question.detector))
    options = {"detector": question.detector, "frozen": question.freeze, "near": question.near}
    faults = find_faults(grader, answers.q, own, question.tolerances, **options)
    accepted = ~np.any(list(faults.values()), axis=0)
    gaps = _find_gaps(question, answers, own)
    faults = {name: rows & answers.reached for name, rows in faults.items()}
    faults["other figures than told"] = ~(gaps <= FIGURES).all(axis=1)
    touches = (own[:, 2] <= grader.safe_distance(question.detector)).tolist()
    touches = touches if grader.compared(question.detector) else [None] * len(touches)
    differs = [told != seen for told, seen in zip(answers.collides, touches, strict=True)]
    faults["other verdict on collision than told"] = np.array(differs)
    faults["graders of ikde disagree"] = np.array([verified is False for verified in answers.verified])
    counts = Counter(
        targets=len(question),
        answers=len(answers.q),
        reached=int(answers.reached.sum()),
        accepted_but_not_called_reached=int((accepted & ~answers.reached).sum()),
    )
    counts.update(f"reached by {answers.methods[k]}" for k in np.flatnonzero(answers.reached))
    told = [_tell(name, question, answers, own, k) for name, rows in faults.items() for k in np.flatnonzero(rows)]
    return Tally(counts=counts, faults=told, largest_gap=float(gaps.max(initial=0.0)))


def _asked(question, answers):
    """Kind and pose of the target of each answer."""
    return question.kinds[answers.rows], question.T_world_tool[answers.rows]


def _find_gaps(question, answers, own):
    """How far figures told are from the grader's [A, 3], for a target beyond a metre relative to its distance."""
    far = np.maximum(1.0, np.abs(question.T_world_tool[answers.rows, :, 3]).max(axis=1, keepdims=True))
    with np.errstate(invalid="ignore"):
        return np.where(own == answers.figures, 0.0, np.abs(own - answers.figures)) / far


def _tell(name, question, answers, own, k):
    """All that is needed to see a fault again."""
    kinds, T = _asked(question, answers)
    return {
        "fault": name,
        "target": {"kind": str(kinds[k]), "T_world_tool": T[k].tolist()},
        "q": answers.q[k].tolist(),
        "told": answers.figures[k].tolist(),
        "graded": own[k].tolist(),
        "tolerances": question.tolerances,
        "detector": question.detector,
        "how": f"{question.how}, {question.method}, near {question.near is not None}, frozen {question.freeze}",
    }


def ask_and_regrade(robot, grader, rng, total, *, threads=None, **options):
    """The tally of questions with `total` targets together; options as for `draw_questions`."""
    is_closed = "pose" in options.get("kinds", KINDS) and find_ur_arm(robot) is not None
    tally, methods = Tally(), METHODS_OF_UR_ARMS if is_closed else METHODS
    for question in draw_questions(grader, rng, total, methods=methods, **options):
        tally += grade_answers(grader, question, ask(robot, question, threads))
    return tally


def account_for_pairs(robot, grader):
    """How many pairs each detector compares and leaves out, and where ikde and the grader differ on that."""
    counts, faults = Counter(), []
    for name, detector in robot.detectors.items():
        compared = [frozenset(pair) for pair in CollisionModel(robot=robot, detector=detector).pairs]
        left_out = {
            frozenset((pair.a, pair.b)): pair.reason
            for pair in CollisionModel(robot=robot, detector=detector).left_out_pairs
        }
        counts.update(detectors=1, compared=len(compared), left_out=len(left_out))
        if set(compared) != grader.compared(name) or len(compared) != len(set(compared)):
            faults.append({"fault": "pairs compared", "detector": name, "ikde": _sort(compared)})
        if left_out != grader.left_out(name):
            faults.append({"fault": "pairs left out", "detector": name, "ikde": _sort(left_out)})
    return Tally(counts=counts, faults=faults)


def _sort(pairs):
    return sorted(sorted(pair) for pair in pairs)
