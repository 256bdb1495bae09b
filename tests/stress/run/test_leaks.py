"""Nothing gets into a solid or through it: for every solver, however fast, thin, pointed or moving.

Counts are of particles whose centre lies inside the solid, or beyond it, in any frame; there must be none.
Without gravity and viscosity these scenes know no scale of time, so that a blob at 5 m/s behaves as one at 50.
"""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sim.bodies.obstacles import find_obstacles
from sim.spec import SimulationSpec
from tests.stress.scenes import assert_nothing_broken
from tests.support.fluid.solvers import LONG
from tests.support.in_time import in_time
from tests.support.particles import positions, read_frame
from tests.support.sharp_bodies import SPACING, TOP, export, sharp_bodies

FRAMES = 8
BODIES = ("plate", "box", "edge up", "wedge", "spike")
RATIOS = (4, *in_time(3, 6))


def blob(solver, speed, bodies, *, size=(0.24, 0.24, 0.24), cfl=0.4, ratio=4, **changes):
    """Fluid just above TOP that falls on the bodies at a speed [m/s] and has passed them in the last frame."""
    return {
        "fps": speed * FRAMES / (size[1] + 0.5),
        "gravity": [0, 0, 0],
        "step": {"cfl": cfl},
        "fluid": {
            "solver": solver,
            "particle_radius": SPACING / 2,
            "support_ratio": ratio,
            "bodies": {
                "blob": {
                    "shape": {"type": "box", "size": list(size)},
                    "position": [0, TOP + 0.08 + size[1] / 2, 0],
                    "velocity": [0, -speed, 0],
                }
            },
        },
        "rigid": {"bodies": bodies},
        **changes,
    }


def inside(scene, out, folder):
    """How many particles are inside a body, where it is then, summed over the frames."""
    count = 0
    spec = SimulationSpec.model_validate(scene)
    for frame in range(FRAMES + 1):
        x = positions(read_frame(out, frame))
        for item in find_obstacles(spec, folder).placed:
            movement = item.movement(frame / scene["fps"])
            count += int(item.solid.contains(movement.carry_back(x) if movement else x).sum())
    return count


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", LONG)
@pytest.mark.parametrize("name", BODIES)
def test_a_blob_hits_what_stands(simulate, tmp_path, name, solver):
    """At the longest steps that settings allow."""
    scene = blob(solver, 5.0, {"body": sharp_bodies(tmp_path)[name]}, cfl=1.0)
    out = simulate(scene, FRAMES, threads=1)
    assert_nothing_broken(out)
    assert inside(scene, out, tmp_path) == 0


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", LONG)
@pytest.mark.parametrize("name", BODIES)
def test_a_body_hits_a_blob(simulate, tmp_path, name, solver):
    """Each at half of 50 m/s, the body turning."""
    moves = {"motion": "prescribed", "velocity": [0, 25, 0], "angular_velocity": [0, 30, 0]}
    scene = blob(solver, 25.0, {"body": sharp_bodies(tmp_path)[name] | moves})
    out = simulate(scene, FRAMES, threads=1)
    assert_nothing_broken(out)
    assert inside(scene, out, tmp_path) == 0


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", LONG)
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_jet_hits_a_plate(simulate, tmp_path, ratio, solver):
    """50 m/s, on a plate half as thick as a particle is wide, whatever the support."""
    thin = {"shape": {"type": "box", "size": [1.2, SPACING / 2, 1.2]}, "position": [0, TOP, 0]}
    scene = blob(solver, 50.0, {"plate": thin}, size=(0.12, 0.8, 0.12), ratio=ratio)
    out = simulate(scene, FRAMES, threads=1)
    assert_nothing_broken(out)
    assert inside(scene, out, tmp_path) == 0
    for frame in range(FRAMES + 1):
        x = positions(read_frame(out, frame))
        across = np.abs(x[:, [0, 2]]).max(axis=1) < 0.6
        assert not (across & (x[:, 1] < TOP)).any()


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", LONG)
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("kind", ["planes", "cube", "spike"])
def test_nothing_leaves_a_closed_container(simulate, tmp_path, kind, ratio, solver):
    """Thrown into a corner of plane walls, of a cube of samples, and of a pointed mesh; every particle stays."""
    if kind == "planes":
        container = {"type": "box", "size": [0.4, 0.4, 0.4], "position": [0, -0.2, 0], "open": []}
    else:
        mesh = trimesh.creation.box(extents=[0.4] * 3)
        if kind == "spike":
            spike = [[0, 0.55, 0], [-0.66, -0.33, -0.44], [0.66, -0.33, -0.44], [0, -0.33, 0.66]]
            mesh = trimesh.Trimesh(spike, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]])
        export(mesh, tmp_path / "container.ply")
        container = {"type": "mesh", "shape": {"type": "mesh", "file": "container.ply"}}
    scene = blob(solver, 5.0, {}, size=(0.24, 0.2, 0.2), ratio=ratio, containers={"container": container})
    del scene["rigid"]
    scene["fluid"]["bodies"]["blob"] |= {"position": [0, 0, 0], "velocity": [5, -4.5, 4]}
    out = simulate(scene, FRAMES, threads=1)
    assert_nothing_broken(out)
    count = len(read_frame(out, 0))
    for frame in range(FRAMES + 1):
        x = positions(read_frame(out, frame))
        if kind == "planes":
            held = np.abs(x).max(axis=1) < 0.2
        else:
            held = find_obstacles(SimulationSpec.model_validate(scene), tmp_path).placed[0].solid.contains(x)
        assert held.sum() == len(x) == count


