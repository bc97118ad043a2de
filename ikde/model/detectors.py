"""What a detector compares, and whether it fits a robot."""

from collections import Counter
from itertools import combinations

from ikde.errors import InputError, nearest, quoted
from ikde.model.names import check_printable
from ikde.model.numbers import is_number
from ikde.model.robot import MAX_MAGNITUDE, NO_DETECTOR, Detector, LeftOutPair, Robot

NAMED = 3  # pairs in a message that is about many
MAX_PAIRS, MAX_SPHERE_PAIRS = 50_000, 2_000_000  # of components in a list, and of spheres that a detector compares


def list_left_out(robot: Robot, detector: Detector) -> tuple[LeftOutPair, ...]:
    """Pairs of components that a detector does not compare, and why."""
    compared = {frozenset(pair) for pair in robot.pair_lists[detector.pairs]}
    reasons = {frozenset((pair.a, pair.b)): pair.reason for pair in robot.neighbours}
    unlisted = f"not in the pair list {detector.pairs}"
    return tuple(
        LeftOutPair(a=a, b=b, reason=reasons.get(frozenset((a, b)), unlisted))
        for a, b in combinations(robot.components(detector.spheres), 2)
        if frozenset((a, b)) not in compared
    )


def check_detector(robot: Robot, detector: Detector, where: tuple[str | int, ...]) -> None:
    """Raise `InputError` unless the detector's names exist, and it compares pairs that its approximation describes."""
    if not isinstance(detector, Detector):
        raise InputError(f"expected a Detector, got {quoted(detector)}", where)
    for key, what, name, known in (
        ("spheres", "approximation", detector.spheres, robot.approximations),
        ("pairs", "pair list", detector.pairs, robot.pair_lists),
    ):
        if name not in known:
            raise InputError(f"no {what} is called {name!r}{nearest(name, known)}", (*where, key))
    check_printable(detector.name, (*where, "name"))
    if detector.name == NO_DETECTOR:
        raise InputError(f"{NO_DETECTOR!r} is taken: it stands for no detector at all", where or ("name",))
    distance = detector.safe_distance_m
    if not (is_number(distance) and 0.0 <= distance <= MAX_MAGNITUDE):
        raise InputError(f"expected a distance of at least 0, up to {MAX_MAGNITUDE:g} m", (*where, "safe_distance"))
    described = robot.components(detector.spheres)
    if not described:
        raise InputError(f"this detector compares nothing: {detector.spheres!r} has no spheres", (*where, "spheres"))
    pairs = robot.pair_lists[detector.pairs]
    if not pairs:
        raise InputError(f"this detector compares nothing: {_explain_no_pairs(robot, detector)}", (*where, "pairs"))
    for component in {c for pair in pairs for c in pair}:
        if component not in described:
            raise InputError(
                f"the approximation {detector.spheres!r} has no component {component!r}", (*where, "pairs")
            )
    check_size(robot, detector, where)


def check_size(robot: Robot, detector: Detector, where: tuple[str | int, ...]) -> None:
    """Raise `InputError` for too many pairs: comparing takes time with every pair, also where a file is only shown."""
    pairs = robot.pair_lists[detector.pairs]
    if len(pairs) > MAX_PAIRS:
        raise InputError(f"expected at most {MAX_PAIRS:,} pairs of components, got {len(pairs):,}", (*where, "pairs"))
    spheres: Counter[str] = Counter()
    for row in robot.approximations[detector.spheres]:
        spheres[row.component] += row.count
    compared = sum(spheres[a] * spheres[b] for a, b in pairs)
    if compared > MAX_SPHERE_PAIRS:
        message = f"expected at most {MAX_SPHERE_PAIRS:,} pairs of spheres to compare, got {compared:,}"
        raise InputError(message, (*where, "spheres"))


def _explain_no_pairs(robot: Robot, detector: Detector) -> str:
    left_out = list_left_out(robot, detector)
    if not left_out:
        return f"{robot.components(detector.spheres)[0]!r} is the only component"
    named = ", ".join(f"{pair.a} - {pair.b} ({pair.reason})" for pair in left_out[:NAMED])
    more = f" and {len(left_out) - NAMED} more" if len(left_out) > NAMED else ""
    return f"{'the only pair is' if len(left_out) == 1 else f'all {len(left_out)} pairs are'} left out: {named}{more}"
