"""A world becomes one array; what it names must be there."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.kernels.flat_arguments import unpack_world
from ikde.model.collision_model import CollisionModel
from ikde.model.pack_world import WorldPacker, pack_world
from ikde.model.robot import WORLD
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from tests.three_joints import ROBOT

OWN, FRAMES = CollisionModel.of(ROBOT), {WORLD: np.eye(4)}
BALL = make_solid("sphere", (0.1,))


def test_what_is_asked_for_is_the_sum_of_margins_and_nothing_where_it_is_ignored():
    obstacles = [make_obstacle("a", [BALL], margin_m=0.02), make_obstacle("b", [BALL, BALL], ignore=("hand",))]
    packed = unpack_world.plain(pack_world(make_world(obstacles), ["arm", "hand"], FRAMES, 0.5, np.array([0.0, 0.01])))
    assert packed.asked.tolist() == [[0.02, 0.0], [0.03, -np.inf]]
    assert packed.solids.shape[0] == 3


def test_groups_that_are_off_are_left_out():
    world = make_world([make_obstacle("a", [BALL], group="cups"), make_obstacle("b", [BALL])]).switch(cups=False)
    assert unpack_world.plain(pack_world(world, ["arm"], FRAMES, 0.5, np.zeros(1))).asked.shape == (1, 1)


def test_a_frame_that_moves_and_a_component_that_is_not_there_are_refused():
    with pytest.raises(InputError, match=r"^obstacles\.a\.frame: no frame that stays in its place is called 'tool'"):
        OWN.in_world(make_world([make_obstacle("a", [BALL], frame="tool")]))
    with pytest.raises(InputError, match=r"^obstacles\.a\.ignore\[0\]: no component is called 'hnad'"):
        OWN.in_world(make_world([make_obstacle("a", [BALL], ignore=("hnad",))]))


def test_margins_that_do_not_fit_are_refused():
    world = make_world([make_obstacle("a", [BALL])])
    for margin_m, margins_m, message in (
        (-0.1, None, r"^margin: expected a distance of at least 0 m, got -0.1"),
        (float("nan"), None, r"^margin: expected a distance of at least 0 m, got nan"),
        (2e5, None, r"^margin: expected a distance of at least 0, up to 100000 m, got 200000"),
        (0.0, {"hnad": 0.0}, r"^margin\.hnad: no component is called 'hnad'"),
        (0.0, {"post": "x"}, r"^margin\.post: expected a distance of at least 0 m, got 'x'"),
    ):
        with pytest.raises(InputError, match=message):
            OWN.in_world(world, margin_m, margins_m)
    with pytest.raises(InputError, match=r"^world: expected a World, got 3"):
        OWN.in_world(3)


def crowd(count, rng):
    kinds = (("box", (0.1, 0.2, 0.3)), ("capsule", (0.05, 0.3)), ("cone", (0.1, 0.2)))
    shapes = [make_solid(*kinds[k % 3]) for k in range(count)]
    cloud = make_solid("cloud", (0.01,), points=rng.uniform(-0.2, 0.2, (50, 3)))
    hull = make_solid("hull", points=rng.normal(size=(8, 3)))
    solids = [[cloud, hull], *([shape, BALL] for shape in shapes)]
    return make_world([make_obstacle(f"o{k}", own, shifted(rng)) for k, own in enumerate(solids)])


def shifted(rng):
    T = np.eye(4)
    T[:3, 3] = rng.uniform(-1.0, 1.0, 3)
    return T


@pytest.mark.parametrize("count", [4, 20])  # the latter with a grid
def test_a_changed_world_is_packed_as_if_nothing_had_been_before(count, rng):
    world = crowd(count, rng)
    packer, changed = WorldPacker(["arm", "hand"], FRAMES, 0.5), world
    changes = [
        lambda world: world.move("o2", shifted(rng)),
        lambda world: world.move("o0", shifted(rng)).move("o3", shifted(rng)),
        lambda world: world.add(make_obstacle("new", [BALL], ignore=("arm",))),
        lambda world: world.remove("o1"),
        lambda world: world.remove("new").add(make_obstacle("new", [BALL], margin_m=0.3)),
        lambda world: world.remove("new").add(make_obstacle("new", [BALL], ignore=("hand",))),
        lambda world: world.remove("new").add(replace(world["new"], margin_m=0.2)),
        lambda world: world.move("o0", shifted(rng)),
        lambda _: world,
    ]
    for kept_m in (np.zeros(2), np.array([0.0, 0.1])):
        for change in changes:
            changed = change(changed)
            found = packer.pack(changed, kept_m)
            assert found.tobytes() == pack_world(changed, ["arm", "hand"], FRAMES, 0.5, kept_m).tobytes()
            assert not found.flags.writeable
