"""Which components can never be told apart by a joint: adjacency, and the list of all pairs that are not adjacent."""

from itertools import combinations

from ikde.model.robot import Pairs, SphereRow
from ikde.model.tree import Tree


def component_bodies(rows: tuple[SphereRow, ...], tree: Tree) -> dict[str, int]:
    """Body of each component; a component's rows all lie on one body (`model.validate`)."""
    return {row.component: tree.frame_body[row.start] for row in rows}


def are_adjacent(tree: Tree, occupied: set[int], a: int, b: int) -> bool:
    """True if two bodies are one, or a joint connects them; a body that carries no component does not part them."""
    return a == b or nearest_carrier(tree, occupied, a) == b or nearest_carrier(tree, occupied, b) == a


def nearest_carrier(tree: Tree, occupied: set[int], body: int) -> int | None:
    """The nearest body below `body` that carries a component, or None: then `body` belongs to the base."""
    while body != 0:
        body = tree.bodies[body].parent
        if body in occupied:
            return body
    return None


def non_adjacent_pairs(bodies: dict[str, int], tree: Tree, adjacent: Pairs) -> Pairs:
    """Every pair of components that is neither rigidly joined, nor shares a joint, nor is listed as `adjacent`."""
    occupied = set(bodies.values())
    listed = {frozenset(pair) for pair in adjacent}
    return tuple(
        (a, b)
        for a, b in combinations(bodies, 2)
        if not are_adjacent(tree, occupied, bodies[a], bodies[b]) and frozenset((a, b)) not in listed
    )
