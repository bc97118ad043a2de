"""Write down which collision tests the proofs leave of the robots that ship with ikde: `left_tests.json`.

    python benchmarks/ship_proofs.py

After an edit of their files or of the proofs; `tests/model/generate/test_left_tests.py` fails until then.
"""

import json

from ikde.io.robots import load_robot, robot_names
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.assemble import MAX_TESTS
from ikde.model.generate.collision import count_tests
from ikde.model.generate.left_tests import WRITTEN, digest_proofs, prove_left, write_left
from ikde.model.pack import pack_robot


def main() -> None:
    """Every robot with each of its detectors whose tests are written one by one."""
    lines = []
    for robot in map(load_robot, robot_names()):
        for detector in robot.detectors:
            collision, arrays = CollisionModel.of(robot, detector), pack_robot(robot)
            if count_tests(collision.arrays) <= MAX_TESTS:
                left = write_left(prove_left(arrays, collision))
                lines.append(f"{json.dumps(digest_proofs(arrays, collision))}: {json.dumps(left)}")
    WRITTEN.write_text("{\n" + ",\n".join(sorted(set(lines))) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