@pytest.mark.outcome("A")
@pytest.mark.parametrize("solver", LONG)
@pytest.mark.parametrize(
    "motion",
    [{"velocity": [2.5, -1.7, 1.3]}, {"angular_velocity": [0, 12, 12]}],
    ids=["carried", "spun"],
)
def test_nothing_leaves_a_box_that_moves(simulate, tmp_path, motion, solver):
    """A shell around fluid at rest sets off at once."""
    outer, inner = trimesh.creation.box(extents=[0.64] * 3), trimesh.creation.box(extents=[0.4] * 3)
    inner.invert()
    trimesh.util.concatenate([outer, inner]).export(tmp_path / "shell.ply")
    shell = {"shape": {"type": "mesh", "file": "shell.ply"}, "motion": "prescribed", **motion}
    scene = blob(solver, 5.0, {"shell": shell}, size=(0.24, 0.2, 0.2))
    scene["fluid"]["bodies"]["blob"] |= {"position": [0, 0, 0], "velocity": [0, 0, 0]}
    out = simulate(scene, FRAMES, threads=1)
    (item,) = find_obstacles(SimulationSpec.model_validate(scene), tmp_path).placed
    for frame in range(FRAMES + 1):
        x = item.movement(frame / scene["fps"]).carry_back(positions(read_frame(out, frame)))
        assert (np.abs(x) < 0.2).all()


@pytest.mark.outcome("A")
def test_fluid_keeps_off_thin_bodies_and_edges_at_the_start(simulate):
    """A plate half a spacing thin has its samples right below its surface: fluid that starts around it is not torn."""
    bodies = {
        "thin": {"shape": {"type": "box", "size": [0.3, SPACING / 2, 0.3]}, "position": [0, -0.2, 0]},
        "sheet": {"shape": {"type": "sheet", "size": [0.3, 0.3]}, "position": [0, 0.2, 0]},
        "cube": {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}},
    }
    scene = blob("wcsph", 1.0, bodies, size=(0.4, 0.8, 0.4))
    scene["fluid"]["bodies"]["blob"] |= {"position": [0, 0, 0], "velocity": [0, 0, 0]}
    out = simulate(scene, 0, threads=1)
    # Half a spacing off a plane the lattice has the rest density; the clearance lets it be as much as 0.05 h nearer.
    assert read_frame(out, 0)["density"].max() < 1.1 * 1000
