"""Which pairs of links are compared: all but adjacent ones, those that the SRDF disables, and those that touch."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

from ikde.errors import InputError, nearest, quoted
from ikde.io.srdf import Srdf
from ikde.model.collision_model import CollisionModel
from ikde.model.pairs import component_bodies, describe_link
from ikde.model.robot import WORLD, AdjacentPair, Detector, Pairs, Robot
from ikde.model.tree import build_tree
from ikde.model.validate import NON_ADJACENT, check_robot
from ikde.solver.pair_verdicts import PairVerdict, judge_pairs
from ikde.solver.plain import compute_gaps
from ikde.solver.touching import draw_configurations

SPHERES = "spheres"
TRIED, OFTEN, NAMED = 200, 0.25, 3  # configurations; the share of them in which a pair touches often; pairs in a line


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenPairs:
    """A checked robot with its detector, and what was found out about its pairs."""

    robot: Robot
    never: Pairs = ()
    """Compared pairs that are proved never to touch."""
    often: Pairs = ()
    """Compared pairs that touch in a quarter of random configurations or more, the worst first."""
    warnings: tuple[str, ...] = ()


def choose_pairs(
    draft: Robot, frame_of: Mapping[str, str], srdf: Srdf, asked: Iterable[tuple[str, str]]
) -> ChosenPairs:
    """Choose the pairs of a robot with spheres, and give each that is left out its reason in the robot.

    Links of one body, and links between which a joint stands and no other link with spheres, are adjacent. Of all
    others those are left out that the SRDF disables, and those that touch whatever the joints do: proved, or found in
    each of 1,000 random configurations, as the reason says.

    Args:
        draft: the robot with the approximation `spheres`, not yet checked.
        frame_of: the frame of each link.
        srdf: pairs that its maker left out.
        asked: pairs of links that are compared whatever is found.

    Raises:
        InputError: for a pair that is asked for and that there is not, or what is wrong with the robot.
    """
    components = dict.fromkeys(entry.component for entry in draft.approximations[SPHERES])
    wanted = _find_asked(frame_of, components, asked)
    disabled, notes = _read_disabled(frame_of, components, srdf)
    joined, adjacent = _find_joined(check_robot(draft))
    left_out = tuple(pair for key, pair in disabled.items() if key not in {*wanted, *adjacent})
    compared = [pair for key, pair in joined.items() if key not in disabled]
    compared += [pair for key, pair in wanted.items() if key in adjacent or (key in joined and key in disabled)]
    draft = replace(draft, adjacent=left_out, compared=tuple(compared))
    chosen = leave_out_touching(draft, Detector(name=SPHERES, spheres=SPHERES, pairs=NON_ADJACENT), wanted)
    return replace(chosen, warnings=(*notes, *chosen.warnings))


def _find_asked(
    frame_of: Mapping[str, str], components: Iterable[str], asked: Iterable[tuple[str, str]]
) -> dict[frozenset[str], tuple[str, str]]:
    """Pairs of components by what they are made of."""
    found, known = {}, list(components)
    for a, b in asked:
        pair = (frame_of.get(a, a), frame_of.get(b, b))
        for link, component in zip((a, b), pair, strict=True):
            if component not in known:
                message = f"no link with spheres is called {quoted(link)}{nearest(link, known)}"
                raise InputError(message, ("compare", f"{a}:{b}"))
        if pair[0] == pair[1]:
            raise InputError("expected two links", ("compare", f"{a}:{b}"))
        found[frozenset(pair)] = pair
    return found


def _read_disabled(
    frame_of: Mapping[str, str], components: Iterable[str], srdf: Srdf
) -> tuple[dict[frozenset[str], AdjacentPair], list[str]]:
    """Pairs of components that the SRDF leaves out, each once, and which of its links are unknown."""
    found: dict[frozenset[str], AdjacentPair] = {}
    unknown: dict[str, None] = {}
    known = set(components)
    for pair in srdf.disabled:
        for link in (pair.a, pair.b):
            if link not in frame_of:
                unknown[link] = None
        a, b = (frame_of.get(link, "") for link in (pair.a, pair.b))
        if a != b and {a, b} <= known:
            found.setdefault(frozenset((a, b)), AdjacentPair(a=a, b=b, reason=f"SRDF: {pair.reason or 'disabled'}"))
    notes = [f"the SRDF names links that there are not: {', '.join(list(unknown)[:8])}"] if unknown else []
    return found, notes


def _find_joined(robot: Robot) -> tuple[dict[frozenset[str], tuple[str, str]], set[frozenset[str]]]:
    """Pairs that a joint joins although another link with spheres stands between them; and pairs that are adjacent."""
    tree = build_tree(robot)
    bodies = component_bodies(robot.approximations[SPHERES], tree)
    parents = {frame.name: frame.parent for frame in robot.frames}
    joined, adjacent = {}, set()
    for a, b in combinations(bodies, 2):
        if describe_link(robot, tree, bodies[a], bodies[b]):
            if bodies[a] != bodies[b] and _is_anything_between(parents, a, b, set(bodies)):
                joined[frozenset((a, b))] = (a, b)
            else:
                adjacent.add(frozenset((a, b)))
    return joined, adjacent


def _is_anything_between(parents: Mapping[str, str], a: str, b: str, components: set[str]) -> bool:
    """Whether a frame with spheres stands on the way from one frame to the other."""
    ways = [_list_above(parents, name) for name in (a, b)]
    shared = next(frame for frame in ways[0] if frame in ways[1])
    between = {frame for way in ways for frame in way[: way.index(shared) + 1]} - {a, b}
    return bool(between & components)


def _list_above(parents: Mapping[str, str], name: str) -> list[str]:
    way = [name]
    while way[-1] != WORLD:
        way.append(parents[way[-1]])
    return way


def leave_out_touching(
    draft: Robot, detector: Detector, wanted: Collection[frozenset[str]] = frozenset()
) -> ChosenPairs:
    """The robot, checked, with a detector of all pairs that do not always touch, and of those that are asked for.

    Args:
        draft: a robot without that detector.
        detector: of all pairs that are not adjacent; it becomes the default.
        wanted: pairs that are compared even if they always touch.
    """
    total = len(check_robot(draft).pair_lists[NON_ADJACENT])
    if not total:
        return ChosenPairs(robot=check_robot(draft), warnings=(_NONE_LEFT,))
    detectors = {**draft.detectors, detector.name: detector}
    with_all = check_robot(replace(draft, detectors=detectors, default_detector=detector.name))
    verdicts = judge_pairs(CollisionModel.of(with_all))
    always = {pair: verdict for pair, verdict in verdicts.items() if verdict.touches == "always"}
    left_out = {pair: verdict for pair, verdict in always.items() if frozenset(pair) not in wanted}
    notes = _describe(total, left_out, [pair for pair in always if pair not in left_out])
    adjacent = tuple(AdjacentPair(a=a, b=b, reason=verdict.reason) for (a, b), verdict in left_out.items())
    joined = {frozenset(pair) for pair in left_out}
    draft = replace(
        draft,
        adjacent=draft.adjacent + adjacent,
        compared=tuple(pair for pair in draft.compared if frozenset(pair) not in joined),
    )
    if len(left_out) == total:
        return ChosenPairs(robot=check_robot(draft), warnings=(*notes, _NONE_LEFT))
    robot = check_robot(replace(draft, detectors=detectors, default_detector=detector.name))
    never = tuple(pair for pair, verdict in verdicts.items() if verdict.touches == "never" and verdict.is_proved)
    often, warnings = _find_often(CollisionModel.of(robot))
    return ChosenPairs(robot=robot, never=never, often=often, warnings=(*notes, *warnings))


def _find_often(collision: CollisionModel) -> tuple[Pairs, list[str]]:
    """Pairs that touch so often that few configurations are free, and what is said of them."""
    drawn = draw_configurations(collision.robot)[:TRIED]
    hits = compute_gaps(collision, drawn) <= collision.limit_m
    shares = dict(zip(collision.pairs, hits.mean(axis=0).tolist(), strict=True))
    often = tuple(sorted((pair for pair in shares if shares[pair] >= OFTEN), key=lambda pair: -shares[pair]))
    if not often:
        return (), []
    named = ", ".join(f"{a} - {b} ({shares[a, b]:.0%})" for a, b in often[:NAMED])
    free = f"{1.0 - hits.any(axis=1).mean():.0%} of {TRIED} random configurations are free of self-collision"
    advice = "spheres that stand out less (--protrusion) may keep them apart"
    return often, [f"{free}; most often these touch: {named}; {advice}"]


_NONE_LEFT = "no two links are left that could collide: self-collision is not checked"


def _describe(total: int, left_out: Mapping[tuple[str, str], PairVerdict], kept: list[tuple[str, str]]) -> list[str]:
    notes = [f"{len(left_out)} of {total} pairs always touch and are left out"] if left_out else []
    if kept:
        named = ", ".join(f"{a} - {b}" for a, b in kept)
        notes.append(f"{named}: compared as asked for, though always touching: no configuration is free")
    return notes
