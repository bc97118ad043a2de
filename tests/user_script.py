"""A script as users write it, with every public call: checked by pyright (`include` in pyproject), not run.

A comment that silences an error which is none is an error as well: what must be refused is refused.
"""

# pyright: reportUnnecessaryTypeIgnoreComment=true

from pathlib import Path

import numpy as np

import ikde

robot = ikde.load_robot("ur5")
T_world_tool = ikde.forward(robot, robot.home)["tool"]
q: np.ndarray = ikde.forward("ur5", [0.0] * 6)["tool"]

J: np.ndarray = ikde.jacobian("qiao2021", np.zeros((5, 9)), frame="O3", axes="frame", by="actuators")
analysis: ikde.Analysis = ikde.analyze("qiao2021", np.zeros(9), by="actuators", length_m=0.3)
print(analysis.scaled["arm"]["translation"].manipulability, analysis.additions[0].pose, analysis.limit_margin)
ikde.jacobian(robot, robot.home, by="wheels")  # type: ignore[arg-type]

targets = [
    ikde.Target((0.4, 0.2, 0.3)),
    ikde.Target.from_matrix(T_world_tool),
    ikde.Target.from_quat_wxyz((0.4, 0.2, 0.3), (1, 0, 0, 0)),
    ikde.Target.from_quat_xyzw((0.4, 0.2, 0.3), (0, 0, 0, 1)),
    ikde.Target.from_rpy((0.4, 0.2, 0.3), (0, 0, np.pi)),
]

result: ikde.SolveResult = ikde.solve(robot, targets[0])
box = ikde.Region.box(targets[1], position_m=(0.01, 0.01, 0.0), rotation_rad=[(0, 0), (0, 0), (-1.0, 1.0)])
look = ikde.Region.look_at((0.5, 0.0, 0.1), (0.3, 0.6), axis_world_tool=(0, 0, -1), angle_rad=0.5)
goals = ikde.Region.any_of([box, ikde.Region.turn(targets[2]), ikde.Region.cone(targets[3], 0.2), look], "best")
result = ikde.solve(robot, goals, collision="none")
print(result.region, result.alternative, result.poses, result.target.p_world_tool, result.room_m)
print(ikde.solve_many(robot, [box, targets[0], T_world_tool]).alternatives, ikde.solve_many(robot, box).reached)
print(ikde.solve_distinct(robot, box, 3)[0].q, ikde.verify(robot, box, result.q).accepted)
loaded: ikde.Target | ikde.Region = ikde.load_goal("goal.yaml")
room = ikde.BaseRegion([(0, 0), (2, 0), (2, 2), (0, 2)], holes=[[(1, 1), (1.2, 1), (1, 1.2)]])
result = ikde.solve("qiao2021", box.with_base(room))
rows = ikde.solve_many("qiao2021", [box, ikde.Region.of(targets[0]).with_base([(0, 0), (2, 0), (2, 2)])])
ikde.Region.any_of(targets, "worst")  # type: ignore[arg-type]
result = ikde.solve("ur5", (0.4, 0.2, 0.3), {"timeout_s": 1.0}, method="lm")
result = ikde.solve(Path("my.yaml"), T_world_tool, near=result.q, freeze=["q1"], weights={"q2": 1.0})
result = ikde.solve(robot, [0.4, 0.2, 0.3], ikde.SolveSettings(method="de", de=ikde.DeSettings(strategy="best/1")))
moved = ikde.solve("panda", T_world_tool, prefer="manipulability")
print(moved.preferred.after if moved.preferred else None, ikde.solve_distinct(robot, box, 3, rank="manipulability"))
ikde.solve(robot, targets[0], prefer="foo")  # type: ignore[arg-type]
ikde.solve(robot, targets[0], method="foo")  # type: ignore[arg-type]
ikde.solve_many(robot, targets, method="foo")  # type: ignore[arg-type]
ikde.solve_distinct(robot, targets[0], 3, rank="foo")  # type: ignore[arg-type]
ikde.SolveSettings(method="foo")  # type: ignore[arg-type]
ikde.DeSettings(strategy="foo")  # type: ignore[arg-type]
ikde.BulkOptions(verify="foo")  # type: ignore[arg-type]
print(result.reached, result.q.round(3), result.stop_reason is ikde.StopReason.REACHED)

rows = ikde.solve_many(robot, np.zeros((3, 3)), bulk=ikde.BulkOptions(threads=1))
rows = ikde.solve_many(robot, [targets[0], T_world_tool, (0.4, 0.2, 0.3)])
rows = ikde.solve_many(robot, ikde.Targets(np.zeros((3, 3))))
rows = ikde.solve_many(robot, targets[0])
print(rows.q.mean(), rows.reached.sum(), rows[0].clearance_m)
for solution in ikde.solve_distinct("ur5", (0.4, 0.2, 0.3), 3, rank="clearance"):
    print(solution.q, solution.family)

