"""Cells and bounding spheres leave out only what is free: the verdicts are those of comparing everything."""

import numpy as np
import pytest

from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.frames import compute_bodies
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.world_grades import measure_world
from ikde.kernels.world_grid import find_hit
from ikde.model import pack_world as module
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.pack_world import find_fixed_frames, pack_world
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver.plain import compute_components
from ikde.solver.plain_world import measure_obstacle
from tests.solids import CONVEX, random_world
from tests.three_joints import ROBOT

COLLISION = CollisionModel.of(ROBOT)
COMPONENTS = list(dict.fromkeys(sphere.component for sphere in COLLISION.spheres))
KEPT = 0.01 * np.arange(len(COMPONENTS))  # m


@pytest.fixture(params=[2, 10_000], ids=["cells", "no cells"])
def fewest(request, monkeypatch):
    """From how many solids on there are cells."""
    monkeypatch.setattr(module, "MIN_FOR_GRID", request.param)


def pack(world, kept=KEPT):
    reach = float(COLLISION.arrays.bounds[:, 3].max())
    return pack_world(world, COMPONENTS, find_fixed_frames(ROBOT), reach, kept)


def place(q):
    robot, collision = pack_robot(ROBOT), COLLISION.arrays
    T, bounds = np.empty((len(robot.bodies), 3, 4)), np.empty((len(collision.components), 3))
    centres = np.empty((3, collision.radius.size))
    compute_bodies.plain(robot, q, T)
    compute_bounds.plain(collision, T, bounds)
    compute_centres.plain(collision, T, centres)
    return bounds, centres


def plain_gaps(world, q):
    """[C, O] m, each less what is asked for; inf where they are not compared."""
    found = np.full((len(COMPONENTS), len(world.active)), np.inf)
    for c, (name, (centres, radii)) in enumerate(compute_components(COLLISION, q).items()):
        assert name == COMPONENTS[c]
        for o, obstacle in enumerate(world.active):
            if name not in obstacle.ignore:
                found[c, o] = (measure_obstacle(obstacle, centres) - radii).min() - obstacle.margin_m - KEPT[c]
    return found


def draw(rng, count):
    return rng.uniform(ROBOT.lower, ROBOT.upper, (count, len(ROBOT.joints)))


def test_hits_and_distances_are_those_of_comparing_everything(fewest, rng):
    verdicts = []
    for count in (1, 5, 14):
        world = random_world(rng, count, margin_m=0.01, ignore=(COMPONENTS[0],))
        arrays = unpack_world.plain(pack(world))
        for q in draw(rng, 12):
            bounds, centres = place(q)
            gaps = plain_gaps(world, q)
            with np.errstate(all="ignore"):
                hit = find_hit.plain(arrays, COLLISION.arrays, bounds, centres)
                gap, which = measure_world.plain(arrays, COLLISION.arrays, centres, np.inf)
            assert (hit >= 0) == (gaps.min() <= 0.0)
            assert hit < 0 or gaps.ravel()[hit] <= 0.0
            assert abs(gap - gaps.min()) < 1e-12
            assert which == np.argmin(gaps)
            verdicts.append(hit >= 0)
    assert 0 < sum(verdicts) < len(verdicts)


def test_what_is_asked_for_from_one_obstacle_reaches_as_far_in_cells(fewest, rng):
    """A margin wider than all components are, of a small solid that stands alone."""
    T = np.column_stack([np.eye(3), (0.9, 0.2, 0.5)])
    world = make_world([make_obstacle("far", [make_solid("sphere", [0.002])], T, margin_m=0.6, ignore=("arm", "post"))])
    world = world.add(make_obstacle("other", [make_solid("sphere", [0.002])], T))
    verdicts = []
    for q in draw(rng, 25):
        arrays, (bounds, centres) = unpack_world.plain(pack(world, np.zeros(len(COMPONENTS)))), place(q)
        gaps = plain_gaps(world, q) + KEPT[:, None]
        with np.errstate(all="ignore"):
            hit = find_hit.plain(arrays, COLLISION.arrays, bounds, centres)
        assert (hit >= 0) == (gaps.min() <= 0.0)
        verdicts.append(hit >= 0)
    assert 0 < sum(verdicts) < len(verdicts)


def test_what_is_farther_than_its_reach_is_not_measured(rng):
    world = random_world(rng, 3, kinds=CONVEX, far=0.5)
    arrays, (_, centres) = unpack_world.plain(pack(world)), place(ROBOT.home)
    gap = plain_gaps(world, ROBOT.home).min()
    with np.errstate(all="ignore"):
        assert measure_world.plain(arrays, COLLISION.arrays, centres, gap - 1e-9) == (np.inf, -1)
        assert measure_world.plain(arrays, COLLISION.arrays, centres, gap + 1e-9)[1] >= 0


def test_without_an_obstacle_nothing_is_hit():
    arrays, (bounds, centres) = unpack_world.plain(pack(make_world([]))), place(ROBOT.home)
    assert find_hit.plain(arrays, COLLISION.arrays, bounds, centres) == -1
    assert measure_world.plain(arrays, COLLISION.arrays, centres, np.inf) == (np.inf, -1)


@pytest.mark.parametrize("kept", [0.0, 0.3], ids=["near", "far"])
def test_small_solids_that_are_asked_for_at_a_distance_are_found(fewest, rng, kept):
    """Where all that is asked for comes from one component's margin, cells and bounds still hold what is near."""
    asked = np.where(np.arange(len(COMPONENTS)) == len(COMPONENTS) - 1, kept, 0.0)
    solids = {f"s{k}": make_solid("sphere", [0.002]) for k in range(40)}
    verdicts = []
    for q in draw(rng, 25):
        places = rng.uniform(-1.0, 1.0, (len(solids), 3))
        posed = [np.column_stack([np.eye(3), p]) for p in places]
        world = make_world(make_obstacle(name, [solids[name]], T) for name, T in zip(solids, posed, strict=True))
        arrays, (bounds, centres) = unpack_world.plain(pack(world, asked)), place(q)
        gaps = plain_gaps(world, q) + (KEPT - asked)[:, None]
        with np.errstate(all="ignore"):
            hit = find_hit.plain(arrays, COLLISION.arrays, bounds, centres)
        assert (hit >= 0) == (gaps.min() <= 0.0)
        verdicts.append(hit >= 0)
    assert any(verdicts)
