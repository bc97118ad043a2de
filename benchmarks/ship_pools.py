"""Write the pools of seeds that come with ikde, of its own robots with their default detectors: the draws kept.

    python -m benchmarks.ship_pools

Needed when a robot, a detector or what draws pools has changed: `tests/solver/engines/test_pool_files.py` says so.
"""

import ikde
from ikde.kernels.cache_files import seal
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS
from ikde.solver.engines.pool import digest_pool, draw_kept, make_whole_pool
from ikde.solver.engines.pool_files import SHIPPED, write_kept


def main() -> None:
    """Draw every pool anew, and remove what no robot asks for any more."""
    SHIPPED.mkdir(exist_ok=True)
    for path in SHIPPED.iterdir():
        path.unlink()
    for name in ikde.robot_names():
        collision = CollisionModel.of(ikde.load_robot(name))
        for kind in KINDS:
            pool = make_whole_pool(collision, kind)
            path = SHIPPED / f"{digest_pool(pool, collision)}.pool"
            path.write_bytes(seal(path, write_kept(draw_kept(pool, collision))))
            print(f"{name} {kind}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
