"""What kernels, graders and plain numpy say of a robot that holds things is what distances by other means say."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.arrays import DescentArrays
from ikde.kernels.clearance import judge_centres
from ikde.kernels.flat_arguments import Terms, flatten_grader, flatten_search
from ikde.kernels.grade_many import grade_many
from ikde.kernels.grade_one import grade_one
from ikde.kernels.world import find_obstacle_at, find_obstacle_of, stands_in_world
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.world import make_world
from ikde.solver.engines.pool import no_pool
from tests.attached import OWN, STICK, hold, is_free, list_gaps, place
from tests.kernels.arrays import freeze
from tests.solids import random_world
from tests.three_joints import KINDS, ROBOT, free_q, meet
from tests.written import written_kernels

FIXED = ("floor", "post")


def draw_model(rng, count, **options):
    world = random_world(rng, count, kinds=("box", "cylinder", "cone", "hull"), far=0.9, margin_m=0.01, ignore=FIXED)
    touch = ("o0",) if count else ()
    return OWN.in_world(hold(world, margin_m=0.02, may_touch=touch, **options), 0.01, {"hand": 0.0, "stick": 0.005})


@pytest.mark.parametrize("count", [0, 1, 6])
def test_verdicts_and_clearances(count, rng):
    model, verdicts = draw_model(rng, count, ball=count != 1), []
    Q = rng.uniform(ROBOT.lower, ROBOT.upper, (40, 3))
    rows, target = ikde.check_many(ROBOT, Q, model), ikde.Target((0.3, 0.2, 0.4))
    block = flatten_grader(pack_robot(ROBOT), model.arrays, Terms(freeze([ROBOT.lower, ROBOT.upper]), np.inf, np.inf))
    figures, places, accepted = np.empty((40, 3)), np.empty(40, dtype=np.int64), np.empty(40, dtype=np.bool_)
    grade_many(*block, *pack_targets([target] * 40), Q, figures, places, accepted)
    collides = np.empty(40, dtype=np.bool_)
    judge_centres(pack_robot(ROBOT), model.arrays, Q, collides)
    for k, q in enumerate(Q):
        found = list_gaps(model, q)
        of_pair = dict(zip(rows.pairs, rows.gaps_m[k], strict=True))
        assert max(abs(of_pair[pair] - gap) for pair, (gap, _) in found.items()) < 1e-12
        assert all(np.isinf(gap) for pair, gap in of_pair.items() if pair not in found)
        free = is_free(model, q)
        assert (bool(rows.collision[k]), bool(accepted[k]), bool(collides[k])) == (not free, free, not free)
        short = {pair: gap - asked for pair, (gap, asked) in found.items()}
        assert short[model.name_pair(places[k])] == pytest.approx(min(short.values()), abs=1e-12)
        one = grade_one.plain(*block, *pack_targets([target]), q)
        assert (one[2], one[3], one[4]) == (figures[k, 2], places[k], accepted[k])
        verdicts.append(free)
    assert 0 < sum(verdicts) < len(verdicts)


@pytest.mark.parametrize("count", [0, 4])
def test_what_written_kernels_ask_is_about_what_is_held_too(count, rng):
    model, found = draw_model(rng, count), set()
    ranges = np.array([ROBOT.lower, ROBOT.upper, ROBOT.home])
    numbers, whole = flatten_search(pack_robot(ROBOT), model.arrays, ranges, DescentArrays(), no_pool(ROBOT, 1.0))[:2]
    assert stands_in_world.plain(whole)
    own = len(OWN.pairs)
    for q in rng.uniform(ROBOT.lower, ROBOT.upper, (20, 3)):
        with np.errstate(all="ignore"):
            hit = find_obstacle_at.plain(numbers, whole, q)
            assert hit == find_obstacle_of.plain(pack_robot(ROBOT), model.arrays, q)
        gaps = list_gaps(model, q)
        short = {pair for pair, (gap, asked) in gaps.items() if gap <= asked and pair not in OWN.pairs}
        names = {pair if pair in model.pairs else (ROBOT.name, pair[1]) for pair in short}
        assert (model.counted[hit] in names) if hit >= 0 else not names
        assert hit == -1 or hit >= own
        found.add("none" if hit < 0 else "held" if hit < len(model.pairs) else "world")
    assert found >= {"none", "held"}


@pytest.mark.parametrize("written", [False, True], ids=["tables", "written"])
@pytest.mark.parametrize("count", [0, 5])
def test_what_is_reached_is_free(count, written, rng, monkeypatch):
    model, reached = draw_model(rng, count), 0
    targets = [meet(ROBOT, q, kind) for q, kind in zip(free_q(12), 4 * KINDS, strict=True)]

    def ask():
        rows = ikde.solve_many(ROBOT, targets, collision=model, bulk=ikde.BulkOptions(explain=False, verify="all"))
        return [*rows, *(ikde.solve(ROBOT, target, collision=model, near=ROBOT.home) for target in targets[:4])]

    if written:
        with written_kernels(monkeypatch):
            results = ask()
            again = ikde.solve(ROBOT, targets[0], collision=model)
    else:
        results, again = ask(), ikde.solve(ROBOT, targets[0], collision=model)
    for result in results:
        assert result.verified is not False
        assert not result.reached or is_free(model, result.q)
        reached += result.reached
    assert again.reached == results[0].reached
    assert 0 < reached < len(results)


def test_a_pair_with_what_is_held_is_named_as_any_other():
    model = OWN.in_world(hold(make_world([]), ball=False))
    q = next(q for q in free_q(100) if list_gaps(model, q)["floor", "stick"][0] <= 0.0)
    frozen = dict(zip(ROBOT.joint_names, q.tolist(), strict=True))
    result = ikde.solve(ROBOT, meet(ROBOT, q, "position"), collision=model, freeze=frozen)
    assert (result.reached, result.collision, result.stop_reason) == (False, True, "collision")
    assert "floor and stick collide" in result.reason
    assert ("floor", "stick") in result.blocking_pairs
    pair = next(pair for pair in ikde.check(ROBOT, q, model).pairs if pair.b == "stick")
    assert pair.collides
    assert pair.clearance_m == pytest.approx(list_gaps(model, q)[pair.a, pair.b][0], abs=1e-12)


def test_bare_hands_answer_with_the_bits_of_before(rng):
    """Holding and letting go leaves nothing behind."""
    targets, world = [meet(ROBOT, q, "axis") for q in free_q(6)], make_world([])
    before = ikde.solve_many(ROBOT, targets)
    held = hold(world)
    ikde.solve_many(ROBOT, targets, collision=held)
    after = ikde.solve_many(ROBOT, targets, collision=held.detach("stick").detach("ball").remove("stick", "ball"))
    assert before.q.tobytes() == after.q.tobytes()
    assert (before.clearance_m == after.clearance_m).all()


def test_nothing_is_compiled_for_what_is_held(monkeypatch):
    """Neither another module is written, nor another kind of arguments is seen."""
    target, kernels = meet(ROBOT, free_q(1)[0], "position"), (grade_many,)
    with written_kernels(monkeypatch) as asked:
        ikde.solve_many(ROBOT, [target] * 3, collision=make_world([]))
        seen, names = [len(kernel.compiled.signatures) for kernel in kernels], set(asked)
        with ikde.compile_clock(lambda: None) as clock:
            for world in (hold(make_world([])), hold(make_world([]), ball=False)):
                ikde.solve(ROBOT, target, collision=world)
                ikde.solve_many(ROBOT, [target] * 3, collision=world)
        assert clock.seconds == 0.0
        assert [len(kernel.compiled.signatures) for kernel in kernels] == seen
        assert set(asked) == names


def test_what_always_touches_is_refused_with_the_line_to_add():
    world = hold(make_world([]), ball=False).detach("stick")
    held = world.attach("stick", "sleeve", T_frame_object=place(), spheres=[[0.0, 0.0, 0.0, 0.2]])
    line = r"^attached\.stick: stick touches .*post.* in each of 1,000 random configurations.*may_touch: \[.*post"
    for ask in (ikde.check, lambda robot, q, collision: ikde.solve(robot, (0.3, 0.2, 0.4), collision=collision)):
        with pytest.raises(InputError, match=line):
            ask(ROBOT, ROBOT.home, held)


def test_names_that_are_two_things_are_refused(rng):
    world = random_world(rng, 1, kinds=("box",), far=0.9)
    twice = world.add(world["o0"].__class__(**{**_fields(world["o0"]), "name": "arm"}))
    held = twice.attach("o0", "tip", T_frame_object=place(), spheres=STICK, may_touch=("arm",))
    with pytest.raises(InputError, match="'arm' is a component and an obstacle: give one of them another name"):
        OWN.in_world(held)
    with pytest.raises(InputError, match=r"no component is called 'stik' \(did you mean 'stick'\?\)"):
        OWN.in_world(hold(world), 0.0, {"stik": 0.1})


def _fields(obstacle):
    names = ("name", "solids", "T_world_obstacle", "frame", "margin_m", "ignore", "group")
    return {name: getattr(obstacle, name) for name in names}
