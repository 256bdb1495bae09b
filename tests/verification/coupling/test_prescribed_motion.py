"""Where a prescribed body is at any time, in closed form; the half-spaces on the device, and what is written, agree.

Between keyframes at t0 and t1 the origin is at x0 + s (x1 - x0) and the body is turned by s times the angle about one
axis, s = (t - t0) / (t1 - t0); so points move at (x1 - x0) / (t1 - t0) + omega x arm, and central differences of
positions agree with that to the second order of their step.
"""

from __future__ import annotations

import json
import math
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.bodies.obstacles import find_obstacles
from sim.bodies.prescribed import Prescribed
from sim.rigid.spec import RigidBody
from sim.spec import CFL, SimulationSpec
from tests.stress.scenes import finish, pool, segment_command
from tests.support.fluid.solvers import SOLVERS
from tests.support.particles import positions, read_frame, read_table

BOX = {"type": "box", "size": [0.2, 0.04, 0.1]}
TILTED = [{"axis": [1, 0, 0], "angle": 30}]
KEYFRAMES = [
    {"at": 0.5, "position": [0.1, 0.2, 0.3]},
    {"at": 1.0, "position": [0.4, 0.2, -0.1], "rotation": [*TILTED, {"axis": [0, 1, 0], "angle": 120}]},
    {"at": 1.5, "position": [0.4, 0.6, -0.1], "rotation": [*TILTED, {"axis": [0, 1, 0], "angle": 240}]},
]
KEYED = {"shape": BOX, "motion": "prescribed", "rotation": TILTED, "keyframes": KEYFRAMES}
SPUN = {
    "shape": BOX,
    "motion": "prescribed",
    "position": [1, 2, 3],
    "rotation": TILTED,
    "velocity": [0.5, -0.25, 1],
    "angular_velocity": [0, 0, 3],
    "start": 0.25,
}
ARMS = np.array([[0, 0, 0], [0.1, 0.02, 0.05], [-0.1, -0.02, 0.05], [0.03, 0.01, -0.02]])
"""Points of the body in its own frame [m]."""


def about(axis, degrees):
    return Rotation.from_rotvec(np.deg2rad(degrees) * np.array(axis, float)).as_matrix()


TILT = about([1, 0, 0], 30)


def keyed(time):
    """Origin and rotation of KEYED, from its three keyframes by hand."""
    places = np.array([key["position"] for key in KEYFRAMES], float)
    s = min(max((time - 0.5) / 0.5, 0.0), 2.0)
    piece = min(int(s), 1)
    place = places[piece] + (s - piece) * (places[piece + 1] - places[piece])
    return place, about([0, 1, 0], 120 * s) @ TILT


def spun(time):
    passed = max(time - 0.25, 0.0)
    return np.array([1, 2, 3]) + passed * np.array([0.5, -0.25, 1]), about([0, 0, 1], np.rad2deg(3 * passed)) @ TILT


CASES = {"keyed": (KEYED, keyed), "spun": (SPUN, spun)}
TIMES = (0.0, 0.25, 0.4, 0.5, 0.6, 0.75, 1.0, 1.3, 1.5, 7.0)


def placed(case):
    """The motion, and the points of the body as it is placed at the start."""
    body, truth = CASES[case]
    place, turn = truth(0.0)
    return Prescribed(RigidBody.model_validate(body)), truth, ARMS @ turn.T + place


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("time", TIMES)
def test_points_are_where_the_closed_form_says(case, time):
    motion, truth, points = placed(case)
    place, turn = truth(time)
    now = motion.at(time)
    np.testing.assert_allclose(now.carry(points), ARMS @ turn.T + place, atol=1e-14)
    np.testing.assert_allclose(now.carry_back(now.carry(points)), points, atol=1e-14)
    w, x, y, z = now.quaternion()
    np.testing.assert_allclose(Rotation.from_quat([x, y, z, w]).as_matrix() @ truth(0.0)[1], turn, atol=1e-14)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("time", [0.1, 0.4, 0.6, 0.83, 1.3, 1.7])
def test_the_velocity_is_the_derivative(case, time):
    """(x(t + e) - x(t - e)) / 2e is off by e^2 |x'''| / 6, omega^3 times the arm, and by rounding over e."""
    motion, _, points = placed(case)
    e = 1e-5
    slope = (motion.at(time + e).carry(points) - motion.at(time - e).carry(points)) / (2 * e)
    now = motion.at(time)
    omega, arm = 2 * math.pi / 1.5, 0.12
    np.testing.assert_allclose(now.velocity_at(now.carry(points)), slope, atol=e * e * omega**3 * arm + 4e-16 * 3 / e)


def test_keyframes_are_the_times_at_which_velocities_jump():
    motion = Prescribed(RigidBody.model_validate(KEYED))
    assert [motion.next_keyframe(t) for t in (0, 0.5, 0.7, 1.0, 1.5)] == [0.5, 1.0, 1.0, 1.5, math.inf]
    assert Prescribed(RigidBody.model_validate(SPUN)).next_keyframe(0.0) == 0.25
    np.testing.assert_array_equal(motion.at(0.5 - 1e-9).velocity, 0)
    np.testing.assert_allclose(motion.at(0.5).velocity, [0.6, 0, -0.8])
    np.testing.assert_array_equal(motion.at(1.5).velocity, 0)


