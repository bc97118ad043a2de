"""Which pairs of links are compared: all but adjacent ones, those that the SRDF disables, and those that touch."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
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
NamedPairs = dict[frozenset[str], tuple[str, str]]
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


@dataclass(frozen=True, slots=True, kw_only=True)
class PairChoice:
    """What is said of pairs before any is measured."""

    srdf: Srdf = field(default_factory=Srdf)
    """Pairs that its maker left out, or put in."""
    asked: Pairs = ()
    """Pairs of links that are compared whatever is found."""
    safe_distance_m: float = 0.0
    """The clearance at which collision begins."""


def choose_pairs(draft: Robot, component_of: Mapping[str, str], choice: PairChoice) -> ChosenPairs:
    """Choose the pairs of a robot with spheres, and give each that is left out its reason in the robot.

    Links of one body, and links between which a joint stands and no other link with spheres, are adjacent. Of all
    others those are left out that the SRDF disables, and those that touch whatever the joints do: proved, or found in
    each of 1,000 random configurations, as the reason says.

    Args:
        draft: the robot with the approximation `spheres`, not yet checked.
        component_of: the component that each link is.
        choice: what is said of pairs.

    Raises:
        InputError: for a pair that is asked for and that there is not, or what is wrong with the robot.
    """
    components = dict.fromkeys(entry.component for entry in draft.approximations[SPHERES])
    srdf = choice.srdf
    wanted = _find_asked(component_of, components, choice.asked)
    wanted |= _read_enabled(component_of, components, srdf)
    disabled, notes = _read_disabled(component_of, components, srdf)
    joined, adjacent = _find_joined(check_robot(draft))
    left_out = tuple(pair for key, pair in disabled.items() if key not in wanted.keys() | adjacent.keys())
    whole = adjacent if srdf.is_whole else {}
    compared = {key: pair for key, pair in (joined | whole).items() if key not in disabled}
    compared |= {key: pair for key, pair in wanted.items() if key in adjacent or key in joined}
    draft = replace(draft, adjacent=left_out, compared=tuple(compared.values()))
    detector = Detector(name=SPHERES, spheres=SPHERES, pairs=NON_ADJACENT, safe_distance_m=choice.safe_distance_m)
    chosen = leave_out_touching(draft, detector, wanted)
    return replace(chosen, warnings=(*notes, *chosen.warnings))


def _find_asked(
    component_of: Mapping[str, str], components: Iterable[str], asked: Iterable[tuple[str, str]]
) -> NamedPairs:
    """Pairs of components by what they are made of."""
    found, known = {}, list(components)
    for a, b in asked:
        pair = (component_of.get(a, a), component_of.get(b, b))
        for link, component in zip((a, b), pair, strict=True):
            if component not in known:
                message = f"no link with spheres is called {quoted(link)}{nearest(link, known)}"
                raise InputError(message, ("compare", f"{a}:{b}"))
        if pair[0] == pair[1]:
            raise InputError("expected two links", ("compare", f"{a}:{b}"))
        found[frozenset(pair)] = pair
    return found


def _read_disabled(
    component_of: Mapping[str, str], components: Iterable[str], srdf: Srdf
) -> tuple[dict[frozenset[str], AdjacentPair], list[str]]:
    """Pairs of components that the SRDF leaves out, each once, and which of its links are unknown."""
    found: dict[frozenset[str], AdjacentPair] = {}
    unknown: dict[str, None] = {}
    known = set(components)
    for pair in srdf.disabled:
        for link in (pair.a, pair.b):
            if link not in component_of:
                unknown[link] = None
        a, b = (component_of.get(link, "") for link in (pair.a, pair.b))
        if a != b and {a, b} <= known:
            found.setdefault(frozenset((a, b)), AdjacentPair(a=a, b=b, reason=_describe_source(srdf, pair.reason)))
    notes = [f"{srdf.source} names links that there are not: {', '.join(list(unknown)[:8])}"] if unknown else []
    return found, notes


def _describe_source(srdf: Srdf, reason: str) -> str:
    """What leaves a pair out, and why."""
    return f"{srdf.source.removeprefix('the ')}: {reason or 'disabled'}"


def _read_enabled(component_of: Mapping[str, str], components: Iterable[str], srdf: Srdf) -> NamedPairs:
    """Pairs of components that the SRDF compares whatever joins them."""
    known = set(components)
    named = [(component_of.get(a, ""), component_of.get(b, "")) for a, b in srdf.enabled]
    return {frozenset(pair): pair for pair in named if pair[0] != pair[1] and set(pair) <= known}


def _find_joined(robot: Robot) -> tuple[NamedPairs, NamedPairs]:
    """Pairs that a joint joins although another link with spheres stands between them; and pairs that are adjacent."""
    tree = build_tree(robot)
    bodies = component_bodies(robot.approximations[SPHERES], tree)
    parents = {frame.name: frame.parent for frame in robot.frames}
    frames = {entry.component: entry.start for entry in robot.approximations[SPHERES]}
    joined, adjacent = {}, {}
    for a, b in combinations(bodies, 2):
        if describe_link(robot, tree, bodies[a], bodies[b]):
            is_apart = bodies[a] != bodies[b] and _is_anything_between(
                parents, frames[a], frames[b], {*frames.values()}
            )
            (joined if is_apart else adjacent)[frozenset((a, b))] = (a, b)
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
