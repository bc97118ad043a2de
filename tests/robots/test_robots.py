"""The robots that ship: they load, home is free, numbers have sources, and tables of the makers agree."""

import numpy as np
import pytest

import ikde
from ikde.io.robots import robot_path
from ikde.io.yaml_file import read_yaml
from ikde.model.robot import Wheels
from tests.conftest import BY_HAND, random_q

TOUCHES_AT_HOME = {("qiao2021", "single")}  # one sphere a component: the platform's reaches into link 1's
DETECTORS = [(name, detector) for name in BY_HAND for detector in ikde.load_robot(name).detectors]
NAMED_ENTRIES = ("conventions", "pairs", "detectors")
WITH_SPHERES = sorted({name for name, _ in DETECTORS})
FOLDED_DEG = {
    "qiao2021": (0, 0, 0, 90, 0, 150, 90, 0, 0),  # wrist back at the upper arm
    "ur5": (0, -90, 170, 0, 0, 0),  # the same
    "ur5e_mecanum": (0, 0, 0, 180, -90, 170, 0, 0, 0),
    "panda": (0, 101, 0, -176, 0, 115, 0),  # leaning forward, wrist back at the base
}

# Rows of DH tables: d in m, a in m, alpha in rad, theta offset in rad.
UR5_DH = [  # classical: Universal Robots, "DH parameters for calculations of kinematics and dynamics"
    (0.089159, 0.0, np.pi / 2, 0.0),
    (0.0, -0.425, 0.0, 0.0),
    (0.0, -0.39225, 0.0, 0.0),
    (0.10915, 0.0, np.pi / 2, 0.0),
    (0.09465, 0.0, -np.pi / 2, 0.0),
    (0.0823, 0.0, 0.0, 0.0),
]
UR5E_DH = [  # classical: the same page; [Zhang2022, Table 2] prints d4 = 0.133, and the fifth alpha without its minus
    (0.1625, 0.0, np.pi / 2, 0.0),
    (0.0, -0.425, 0.0, 0.0),
    (0.0, -0.3922, 0.0, 0.0),
    (0.1333, 0.0, np.pi / 2, 0.0),
    (0.0997, 0.0, -np.pi / 2, 0.0),
    (0.0996, 0.0, 0.0, 0.0),
]
PANDA_MODIFIED_DH = [  # Franka Control Interface documentation, "Robot and interface specifications"
    (0.333, 0.0, 0.0, 0.0),
    (0.0, 0.0, -np.pi / 2, 0.0),
    (0.316, 0.0, np.pi / 2, 0.0),
    (0.0, 0.0825, np.pi / 2, 0.0),
    (0.384, -0.0825, -np.pi / 2, 0.0),
    (0.0, 0.0, np.pi / 2, 0.0),
    (0.0, 0.088, np.pi / 2, 0.0),
]
PANDA_FLANGE_M = 0.107
QIAO_CLASSICAL_DH = [  # [Qiao2021, Table 1(a)] with d4 = 89.15 mm and J5's offset pi
    (0.0892, 0.0, np.pi / 2, 0.0),
    (0.0, -0.425, 0.0, -np.pi / 2),
    (0.0, -0.39225, 0.0, 0.0),
    (0.08915, 0.0, np.pi / 2, -np.pi / 2),
    (0.09465, 0.0, -np.pi / 2, np.pi),
    (0.0823, 0.0, 0.0, 0.0),
]
SHARED_FRAMES = {
    **{name: name for name in ("track_x", "track_y", "Od", "Ob", "tool")},
    **{"1": "O1", "2": "Oc23", "3": "O3", "4": "O4", "5": "O5", "6": "O6"},
}


