"""Every way of using a library that is compared, as plain data: reading it needs none of the libraries."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One way to solve."""

    name: str
    adapter: str
    """`file:Class` in `adapters/`."""
    use: str
    """One line: how it is used, on record beside its figures."""
    packages: tuple[str, ...]
    """Distributions whose versions go on the record."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """What the class is made with."""
    cores: int = 1
    batch: bool = False
    """True if `solve_batch` takes all targets at once; a target's time is then its share of the batch's."""


def select(words: list[str] | None) -> list[int]:
    """Places in `ROSTER` of those whose adapter or name holds a word; a whole name means that one alone."""
    names = {entry.name for entry in ROSTER}

    def is_meant(entry: Entry, word: str) -> bool:
        return word == entry.name if word in names else word in f"{entry.adapter} {entry.name}"

    return [k for k, e in enumerate(ROSTER) if words is None or any(is_meant(e, word) for word in words)]


def _ikde(method: str) -> Entry:
    use = f"the same with method='{method}'"
    return Entry(
        name=f"ikde, method {method}", adapter="ikde:Single", use=use, packages=("ikde",), options={"method": method}
    )


ROSTER = (
    Entry(
        name="ikde",
        adapter="ikde:Single",
        use="ikde.solve(robot, target, settings, seed=k) in a Python loop, result object and grade included",
        packages=("ikde", "numpy", "numba"),
    ),
    Entry(
        name="ikde.solve_many",
        adapter="ikde:Many",
        use="ikde.solve_many(robot, targets, settings, bulk=BulkOptions(threads=1)), arrays in and out: a share each",
        packages=("ikde", "numpy", "numba"),
        batch=True,
    ),
    _ikde("lm"),
    _ikde("analytic"),
    _ikde("memetic"),
    _ikde("de"),
    Entry(
        name="EAIK, base sampled",
        adapter="eaik_:Sampled",
        use="HPRobot(H, P).IK for the arm from bases drawn within its reach; every branch checked (numba)",
        packages=("EAIK",),
    ),
    Entry(
        name="EAIK",
        adapter="eaik_:Fixed",
        use="HPRobot(H, P).IK for an arm on a fixed base; the first branch that is exact, inside and free (numba)",
        packages=("EAIK",),
    ),
    Entry(
        name="RoboPlan SimpleIk",
        adapter="roboplan_:Simple",
        use="SimpleIk.solveIk(goal, home, solution) with its defaults (step 0.25, 100 iterations, 2 restarts, 5 ms), "
        "our tolerances; asked again from a collision-free start while it fails",
        packages=("roboplan", "pin", "coal"),
    ),
    Entry(
        name="RoboPlan SimpleIk, one call",
        adapter="roboplan_:Simple",
        use="the same with restarts and time without end, step_size=1, max_iters=40: the best mean of four steps, "
        "three dampings and two limits here",
        packages=("roboplan", "pin", "coal"),
        options={"step_size": 1.0, "max_iters": 40, "max_restarts": 1_000_000, "max_time": 5.0},
    ),
    Entry(
        name="Pinocchio, LM loop in C++",
        adapter="pinocchio:InCpp",
        use="the same loop, seeds and sphere check compiled with g++ -O3 -march=native against the wheel's headers",
        packages=("pin", "cmeel-eigen"),
    ),
    Entry(
        name="Pinocchio, LM loop in Python",
        adapter="pinocchio:InPython",
        use="computeJointJacobians and log6 in a damped loop, clipped to the limits, collision-free seeds; restarted",
        packages=("pin",),
    ),
    Entry(
        name="Robotics Toolbox ik_LM",
        adapter="rtb:Toolbox",
        use="ets.ik_LM(T) with its defaults (Chan, k = 1, 30 x 100 iterations), tol for the tolerances; restarted",
        packages=("roboticstoolbox-python",),
    ),
    Entry(
        name="Robotics Toolbox ik_LM, tuned, free seeds",
        adapter="rtb:Toolbox",
        use="ets.ik_LM(T, q0=collision-free random, method='chan', k=0.1, ilimit=10, slimit=1), the best of its three "
        "methods, five gains and two limits here; restarted",
        packages=("roboticstoolbox-python",),
        options={"free_seeds": True, "k": 0.1, "ilimit": 10, "slimit": 1},
    ),
    Entry(
        name="TRAC-IK",
        adapter="tracik:Speed",
        use="TracIK(...).ik(position, rotation, random seed), Speed, timeout 5 ms, epsilon from tolerance; restarted",
        packages=("pytracik",),
    ),
    Entry(
        name="TRAC-IK, two cores",
        adapter="tracik:Speed",
        use="the same with a core for each of its two threads, as it is made for",
        packages=("pytracik",),
        cores=2,
    ),
    Entry(
        name="Drake InverseKinematics",
        adapter="drake:Program",
        use="position and orientation constraints, AddMinimumDistanceLowerBoundConstraint (0, influence 2 cm), SNOPT, "
        "guesses collision-free; restarted",
        packages=("drake",),
    ),
    Entry(
        name="mink, collision limit",
        adapter="mink_:Limited",
        use="solve_ik(FrameTask, ConfigurationLimit, CollisionAvoidanceLimit over the detector's pairs, daqp), dt 1, "
        "from collision-free seeds; restarted",
        packages=("mink", "mujoco", "daqp"),
    ),
    Entry(
        name="Pink, self-collision barrier",
        adapter="pink_:Barrier",
        use="solve_ik(FrameTask, ConfigurationLimit, SelfCollisionBarrier of the 10 closest sphere pairs without its "
        "pull to rest, daqp), dt 1, from collision-free seeds; restarted",
        packages=("pin-pink", "pin", "daqp"),
    ),
    Entry(
        name="PyRoki, CPU",
        adapter="pyroki_:Example",
        use="its solve_ik example (pose cost 50 / 10, limit cost, float32) from collision-free seeds, JAX on the CPU; "
        "restarted",
        packages=("pyroki", "jaxls", "jax"),
    ),
    Entry(
        name="ikpy",
        adapter="ikpy_:Bounded",
        use="Chain.inverse_kinematics_frame(T, initial_position=random, orientation_mode='all'), least_squares; "
        "restarted",
        packages=("ikpy",),
    ),
    Entry(
        name="SciPy differential_evolution",
        adapter="evolution:Scipy",
        use="best1bin, popsize 15, tol 1e-8, polish, vectorized, depth of penetration as penalty, stopped once within "
        "the tolerances; restarted",
        packages=("scipy",),
    ),
    Entry(
        name="pymoo DE",
        adapter="evolution:Pymoo",
        use="DE(pop_size=50, 'DE/rand/1/bin', F=0.5, CR=0.9), depth of penetration as constraint, stopped once within "
        "the tolerances; restarted",
        packages=("pymoo",),
    ),
    Entry(
        name="pygmo DE",
        adapter="evolution:Pygmo",
        use="de(rand/1/bin, F=0.5, CR=0.9, population 50), depth as penalty, looked at every 50 generations; restarted",
        packages=("pygmo",),
    ),
)


def _in_world(name: str, adapter: str, use: str, packages: tuple[str, ...], **options: Any) -> Entry:
    return Entry(name=name, adapter=adapter, use=use, packages=packages, options=options)


_COAL = "checked by Pinocchio's computeCollisions with the broad phase BroadPhaseManager_DynamicAABBTree..., "
IN_SCENES = (
    _in_world(
        "ikde", "ikde:Single", "ikde.solve(robot, target, settings, collision=model)", ("ikde", "numpy", "numba")
    ),
    _in_world(
        "EAIK, checked by coal",
        "eaik_:AmongSolids",
        "HPRobot(H, P).IK, branch by branch " + _COAL + "; of seven joints one is held at a random value (fixed_axes), "
        "a lift stands at random heights",
        ("EAIK", "pin", "coal"),
        check="coal",
    ),
    _in_world(
        "EAIK, checked by ikde's kernels",
        "eaik_:AmongSolids",
        "the same, checked by ikde's kernels on tables, one call from Python a branch",
        ("EAIK", "ikde"),
        check="world kernels",
    ),
    _in_world(
        "Robotics Toolbox ik_LM",
        "rtb:Toolbox",
        "ets.ik_LM(T) with its defaults (Chan, k = 1, 30 x 100 iterations), tol for the tolerances, "
        + _COAL
        + "restarted",
        ("roboticstoolbox-python", "pin", "coal"),
    ),
    _in_world(
        "Robotics Toolbox ik_LM, tuned",
        "rtb:Toolbox",
        "ets.ik_LM(T, q0=random, method='chan', k=0.1, ilimit=10, slimit=1), " + _COAL + "restarted",
        ("roboticstoolbox-python", "pin", "coal"),
        seeds="random",
        k=0.1,
        ilimit=10,
        slimit=1,
    ),
    _in_world(
        "TRAC-IK",
        "tracik:Speed",
        "TracIK(...).ik(position, rotation, random seed), Speed, timeout 5 ms, epsilon from tolerance, "
        + _COAL
        + "restarted",
        ("pytracik", "pin", "coal"),
    ),
    _in_world(
        "Pinocchio, LM loop in Python",
        "pinocchio:InPython",
        "computeJointJacobians and log6 in a damped loop, clipped to the limits, from collision-free seeds, "
        + _COAL
        + "restarted",
        ("pin", "coal"),
    ),
    _in_world(
        "RoboPlan SimpleIk",
        "roboplan_:Simple",
        "SimpleIk.solveIk(goal, home, solution) with its defaults and our tolerances, solids in its Scene; asked again "
        "from a collision-free start while it fails",
        ("roboplan", "pin", "coal"),
    ),
    _in_world(
        "RoboPlan SimpleIk, one call",
        "roboplan_:Simple",
        "the same with restarts and time without end, step_size=1, max_iters=40",
        ("roboplan", "pin", "coal"),
        step_size=1.0,
        max_iters=40,
        max_restarts=1_000_000,
        max_time=2.0,
    ),
    _in_world(
        "Drake InverseKinematics",
        "drake:Program",
        "position and orientation constraints, AddMinimumDistanceLowerBoundConstraint (0, influence 2 cm) of robot and "
        "solids, SNOPT, guesses collision-free; restarted",
        ("drake", "pin", "coal"),
    ),
    _in_world(
        "mink, collision limit",
        "mink_:Limited",
        "solve_ik(FrameTask, ConfigurationLimit, CollisionAvoidanceLimit over the pairs and solids, daqp), dt 1, from "
        "collision-free seeds; restarted",
        ("mink", "mujoco", "daqp"),
    ),
    _in_world(
        "Pink, collision barrier",
        "pink_:Barrier",
        "solve_ik(FrameTask, ConfigurationLimit, SelfCollisionBarrier of the 10 closest pairs of spheres and solids "
        "without its pull to rest, daqp), dt 1, from collision-free seeds; restarted",
        ("pin-pink", "pin", "daqp"),
    ),
)
"""Those of benchmarks/scene_peers.py."""
EVERY = (*ROSTER, *IN_SCENES)
