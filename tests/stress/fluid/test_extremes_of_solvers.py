"""What no solver may answer with a file that is wrong: each ends right, refused (2) or stopped (3).

The extremes of one setting are in test_extremes.py; here are those whose answer depends on the solver.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from scene.settings import Refused
from sim.segment import simulate as run
from sim.spec import SimulationSpec
from tests.stress.scenes import assert_nothing_broken, pool
from tests.support.fluid.solvers import STRESSED, steps
from tests.support.particles import positions, read_frame, read_table, velocities

D = 0.04
WATER = pool()["fluid"]["bodies"]["water"]
pytestmark = pytest.mark.parametrize("solver", STRESSED)


def ends(spec, folder, out, last, **options):
    """The exit status of a run; 2 where it was refused. Nothing it leaves is broken, and 3 says why."""
    options = {"first": 0, "threads": 1, "arch": "cpu", "quiet": True} | options
    try:
        status = run(SimulationSpec.model_validate(spec), folder, out, last=last, **options)
    except Refused as refused:
        assert refused.remedy
        return 2
    assert_nothing_broken(out)
    if status == 3:
        assert json.loads((out / "failure.json").read_text())["change"]
    return status


def inside(out, frame):
    """Whether all particles of POOL's tank are in it."""
    return (np.abs(positions(read_frame(out, frame)) - [0, 0.2, 0]) < 0.2 + D / 2).all()


def changed(state, path, change):
    """Write a state with other positions [m], relative to its origin, to `path`."""
    with np.load(state) as stored:
        arrays = dict(stored)
    change(arrays["fluid.position"], arrays["origin"])
    np.savez(path, **arrays)


def run_from_changed_start(scene, folder, last, change):
    """The folder of a run whose start was changed by `change`, or None where it was refused or stopped."""
    state, out = folder / "state_00000.npz", folder / "run"
    assert ends(scene, folder, folder / "start", 0) == 0
    changed(folder / "start" / state.name, state, change)
    status = ends(scene, folder, out, last, first=1, state=state)
    assert status in (0, 2, 3)
    return out if status == 0 else None


def test_particles_in_one_place(tmp_path, solver):
    """Two particles at the same point: no direction parts them, and nothing divides by their distance."""
    scene = pool(fluid__solver=solver)

    def meet(x, _):
        x[1, :3] = x[0, :3]

    out = run_from_changed_start(scene, tmp_path, 4, meet)
    if out:
        assert inside(out, 4)


def test_a_particle_on_a_boundary_sample(tmp_path, solver):
    """It starts where the solid is: it is pushed out, or the run refuses or stops."""
    ball = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [0.1, 0.05, 0]}
    scene = pool(fluid__solver=solver, rigid__bodies={"ball": ball})

    def sink(x, origin):
        x[0, :3] = np.add(ball["position"], [0, 0.05 - 0.8 * D, 0]) - origin

    out = run_from_changed_start(scene, tmp_path, 4, sink)
    if out:
        x = positions(read_frame(out, 4)) - ball["position"]
        assert not (np.abs(x) < 0.05).all(axis=1).any()


def test_a_fixed_step_ten_times_too_long(tmp_path, solver):
    """Never right by chance: refused before the first step, or stopped in it."""
    scene = pool(fluid__solver=solver, fluid__bodies__water__velocity=[0, -1, 0])
    assert ends(scene, tmp_path, tmp_path / "adaptive", 2) == 0
    longest = steps(tmp_path / "adaptive")["dt"].max()
    fixed = pool(
        fluid__solver=solver, fluid__bodies__water__velocity=[0, -1, 0], fps=5, step={"fixed": 10 * float(longest)}
    )
    assert ends(fixed, tmp_path, tmp_path / "fixed", 2) in (2, 3)