@pytest.mark.parametrize("case", CASES)
def test_the_sweep_holds_all_places(case, tmp_path):
    """Of a motion with an end; of one without, all that it turns through at its start."""
    spec = SimulationSpec.model_validate({"rigid": {"bodies": {"body": CASES[case][0]}}})
    (item,) = find_obstacles(spec, tmp_path).placed
    low, high = item.bounds
    travel = 0 if case == "keyed" else 1
    for time in np.linspace(0, 2, 101):
        now = item.movement(time)
        corners = now.carry(item.solid.mesh.vertices) - travel * (now.position - item.motion.pivot)
        assert (corners > low - 1e-12).all()
        assert (corners < high + 1e-12).all()
        assert np.linalg.norm(now.velocity_at(now.carry(item.solid.mesh.vertices)), axis=1).max() <= item.fastest


@pytest.mark.parametrize("case", CASES)
@pytest.mark.usefixtures("taichi")
def test_half_spaces_follow_on_the_device(case, tmp_path):
    """Off the middle of each face of the box, at s along the normal n that moves with it, its half-space is that of n
    and s, and moves as the body would there; a ball that stands does not. In single precision, relative to an origin
    near by."""
    from sim.coupling.fluid_solids import boundary_solids, motions
    from sim.device.arrays import numpy_real, vec4
    from sim.device.compiler import ti
    from sim.fluid.boundary.faces import Faces
    from sim.fluid.boundary.shapes import Shapes
    from tests.support.fluid.surface_speeds import surface_speeds

    spacing, h, s = 0.02, 0.04, 0.008
    ball = {"shape": {"type": "sphere", "radius": 0.05}, "position": [0, 0.5, 0]}
    spec = SimulationSpec.model_validate({"rigid": {"bodies": {"ball": ball, "body": CASES[case][0]}}})
    obstacles = find_obstacles(spec, tmp_path)
    truth, origin = CASES[case][1], np.array([0.5, 1.0, 1.0])
    shapes = Shapes(boundary_solids(obstacles, spacing, h), origin, spacing, h)
    faces = Faces(shapes, spacing, h, h)
    ways = np.vstack((np.eye(3), -np.eye(3)))
    inner = ways * (0.5 * np.array(BOX["size"]) + s) + 0.1 * ways[:, [1, 2, 0]] * np.array(BOX["size"])[[1, 2, 0]]
    off_ball = np.array([[0, 0.5 + 0.05 + s, 0]])
    x, v = ti.ndarray(vec4, 7), ti.ndarray(vec4, 7)
    v.fill(0)
    for time in TIMES[:-1]:
        shapes.move(motions(obstacles, origin, time))
        now = obstacles.placed[1].movement(time)
        place, turn = truth(time)
        points, normals = inner @ turn.T + place, ways @ turn.T
        here = np.concatenate((points, off_ball)) - origin
        x.from_numpy(np.column_stack((here, np.zeros(7))).astype(numpy_real))
        faces.find(x, 7)
        faces.place(faces.points(x, v), 7, 0.0)
        np.testing.assert_array_equal(faces.size.to_numpy()[:7], 1)
        entry = faces.begin.to_numpy()[:7]
        np.testing.assert_array_equal(faces.solid.to_numpy()[entry], [1] * 6 + [0])
        found = faces.face.to_numpy()[entry]
        np.testing.assert_allclose(found[:6, :3], normals, atol=4 * 1.2e-7)
        np.testing.assert_allclose(found[:6, 3], s, atol=8 * 1.2e-7)
        np.testing.assert_allclose(found[6, :3], [0, 1, 0], atol=1e-5)
        speed = now.velocity_at(points)
        surface_speeds(7, x, faces.solid, faces.begin, shapes.pose, v)
        found = v.to_numpy()[:7, :3]
        v.fill(0)
        np.testing.assert_allclose(found[:6], speed, atol=2e-4 * max(np.abs(speed).max(), 1e-3))
        assert not found[6].any()
        corners = now.carry(obstacles.placed[1].solid.mesh.vertices)
        assert shapes.speed >= np.linalg.norm(now.velocity_at(corners), axis=1).max() * (1 - 1e-6)


def test_frames_tell_where_a_body_is(simulate):
    """bodies.csv: centre of mass, rotation, and both velocities, at the times of the frames; without any fluid."""
    out = simulate({"fps": 10, "rigid": {"bodies": {"keyed": KEYED, "spun": SPUN}}}, 20)
    rows = read_table(out / "bodies.csv")
    assert not list(out.glob("fluid_*"))
    for name, (_, truth) in CASES.items():
        for row in rows[rows["body"] == name]:
            time = row["frame"] / 10
            place, turn = truth(time)
            np.testing.assert_allclose([row["x"], row["y"], row["z"]], place, atol=1e-9)
            found = Rotation.from_quat([row["qx"], row["qy"], row["qz"], row["qw"]]).as_matrix()
            np.testing.assert_allclose(found @ truth(0.0)[1], turn, atol=1e-9)
    last = rows[rows["body"] == "spun"][-1]
    assert [last[name] for name in ("vx", "vy", "vz", "wx", "wy", "wz")] == [0.5, -0.25, 1, 0, 0, 3]