def turn_z(angle):
    s, c = np.sin(angle), np.cos(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def turn_x(angle):
    s, c = np.sin(angle), np.cos(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def shift(x=0.0, y=0.0, z=0.0):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def classical_dh(table, q):
    """T of the last frame in the base, and of every frame before it: Rz(q + offset) Tz(d) Tx(a) Rx(alpha)."""
    Ts = [np.eye(4)]
    for (d, a, alpha, offset), angle in zip(table, q, strict=True):
        Ts.append(Ts[-1] @ turn_z(angle + offset) @ shift(z=d) @ shift(x=a) @ turn_x(alpha))
    return Ts[1:]


def modified_dh(table, q):
    """T of every frame in the base: Rx(alpha) Tx(a) Rz(q + offset) Tz(d)."""
    Ts = [np.eye(4)]
    for (d, a, alpha, offset), angle in zip(table, q, strict=True):
        Ts.append(Ts[-1] @ turn_x(alpha) @ shift(x=a) @ turn_z(angle + offset) @ shift(z=d))
    return Ts[1:]


def to_classical(q):
    """The same configuration of qiao2021 in the classical convention: q5 larger by pi."""
    shifted = q.copy()
    shifted[..., 7] += np.pi
    return shifted


def has_numbers(frame):
    """True if a frame of a file writes a number that is not 0."""
    return any(value != 0 for key in ("xyz", "rpy", "axis") for value in frame.get(key, ()))


def number_entries(data):
    """Path of every entry of a robot file that holds numbers or says which pairs count."""
    found = [("frames", name) for name, frame in data["frames"].items() if has_numbers(frame)]
    found += [("spheres", name, i) for name, rows in data.get("spheres", {}).items() for i in range(len(rows))]
    found += [(section, name) for section in NAMED_ENTRIES for name in data.get(section, {})]
    return found + [(section,) for section in ("adjacent", "wheels") if section in data]


def joint_numbers(data):
    """Path of every limit and home that a robot file writes."""
    keys = ("lower", "upper", "home")
    return [("joints", name, key) for name, joint in data["joints"].items() for key in keys if key in joint]


@pytest.mark.parametrize("name", BY_HAND)
def test_a_shipped_robot_bears_the_name_of_its_file(name):
    assert ikde.load_robot(name).name == name


def test_only_the_papers_robot_has_wheels(any_robot):
    told = any_robot.wheels and (any_robot.wheels.radius_m, any_robot.wheels.half_track_m)
    assert told == ((0.1, 0.259) if any_robot.name.startswith("qiao2021") else None)


def test_the_ur5e_on_its_platform_is_the_makers_table(rng):
    robot = ikde.load_robot("ur5e_mecanum")
    assert robot.wheels == Wheels(radius_m=0.0825, half_track_m=0.24, half_wheelbase_m=0.36)
    for q in random_q(robot, rng, 20):
        T_world_platform = shift(x=q[0], y=q[1]) @ turn_z(q[2])  # [Zhang2022, eq. 3] with the minus in its first row
        T = T_world_platform @ shift(x=0.3, z=0.35) @ classical_dh(UR5E_DH, q[3:])[-1]
        np.testing.assert_allclose(ikde.forward(robot, q)["tool"], T, rtol=0, atol=1e-14)


def test_home_lies_inside_the_limits(any_robot):
    assert np.all(any_robot.lower <= any_robot.home)
    assert np.all(any_robot.home <= any_robot.upper)


def test_limits_leave_every_joint_room_to_move(any_robot):
    assert np.all(any_robot.lower < any_robot.upper)


@pytest.mark.parametrize(("name", "detector"), [d for d in DETECTORS if d not in TOUCHES_AT_HOME])
def test_home_is_free_with_room_to_spare(name, detector):
    robot = ikde.load_robot(name)
    result = ikde.check(robot, robot.home, detector)
    assert not result.collision
    assert result.clearance_m > result.safe_distance_m


@pytest.mark.parametrize(("name", "detector"), sorted(TOUCHES_AT_HOME))
def test_one_sphere_a_component_sees_contact_even_at_home(name, detector):
    robot = ikde.load_robot(name)
    assert ikde.check(robot, robot.home, detector).collision


@pytest.mark.parametrize("name", WITH_SPHERES)
def test_a_folded_pose_collides(name):
    robot = ikde.load_robot(name)
    result = ikde.check(robot, np.deg2rad(FOLDED_DEG[name]))
    assert result.collision
    assert result.outside_limits == ()


@pytest.mark.parametrize("name", WITH_SPHERES)
def test_every_pair_is_free_in_some_pose_with_the_default_detector(name, rng):
    robot = ikde.load_robot(name)
    best = {}
    for q in [robot.home, *random_q(robot, rng, 50)]:
        for pair in ikde.check(robot, q).pairs:
            best[pair.a, pair.b] = max(best.get((pair.a, pair.b), -np.inf), pair.clearance_m)
    assert min(best.values()) > 0.0


@pytest.mark.parametrize("name", BY_HAND)
def test_every_entry_with_numbers_names_its_source(name):
    provenance = ikde.load_robot(name).provenance
    entries = number_entries(read_yaml(robot_path(name)).data)
    named = set(provenance) | {path[:-1] for path in provenance}  # as a whole, or key by key
    assert [entry for entry in entries if entry not in named] == []


@pytest.mark.parametrize("name", BY_HAND)
def test_every_limit_and_home_names_its_source(name):
    provenance = ikde.load_robot(name).provenance
    numbers = joint_numbers(read_yaml(robot_path(name)).data)
    assert [path for path in numbers if path not in provenance and path[:2] not in provenance] == []


@pytest.mark.parametrize(("dh_frame", "key_point"), SHARED_FRAMES.items())
def test_classical_and_key_point_frames_of_qiao2021_coincide(qiao, rng, dh_frame, key_point):
    q = random_q(qiao, rng, 200)
    T_key_point = ikde.forward(qiao, q)[key_point]
    T_classical = ikde.forward(ikde.load_robot("qiao2021_dh"), to_classical(q))[dh_frame]
    np.testing.assert_allclose(T_classical[:, :3, 3], T_key_point[:, :3, 3], rtol=0, atol=1e-10)


def test_classical_and_key_point_tools_of_qiao2021_point_and_turn_alike(qiao, rng):
    q = random_q(qiao, rng, 200)
    T_key_point = ikde.forward(qiao, q)["tool"]
    T_classical = ikde.forward(ikde.load_robot("qiao2021_dh"), to_classical(q))["tool"]
    np.testing.assert_allclose(T_classical[:, :3, :3], T_key_point[:, :3, :3], rtol=0, atol=1e-12)


def test_classical_and_key_point_limits_and_homes_of_qiao2021_are_the_same_set(qiao):
    classical = ikde.load_robot("qiao2021_dh")
    assert classical.joint_names == qiao.joint_names
    for key in ("lower", "upper", "home"):
        np.testing.assert_allclose(getattr(classical, key), to_classical(getattr(qiao, key)), rtol=0, atol=1e-14)


def test_qiao2021_dh_is_the_product_of_its_table(rng):
    robot = ikde.load_robot("qiao2021_dh")
    for q in random_q(robot, rng, 20):
        Ts_world = ikde.forward(robot, q)
        for k, T_base_frame in enumerate(classical_dh(QIAO_CLASSICAL_DH, q[3:]), start=1):
            np.testing.assert_allclose(Ts_world[str(k)], Ts_world["Ob"] @ T_base_frame, rtol=0, atol=1e-12)


def test_ur5_tool_is_the_product_of_its_published_dh_table(rng):
    robot = ikde.load_robot("ur5")
    for q in random_q(robot, rng, 100):
        expected = classical_dh(UR5_DH, q)[-1]
        np.testing.assert_allclose(ikde.forward(robot, q)["tool"], expected, rtol=0, atol=1e-12)


def test_ur5_offsets_along_the_shoulder_axis_add_up_to_d4():
    robot = ikde.load_robot("ur5")
    offsets = {frame.name: frame.p_parent_frame[1] for frame in robot.frames}
    total = offsets["upper_arm"] + offsets["forearm"] + offsets["wrist_2"]
    assert total == pytest.approx(UR5_DH[3][0], abs=1e-15)


def test_panda_frames_are_the_products_of_its_published_modified_dh_table(rng):
    robot = ikde.load_robot("panda")
    for q in random_q(robot, rng, 100):
        Ts_world = ikde.forward(robot, q)
        Ts_expected = modified_dh(PANDA_MODIFIED_DH, q)
        for k, T in enumerate(Ts_expected, start=1):
            np.testing.assert_allclose(Ts_world[f"link{k}"], T, rtol=0, atol=1e-12)
        T_flange = Ts_expected[-1] @ shift(z=PANDA_FLANGE_M)
        np.testing.assert_allclose(Ts_world["flange"], T_flange, rtol=0, atol=1e-12)


def test_panda_limits_are_the_published_ones():
    robot = ikde.load_robot("panda")
    lower = [-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973]
    upper = [2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973]
    assert np.array_equal(robot.lower, lower)
    assert np.array_equal(robot.upper, upper)


def test_panda_home_is_the_ready_pose():
    home = ikde.load_robot("panda").home
    np.testing.assert_array_equal(home, np.array([0, -1, 0, -3, 0, 2, 1]) * np.pi / 4)