detector = ikde.Detector(name="wide", spheres="default", pairs="non_adjacent", safe_distance_m=0.02)
checked: ikde.CheckResult = ikde.check(robot, robot.home, detector)
rows_checked: ikde.CheckResults = ikde.check(robot, [robot.home] * 2)
by_name: ikde.CheckResult = ikde.check(robot, dict(zip(robot.joint_names, robot.home.tolist(), strict=True)))
many_checked: ikde.CheckResults = ikde.check_many(robot, [robot.home] * 2)
grade: ikde.Grade = ikde.verify(robot, (0.4, 0.2, 0.3), result.q, settings={"position_tolerance_m": 1e-3})
branch: str | None = ikde.family("ur5", robot.home)
pairs = ikde.CollisionModel.of(robot, detector).left_out_pairs
own = ikde.from_convention(robot, ikde.to_convention(robot, robot.home, None), None)
print({robot: "found"}[robot], robot == ikde.load_robot("ur5"), ikde.robot_names(), checked.pairs, grade.accepted)

texts = [ikde.format_urdf(robot), ikde.format_mjcf(robot, collision="none")]
imported: ikde.Robot = ikde.import_urdf("my.urdf")
details: ikde.ImportedUrdf = ikde.read_urdf("my.urdf")
options = ikde.ImportOptions()
composed = ikde.compose("qiao2021", imported, np.eye(4))

world: ikde.World = ikde.load_world("kitchen.yaml")
notes = ikde.read_world("kitchen.yaml").notes
among = ikde.CollisionModel.of("ur5").in_world(world.remove("lamp"), 0.005, {"wrist_3": 0.0})
result = ikde.solve("ur5", (0.4, 0.2, 0.3), collision=among)
held: ikde.World = world.attach("can", "tool", robot="ur5", q=np.zeros(6), may_touch=["top"])
seen, removed = ikde.clear_cloud(held, "ur5", np.zeros(6), padding_m=0.02)
print(seen.names, removed + 1)
print(held.attached[0].protrusion_m, held.detach("can", robot="ur5", q=np.ones(6)).names, held.detach("can").digest)
files: tuple[Path, ...] = ikde.write_world(world, "copy.yaml", ["a note"])

batch = ikde.load_batch("batch.yaml")
ikde.run_batch(batch, "run")
table = ikde.read_batch("run")
track = ikde.load_track("track.yaml")
motion: ikde.Trajectory = ikde.run_track(track)
tasks = [
    ikde.VelocityTask.tool((0.4, 0.2, 0.3), gain=2.0, max_speed=0.2),
    ikde.VelocityTask.tool(twist=[0, 0, 0.1], frame="forearm", share=0.5),
    ikde.VelocityTask.base((1.0, 0.0, 0.3), velocity=(0.1, 0.0, 0.0)),
    ikde.VelocityTask.joints({"elbow_joint": 1.0}, rates={"wrist_3_joint": 0.1}),
]
limits = ikde.MotionLimits.of(ikde.load_robot("ur5e_mecanum"), wheel_speed_rad_s=10.0)
speeds: ikde.VelocityResult = ikde.velocity("ur5e_mecanum", np.zeros(9), tasks, dt_s=0.02, limits=limits)
speeds = ikde.velocity("ur5e_mecanum", np.zeros(9), tasks[0], before=speeds.q_dot, weights={"x": 2.0}, softest=0.1)
wheels: np.ndarray | None = speeds.wheels
print(
    speeds.q_dot, speeds.twist, speeds.at_limit, speeds.broken, [task.held_by for task in speeds.tasks if not task.met]
)
ikde.VelocityTask.tool((0.4, 0.2, 0.3), gian=2.0)  # type: ignore[call-arg]
ikde.write_trajectory("motion", motion)
path = ikde.ToolPath(p_world_tool=np.zeros((5, 3)), dt_s=0.1)
ikde.follow_path(robot, path, limits=ikde.MotionLimits.of(robot), settings=ikde.ContinuationSettings())
among_obstacles = ikde.follow_path("ur5", path, collision=world)
passing: ikde.ObjectMotion = ikde.ObjectMotion([0.0, 0.4], [np.eye(4), [1.0, 0.0, 0.0]])
ikde.follow_path("ur5", path, collision=world, moving={"can": passing})
hint: str | None = among_obstacles.stop.hint if among_obstacles.stop else None
room_m: float | None = float(among_obstacles.certificate.room_m.min()) if among_obstacles.certificate else None
ikde.follow_path(robot, path, method="foo")  # type: ignore[arg-type]
ikde.follow_path(robot, path, method="optimized", settings=ikde.OptimizedSettings())
ikde.follow_path("ur5", path, method="typical", settings=ikde.TypicalSettings())
servo = ikde.Servo("ur5", robot.home, limits=ikde.MotionLimits.of(robot), world=world)
taken: ikde.ServoStep = servo.step([0.4, 0.2, 0.3], 0.01)
taken = servo.step(ikde.Target((0.4, 0.2, 0.3)), dt_s=0.01)
held_by: str = taken.held_by.text if taken.held_by else f"{taken.error_m} {taken.clearance_m} {taken.q_stop}"
servo.world = world.move("lamp", np.eye(4))
servo = ikde.Servo.from_state(robot, servo.state, world=world)
stop: ikde.TrackStop | None = motion.stop
ends = stop is not None and stop.reason is ikde.TrackStopReason.SPEED_LIMIT
surface = ikde.check_surface(robot, robot.home)
with ikde.compile_clock() as clock:
    ikde.solve(robot, targets[0])
print(clock.seconds)
try:
    ikde.solve(robot, "here")
except ikde.FileError as error:
    print(error.where)
except (ikde.InputError, ikde.VerificationError, ikde.IkdeError) as error:
    print(error)