def test_far_from_the_origin(tmp_path, solver):
    """1024 m away nothing changes but the rounding of what is written; numbers are chosen that binary holds."""
    body = {"shape": {"type": "box", "size": [0.1875] * 3}, "velocity": [1, 0, 0.5]}
    near = pool(
        fluid__solver=solver,
        fluid__particle_radius=1 / 64,
        containers__tank__size=[0.5] * 3,
        fluid__bodies__water=body | {"position": [0, 0.125, 0]},
    )
    far = json.loads(json.dumps(near))
    far["fluid"]["bodies"]["water"]["position"] = [1024, 0.125, -1024]
    far["containers"]["tank"]["position"] = [1024, 0, -1024]
    for name, scene in (("near", near), ("far", far)):
        assert ends(scene, tmp_path, tmp_path / name, 3) == 0
    with (
        np.load(tmp_path / "near" / "state_00003.npz") as a,
        np.load(tmp_path / "far" / "state_00003.npz") as b,
    ):
        for name in ("fluid.position", "fluid.velocity", "fluid.tag"):
            np.testing.assert_array_equal(a[name], b[name])


def test_other_sizes_are_similar(tmp_path, solver):
    """Froude: lengths s, times and speeds sqrt(s), that of sound too, viscosity s^1.5. What is scaled back agrees, as
    far as runs that differ by rounding can: an impact makes more of it."""
    found = []
    for s in (1.0, 0.01, 100.0):
        scene = pool(
            fps=100 / s**0.5,
            containers__tank__size=[0.4 * s] * 3,
            fluid__solver=solver,
            fluid__particle_radius=D / 2 * s,
            fluid__viscosity=1e-3 * s**1.5,
            fluid__wcsph={"speed_of_sound": 20 * s**0.5},
            fluid__bodies__water={
                "shape": {"type": "box", "size": [0.2 * s] * 3},
                "position": [0, 0.11 * s, 0],
                "velocity": [0.3 * s**0.5, 0, 0],
            },
        )
        assert ends(scene, tmp_path, tmp_path / f"{s:g}", 6) == 0
        points = read_frame(tmp_path / f"{s:g}", 6)
        found.append((positions(points) / s, velocities(points) / s**0.5))
    for x, v in found[1:]:
        np.testing.assert_allclose(x, found[0][0], atol=0.01 * D)
        np.testing.assert_allclose(v, found[0][1], atol=0.01 * np.abs(found[0][1]).max())


def test_a_turned_container(tmp_path, solver):
    """A shell of samples that is turned 30 degrees, and gravity with it, is the same scene but for its neighbours."""
    import trimesh

    outer, inner = trimesh.creation.box(extents=[0.64] * 3), trimesh.creation.box(extents=[0.4] * 3)
    inner.invert()
    trimesh.util.concatenate([outer, inner]).export(tmp_path / "shell.ply")
    turn = [{"axis": [0, 0, 1], "angle": 30}]
    matrix = trimesh.transformations.rotation_matrix(np.pi / 6, [0, 0, 1])[:3, :3]
    body = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}}
    means = []
    for name, rotation, gravity, place in (
        ("upright", [], np.array([0, -9.81, 0]), np.array([0, -0.06, 0])),
        ("turned", turn, matrix @ [0, -9.81, 0], matrix @ [0, -0.06, 0]),
    ):
        scene = {
            "fps": 50,
            "gravity": gravity.tolist(),
            "fluid": {
                "solver": solver,
                "particle_radius": D / 2,
                "bodies": {"water": body | {"position": place.tolist(), "rotation": rotation}},
            },
            "rigid": {"bodies": {"shell": {"shape": {"type": "mesh", "file": "shell.ply"}, "rotation": rotation}}},
        }
        assert ends(scene, tmp_path, tmp_path / name, 8) == 0
        back = positions(read_frame(tmp_path / name, 8)) @ (matrix if rotation else np.eye(3))
        assert (np.abs(back) < 0.2).all()
        means.append(back.mean(axis=0))
    # The samples of the two meshes are the same but for rounding; what the splash makes of that stays below a spacing.
    np.testing.assert_allclose(means[1], means[0], atol=0.1 * D)
    assert read_table(tmp_path / "turned" / "steps.csv")["density_error_max"].max() < 0.3


