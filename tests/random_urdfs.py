"""Random URDFs: trees of links in any order, all kinds of joints about any axis, limits, mimics, shapes."""

import numpy as np

from tests.urdf_texts import joint

KINDS = ("revolute", "revolute", "continuous", "prismatic", "fixed")


def random_urdf(seed):
    """The text of a URDF with 3 to 9 links, the last of them a tool that a joint moves; the same for the same seed."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 10))
    parts = [f'<link name="l{k}">{_shape(rng)}</link>' for k in range(count)]
    for k in range(1, count):
        kind = "revolute" if k == 1 else str(rng.choice(KINDS))
        parent = 0 if k == 1 else int(rng.integers(0, k)) if k < count - 1 else k - 1
        parts.append(joint(f"j{k}", kind, f"l{parent}", f"l{k}", _inside(rng)))
    rng.shuffle(parts)
    return f'<robot name="random">{"".join(parts)}</robot>'


def _inside(rng):
    xyz, rpy, axis = (" ".join(map(repr, rng.normal(size=3).tolist())) for _ in range(3))
    lower, upper = np.sort(rng.uniform(-2, 2, 2)).tolist()
    limit = f'<limit lower="{lower!r}" upper="{upper!r}" velocity="1" effort="1"/>'
    return f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{limit}'


def _shape(rng):
    if rng.random() < 0.3:
        return ""
    xyz = " ".join(map(repr, rng.normal(size=3).tolist()))
    radius = float(rng.uniform(0.01, 0.3))
    return f'<collision><origin xyz="{xyz}"/><geometry><sphere radius="{radius!r}"/></geometry></collision>'