@pytest.mark.parametrize("motion", [{}, {"motion": "prescribed", "velocity": [0, 1, 0]}], ids=["stands", "moves"])
def test_a_scene_in_which_nothing_moves_loads_nothing_for_it(tmp_path, motion):
    scene = pool(rigid__bodies={"ball": {"shape": {"type": "sphere", "radius": 0.05}, **motion}})
    code = (
        "import json, sys; from sim.segment import main; main(sys.argv[1:]);"
        "print(json.dumps(sorted(name for name in sys.modules if name.startswith('sim.'))))"
    )
    options = segment_command(scene, tmp_path / "out", "0:1")[3:]
    done = finish([sys.executable, "-c", code, *options], tmp_path)
    modules = set(json.loads(done.stdout.splitlines()[-1]))
    assert "sim.coupling.fluid_solids" in modules
    assert not modules & {
        "sim.fluid.boundary.one_sided_samples",
        "sim.coupling.fluid_rigid.lubrication",
        "sim.coupling.fluid_rigid.floating",
    }
    assert ({"sim.bodies.prescribed", "sim.bodies.movement"} <= modules) == bool(motion)
    assert bool(modules & {"sim.bodies.prescribed", "sim.bodies.movement"}) == bool(motion)


def test_steps_land_on_keyframes(simulate):
    keys = [{"at": at, "position": [0, 0.02, 0.1 * at]} for at in (0.0031, 0.0057, 0.0124)]
    paddle = {"shape": {"type": "box", "size": [0.1, 0.04, 0.1]}, "motion": "prescribed", "keyframes": keys}
    out = simulate(pool(rigid={"bodies": {"paddle": paddle}}), 2, threads=1)
    times = read_table(out / "steps.csv")["time"]
    assert {0.0031, 0.0057, 0.01, 0.0124, 0.02} <= set(times.tolist())


def test_a_body_that_an_event_adds_sets_off_from_where_it_is_placed(simulate):
    arrow = {"shape": BOX, "motion": "prescribed", "position": [0, 1, 0], "velocity": [2, 0, 0]}
    out = simulate({"fps": 10, "events": [{"at": 0.25, "add": {"rigid": {"arrow": arrow}}}]}, 5)
    rows = read_table(out / "bodies.csv")
    np.testing.assert_allclose(rows["x"], 2 * (rows["time"] - 0.25), atol=1e-12)
    np.testing.assert_array_equal(rows["frame"], [3, 4, 5])


def test_fluid_that_an_event_adds_keeps_off_a_body_where_it_is_then(simulate):
    """A plate that has risen from 0.02 m to 0.2 m: there is room where it was, and none where it is."""
    plate = {
        "shape": {"type": "box", "size": [0.3, 0.08, 0.3]},
        "position": [0, 0.04, 0],
        "motion": "prescribed",
        "velocity": [0, 4, 0],
    }
    column = {"shape": {"type": "box", "size": [0.12, 0.36, 0.12]}, "position": [0, 0.2, 0]}
    scene = pool(
        gravity=[0, 0, 0],
        fluid__bodies__water__position=[0, 0.3, 0],
        fluid__bodies__water__shape__size=[0.04, 0.04, 0.04],
        rigid__bodies={"plate": plate},
        events=[{"at": 0.0401, "add": {"fluid": {"column": column}}}, {"at": 0.0401, "remove": ["water"]}],
    )
    out = simulate(scene, 5, threads=1)
    heights = positions(read_frame(out, 5))[:, 1]
    middle = 0.04 + 4 * 0.05
    assert (heights < middle - 0.04).any()
    assert (heights > middle + 0.04).any()
    assert not ((heights > middle - 0.04) & (heights < middle + 0.04)).any()


@pytest.mark.parametrize("solver", SOLVERS)
def test_steps_follow_the_speed_of_a_body(simulate, solver):
    """The fastest point of it and the fluid together move by no more than cfl h / 2, while it moves."""
    speed, cfl, half = 20.0, max(CFL.get(solver, 0.4), 0.4), 0.04
    ball = {
        "shape": {"type": "sphere", "radius": 0.05},
        "position": [2, 0.2, 0],
        "motion": "prescribed",
        "velocity": [0, speed, 0],
        "start": 0.0105,
    }
    out = simulate(pool(fluid__solver=solver, rigid__bodies={"ball": ball}), 2, threads=1)
    table = read_table(out / "steps.csv")
    assert (table["dt"][table["time"] > 0.0106] <= cfl * half / speed).all()
    if solver != "wcsph":  # whose sound allows for the greatest speed from the start
        assert table["dt"][table["time"] < 0.0104].max() > cfl * half / speed