@pytest.mark.parametrize("coincident", [1, 2])
def test_more_particles_in_one_place(tmp_path, solver, coincident):
    """One particle, or two pairs of particles, where others are already: as two of them."""
    scene = pool(fluid__solver=solver)

    def meet(x, _):
        x[1 : 1 + coincident, :3] = x[10 : 10 + coincident, :3]

    out = run_from_changed_start(scene, tmp_path, 2, meet)
    if out:
        assert inside(out, 2)


def test_a_lattice_too_dense(tmp_path, solver):
    """Spacing 0.8 d, as no scene can ask for: the density, 1.95 times that at rest, is refused before the first step.
    A body interleaved with another has no room, which is refused; one that reaches out of it is filled there."""
    scene = pool(fluid__solver=solver)
    assert ends(scene, tmp_path, tmp_path / "start", 0) == 0

    def squeeze(x, _):
        x[:, :3] = x[:, :3].mean(axis=0) + 0.8 * (x[:, :3] - x[:, :3].mean(axis=0))

    changed(tmp_path / "start" / "state_00000.npz", tmp_path / "state_00000.npz", squeeze)
    squeezed = {"first": 1, "state": tmp_path / "state_00000.npz"}
    assert ends(scene, tmp_path, tmp_path / "squeezed", 2, **squeezed) in (2, 3)
    inside_it = {"shape": {"type": "box", "size": [0.12] * 3}, "position": [0.02, 0.17, 0.02]}
    within = pool(fluid__solver=solver, fluid__bodies={"water": WATER, "again": inside_it})
    assert ends(within, tmp_path, tmp_path / "within", 2) == 2
    again = WATER | {"position": [0.08, 0.17, 0.02]}
    both = pool(fluid__solver=solver, fluid__bodies={"water": WATER, "again": again})
    assert ends(both, tmp_path, tmp_path / "both", 2) == 0
    found = json.loads((tmp_path / "both" / "summary.json").read_text())["counts"]
    # The boxes have 0.12 x 0.18 x 0.18 m in common.
    assert found["particles_started"] == pytest.approx(250 - 0.12 * 0.18**2 / D**3, abs=3)


def test_explicit_viscosity_far_beyond_its_limit(tmp_path, solver):
    """The step shortens with nu, or is refused where a frame would need too many; `auto` takes implicit steps."""
    thick = pool(fluid__solver=solver, fluid__viscosity=10, fluid__viscosity_solver="explicit", fps=1000)
    assert ends(thick, tmp_path, tmp_path / "explicit", 1) == 0
    # 0.05 (h/2)^2 / nu, or less at walls.
    assert steps(tmp_path / "explicit")["dt"].max() <= 0.05 * D**2 / 10
    hopeless = pool(fluid__solver=solver, fluid__viscosity=1e4, fluid__viscosity_solver="explicit")
    assert ends(hopeless, tmp_path, tmp_path / "hopeless", 1) == 2
    implicit = pool(fluid__solver=solver, fluid__viscosity=1e4)
    assert ends(implicit, tmp_path, tmp_path / "implicit", 1) == 0
    assert steps(tmp_path / "implicit")["viscosity_iterations"].max() > 0


def test_a_piston_that_leaves_no_room(tmp_path, solver):
    """A plate closes a full box: no fluid can be there at last, so the run stops and keeps the last good state."""
    plate = {
        "shape": {"type": "box", "size": [0.5, 0.1, 0.5]},
        "position": [0, 0.45, 0],
        "motion": "prescribed",
        "velocity": [0, -2, 0],
    }
    scene = pool(
        fps=50,
        fluid__solver=solver,
        fluid__bodies__water={"shape": {"type": "box", "size": [0.4, 0.2, 0.4]}, "position": [0, 0.1, 0]},
        rigid__bodies={"plate": plate},
    )
    assert ends(scene, tmp_path, tmp_path / "run", 10) == 3
    assert list((tmp_path / "run").glob("state_*.npz"))
