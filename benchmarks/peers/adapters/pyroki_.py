"""PyRoki on the CPU: its basic least-squares solve, compiled by JAX, blind to collisions."""

from typing import Any

import jax
import jax.numpy as jnp
import jax_dataclasses as jdc
import jaxlie
import jaxls
import numpy as np
import pyroki
import yourdfpy
from loguru import logger
from protocol import Peer, Setup

logger.remove()  # both libraries write a line for each problem


@jdc.jit
def _descend(
    robot: Any, tool: jax.Array, wxyz: jax.Array, p: jax.Array, start: jax.Array, turn: jax.Array
) -> jax.Array:
    """PyRoki's own example `_solve_ik.py`, from a given start."""
    variable = robot.joint_var_cls(0)
    target = jaxlie.SE3.from_rotation_and_translation(jaxlie.SO3(wxyz), p)
    costs = [
        pyroki.costs.pose_cost_analytic_jac(robot, variable, target, tool, pos_weight=50.0, ori_weight=turn),
        pyroki.costs.limit_cost(robot, variable, weight=100.0),
    ]
    problem = jaxls.LeastSquaresProblem(costs, [variable]).analyze()
    solution = problem.solve(
        initial_vals=jaxls.VarValues.make([variable.with_value(start)]),
        verbose=False,
        linear_solver="dense_cholesky",
        trust_region=jaxls.TrustRegionConfig(lambda_initial=1.0),
    )
    return solution[variable]


class Example(Peer):
    """Its example, from collision-free seeds."""

    def prepare(self, setup: Setup) -> None:
        """From URDF."""
        super().prepare(setup)
        urdf = yourdfpy.URDF.load(str(setup.urdf), load_meshes=False, build_scene_graph=True)
        self.robot = pyroki.Robot.from_urdf(urdf)
        assert tuple(self.robot.joints.actuated_names) == setup.robot.joint_names
        self.tool = jnp.array(self.robot.links.names.index(setup.robot.tool))
        self.turn = jnp.array(10.0 if setup.is_pose else 0.0)

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """Quaternion and position on the device."""
        return jnp.array(jaxlie.SO3.from_matrix(jnp.array(R)).wxyz), jnp.array(p), p, R

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Runs from collision-free seeds; the caller's own check of the pose is ikde's."""
        import ikde

        wxyz, place, p, R = target
        robot, tool, draw = self.setup.robot, self.setup.robot.tool, self.setup.checker.draw_free

        def attempt() -> np.ndarray | None:
            q = np.array(_descend(self.robot, self.tool, wxyz, place, jnp.array(draw()), self.turn), dtype=float)
            return q if self.setup.reaches(ikde.forward(robot, q)[tool], p, R) else None

        return self.restart(attempt, deadline)
