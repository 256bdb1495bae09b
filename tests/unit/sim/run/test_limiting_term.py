"""What limits the step is said by the material that does, with its numbers and what would help."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from sim.run.stepping import Run
from sim.spec import SimulationSpec

BLOCK = {"shape": {"type": "box", "size": [0.1, 0.1, 0.1]}, "position": [0, 0.05, 0]}
TAP = {"shape": {"type": "disc", "radius": 0.05}, "position": [0, 0.5, 0], "speed": 30}
BALL = {"shape": {"type": "sphere", "radius": 0.1}, "position": [1, 1, 0], "motion": "dynamic"}
TOWEL = {"shape": {"type": "sheet", "size": [0.2, 0.2]}, "position": [2, 2, 0]}


def fluid(**settings):
    return {"fluid": {"particle_radius": 0.01, "bodies": {"block": BLOCK}} | settings}


def rigid(settings=None, **ball):
    return {"rigid": {"bodies": {"ball": BALL | ball}} | (settings or {})}


def cloth(settings=None, **towel):
    return {"cloth": {"sheets": {"towel": TOWEL | towel}} | (settings or {})}


SAID = {
    r"the fastest signal \(sound \S+ m/s, fluid 0 m/s\): use lower speeds": fluid(),
    r"the fastest signal \(fluid 30 m/s, emitters 30 m/s\): use lower speeds": fluid(
        solver="dfsph", bodies={"block": BLOCK | {"velocity": [0, -30, 0]}}, emitters={"tap": TAP}
    ),
    r"the fastest signal \(fluid 0 m/s, bodies 20 m/s\): use lower speeds": fluid(solver="iisph")
    | rigid(motion="prescribed", velocity=[20, 0, 0]),
    r"the force on the particles \(\S+ m/s\^2\): use weaker forces": fluid(solver="dfsph"),
    r"the viscosity \(10 m\^2/s\): use fluid.viscosity_solver: implicit": fluid(
        viscosity=10, viscosity_solver="explicit", solver="dfsph"
    ),
    r"the surface tension \(200 N/m\): use a lower one": fluid(surface_tension=200, solver="dfsph"),
    r"rigid.max_step: raise it": rigid({"max_step": 1e-4}),
    r"the spin of a body \(500 rad/s\): let it turn more slowly": rigid(angular_velocity=[0, 500, 0]),
    r"the speed of a body \(90 m/s\): use lower speeds or larger bodies": rigid(velocity=[90, 0, 0]),
    r"cloth.max_step: raise it": cloth(),
    r"the stiffness of the cloth \(explicit steps of \S+ s\): use cloth.integrator: implicit_euler": cloth(
        {"integrator": "symplectic_euler", "max_step": 0.1}, stretch_stiffness=1e8
    ),
}


@pytest.mark.parametrize("words", SAID)
def test_the_material_says_what_limits_the_step(words):
    run = Run(SimulationSpec.model_validate({"fps": 1000} | SAID[words]), Path(), threads=1, arch="cpu")
    run.start()
    said = ": ".join(run.world.limiting_term(run.measure))
    assert re.match(words, said), said
