"""Fluid and bodies that move each other: Archimedes, added mass, momentum."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.floating import RHO, G, momentum, pool, track
from tests.support.fluid.solvers import SOLVERS, probe
from tests.support.in_time import in_time
from tests.support.particles import read_frame, read_table

BALL = {"type": "sphere", "radius": 0.1}
BRICK = {"type": "box", "size": [0.24, 0.12, 0.24]}
ALL_IN_TIME = pytest.mark.parametrize("solver", ["dfsph", *in_time("wcsph", "iisph")])
VOLUME = {"sphere": 4 / 3 * np.pi * 0.1**3, "box": 0.24 * 0.12 * 0.24}


@pytest.mark.slow
@ALL_IN_TIME
def test_a_body_under_water_is_lifted_by_the_weight_of_its_volume(simulate, solver):
    """rho g V (Archimedes); the pool starts without pressure, so that the mean over the later half is taken."""
    body = {"shape": BALL, "position": [0, 0.2, 0]}
    probes = {"lift": {"type": "force", "body": "body", "rate": 500}}
    calm = {"wcsph": {"artificial_viscosity": 0.3}}
    # Compressible fluid swings for longer, with a period of 0.4 s.
    spacing, frames, after = (0.016, 80, 0.8) if solver == "wcsph" else (0.02, 60, 0.6)
    scene = pool(solver, spacing, (0.48, 0.8, 0.48), 0.4, body, fluid=calm, probes=probes)
    time, lift = probe(simulate(scene, frames), "lift", "force_y")
    assert lift[time > after].mean() == pytest.approx(RHO * G * VOLUME["sphere"], rel=0.03)


@pytest.mark.slow
def test_a_cube_under_water_is_lifted_by_the_weight_of_its_volume(simulate):
    """rho g V within 3 %, at 16 spacings across: what holds single particles off sharp edges holds fluid off, too."""
    body = {"shape": {"type": "box", "size": [0.2, 0.2, 0.2]}, "position": [0, 0.2, 0]}
    probes = {"lift": {"type": "force", "body": "body", "rate": 500}}
    out = simulate(pool("dfsph", 0.0125, (0.48, 0.8, 0.48), 0.4, body, probes=probes), 70)
    time, lift = probe(out, "lift", "force_y")
    assert lift[time > 0.6].mean() == pytest.approx(RHO * G * 0.2**3, rel=0.03)


def lift_error(simulate, layers: float) -> float:
    """Of a box so many layers of particles high, over rho g V: its mean after 1.2 s, when the pool no longer swings."""
    body = {"shape": BRICK, "position": [0, 0.21, 0]}
    probes = {"lift": {"type": "force", "body": "body", "rate": 500}}
    scene = pool("dfsph", BRICK["size"][1] / layers, (0.48, 0.8, 0.48), 0.42, body, probes=probes)
    time, lift = probe(simulate(scene, 120, f"{layers}"), "lift", "force_y")
    return lift[time > 1.2].mean() / (RHO * G * VOLUME["box"]) - 1


@pytest.mark.slow
@pytest.mark.parametrize("layers", [4, 4.5, 5, 5.5, 6, 8])
def test_the_lift_of_a_box_is_right_however_many_layers_it_is_high(simulate, layers):
    """rho g V within 3 %, as for the cube, whether or not particles fit between its faces and the walls."""
    assert abs(lift_error(simulate, layers)) < 0.03


@pytest.mark.slow
@pytest.mark.xfail(strict=True, reason="1.2 and 1.5 % over, by how particles fit, not by their size")
def test_the_lift_of_a_box_is_nearer_with_finer_particles(simulate):
    """The excess falls with the share of particles that are next to an edge, by the first order."""
    excess = [lift_error(simulate, layers) for layers in (4, 8)]
    assert 0 < excess[1] < 0.65 * excess[0] < 0.65 * 0.2


TOO_MUCH = pytest.mark.xfail(reason="7.7 to 10.8 % over, by rounding: some variants are beyond the bound")


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["dfsph", "wcsph", pytest.param("iisph", marks=TOO_MUCH)])
def test_a_body_on_the_ground_weighs_less_by_its_water(simulate, solver):
    """rho g V, though no particle gets under it; to the first order of the spacing over the height, a fourth."""
    body = {"shape": BRICK, "position": [0, 0.06, 0], "motion": "dynamic", "density": 2 * RHO}
    probes = {"lift": {"type": "force", "body": "body", "rate": 200}}
    out = simulate(pool(solver, 0.03, (0.6, 0.8, 0.6), 0.3, body, probes=probes), 60)
    time, lift = probe(out, "lift", "force_y")
    assert lift[time > 0.6].mean() == pytest.approx(RHO * G * VOLUME["box"], rel=0.1)
    assert track(out, "y")[30:] == pytest.approx(np.full(31, 0.06), abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_light_body_comes_up_from_the_ground(simulate, solver):
    """It lies flat, and would stay down if nothing pressed on its bottom."""
    body = {"shape": BRICK, "position": [0, 0.06, 0], "motion": "dynamic", "density": 0.5 * RHO}
    out = simulate(pool(solver, 0.03, (0.6, 0.8, 0.6), 0.3, body), 80)
    level = (len(read_frame(out, 80)) * 0.03**3 + 0.5 * VOLUME["box"]) / 0.6**2
    assert track(out, "y")[-20:].mean() == pytest.approx(level, abs=0.03)


def draft(shape: str, ratio: float) -> float:
    """How deep a body with this density over the fluid's floats [m]."""
    if shape == "box":
        return ratio * 0.12
    # The cap of height x R has the volume pi R^3 x^2 (3 - x) / 3.
    roots = np.roots([-1, 3, 0, -4 * ratio])
    return float(0.1 * next(x.real for x in roots if abs(x.imag) < 1e-9 and 0 < x.real < 2))


def error_of_draft(simulate, shape: dict, ratio: float, spacing: float, name: str = "run") -> float:
    """Draft that is found, less the one expected [m]; the level follows from the volumes of fluid and body."""
    side, depth, kind = 0.6, 0.3, shape["type"]
    height = 0.12 if kind == "box" else 0.2
    start = depth - draft(kind, ratio) + height / 2
    body = {"shape": shape, "position": [0, start, 0], "density": ratio * RHO, "motion": "dynamic"}
    scene = pool("dfsph", spacing, (side, 0.8, side), depth, body, fluid={"viscosity": 2e-4})
    out = simulate(scene, 100, name)
    found = track(out, "y")[-50:].mean() - height / 2
    fluid = len(read_frame(out, 100)) * spacing**3
    level = (fluid + ratio * VOLUME[kind]) / side**2
    return level - found - draft(kind, ratio)


@pytest.mark.slow
def test_a_box_floats_as_deep_as_it_should(simulate):
    """Within a spacing: fluid has no sharper surface."""
    assert abs(error_of_draft(simulate, BRICK, 0.5, 0.03)) < 0.03


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.25, 0.5, 0.75])
@pytest.mark.parametrize("shape", [BRICK, BALL], ids=["box", "sphere"])
def test_bodies_float_as_deep_as_they_should_and_nearer_with_finer_particles(simulate, shape, ratio):
    coarse, fine = (error_of_draft(simulate, shape, ratio, d, f"{d}") for d in (0.03, 0.015))
    assert abs(coarse) < 0.03
    assert abs(fine) < 0.015
    assert abs(fine) < max(abs(coarse), 0.25 * 0.015)


TANK = 0.6
"""Width of the tank in which balls are let go [m]."""
ADDED_MASS = 0.5 * (1 + 1.5 * 9.0336 * (BALL["radius"] / TANK) ** 3)
"""Of the ball there, over the mass of the water that it displaces. Its images in the four side walls move with it, in a
square lattice, and let the water come towards it by U / 2 (R / r)^3 each; they are 9.0336 / TANK^3 together. To the
first order in that, as for one wall (Lamb 1932, sec. 137). What the ground adds, the surface takes away again."""


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.1, 0.25, 0.5, 2, 5])
def test_a_body_let_go_under_water_moves_the_water_too(simulate, ratio):
    """A sphere in an ideal fluid: a = g (1 - s) / (s + 1/2), of which 1/2 is the mass of fluid that it takes along
    (Lamb 1932, sec. 92), and a little more between walls; without that a light one would be many times as fast. At
    first it sets off so, to half a spacing over the radius; what slows it then counts for more the lighter it is.

    What the solver leaves of the divergence, e, may hold up the water by e H / dt^2 at the depth H: 0.06 g by default
    in the first steps, when pressures are new. That is another error than the spacing's; here it is 0.02 g."""
    body = {"shape": BALL, "position": [0, 0.3, 0], "density": ratio * RHO}
    ideal = {"viscosity": 0, "wall_slip": "free_slip", "dfsph": {"divergence_error": 3e-5}}
    event = {"at": 0.4, "set": {"rigid.bodies.body.motion": "dynamic"}}
    out = simulate(pool("dfsph", 0.016, (TANK, 1.2, TANK), 0.6, body, fluid=ideal, events=[event], fps=100), 44)
    speed = track(out, "vy")[41:]
    expected = G * (1 - ratio) / (ratio + ADDED_MASS)
    print(ratio, speed / (0.01 * np.arange(1, 5)) / expected, np.diff(speed).mean() / 0.01 / expected)
    assert speed[:2] / [0.01, 0.02] == pytest.approx(np.full(2, expected), rel=0.08)
    assert speed / (0.01 * np.arange(1, 5)) == pytest.approx(np.full(4, expected), rel=0.17)
    assert ratio < 0.5 or np.diff(speed).mean() / 0.01 == pytest.approx(expected, rel=0.15)


@pytest.mark.slow
def test_the_lift_of_a_ball_is_right_from_three_spacings_on(simulate):
    """rho g V of R = 3 to 12 spacings, to 3 % and a sixth of a spacing in the radius."""
    radius = BALL["radius"]
    for spacings in (3, 4, 6, 8, 12):
        spacing = radius / spacings
        body = {"shape": BALL, "position": [0, 0.2, 0]}
        probes = {"lift": {"type": "force", "body": "body", "rate": 500}}
        out = simulate(pool("dfsph", spacing, (0.4, 0.8, 0.4), 0.4, body, probes=probes), 50, f"{spacings}")
        time, lift = probe(out, "lift", "force_y")
        error = lift[time > 0.6].mean() / (RHO * G * VOLUME["sphere"]) - 1
        print(f"R = {spacings} d: {error:+.1%}")
        assert abs(error) < 0.03 + 0.5 / spacings / 3


@pytest.mark.parametrize("solver", ["dfsph", *in_time("iisph")])
def test_a_body_goes_the_way_of_the_velocity_that_is_told(simulate, solver):
    """With one step a frame x(t) - x(t - dt) = dt v(t): what moves it and what is told is one velocity, and not half a
    step of the fluid's force behind. To what nine digits of a place leave. (By WCSPH bodies go by velocity Verlet, as
    particles do, with the velocity at half the step.)"""
    fps = 4000
    body = {"shape": BALL, "position": [0, 0.15, 0], "density": 0.5 * RHO, "motion": "dynamic"}
    out = simulate(pool(solver, 0.03, (0.4, 0.8, 0.4), 0.3, body, fps=fps), 24)
    assert len(read_table(out / "steps.csv")) == 24
    way, velocity = np.diff(track(out, "y")) * fps, track(out, "vy")[1:]
    assert abs(velocity - velocity[0] + G * np.arange(24) / fps).max() > 0.1 * G / fps, "no fluid moved it"
    np.testing.assert_allclose(way, velocity, atol=2e-9 * fps)


@pytest.mark.slow
@pytest.mark.xfail(strict=True, reason="it sinks by 31 mm in 1 s: the lift of a ball of 5 spacings is 1.8 % short")
def test_a_body_as_heavy_as_water_stays_where_it_is(simulate):
    """It drifts by less than 0.01 sqrt(g R)."""
    body = {"shape": BALL, "position": [0, 0.24, 0], "density": RHO}
    event = {"at": 1.0, "set": {"rigid.bodies.body.motion": "dynamic"}}
    out = simulate(pool("dfsph", 0.02, (0.48, 0.96, 0.48), 0.48, body, events=[event]), 100)
    place = np.column_stack([track(out, axis)[50:] for axis in "xyz"])
    assert np.linalg.norm(place[-1] - place[0]) / 1.0 < 0.01 * np.sqrt(G * 0.1)


EDGE = 0.1
"""Of the box [m]."""


def thrown(simulate, solver: str, ratio: float, **fluid):
    """A cube of fluid hits a box off its middle, without gravity: momenta before and after, speeds of the box [m/s]."""
    body = {
        "shape": {"type": "box", "size": [EDGE] * 3},
        "position": [0.16, 0.03, 0.02],
        "density": ratio * RHO,
        "motion": "dynamic",
    }
    water = {"shape": {"type": "box", "size": [0.16] * 3}, "velocity": [2, 0, 0]}
    fluid = {"solver": solver, "particle_radius": 0.01, "bodies": {"water": water}, **fluid}
    scene = {"fps": 100, "gravity": [0, 0, 0], "fluid": fluid, "rigid": {"bodies": {"body": body}}}
    out = simulate(scene, 12, fluid.get("viscosity_solver", "auto"))
    mass = ratio * RHO * EDGE**3
    of_all = (mass, mass * EDGE**2 / 6, RHO * 0.02**3)
    return momentum(out, 0, *of_all), momentum(out, 12, *of_all), track(out, "vx")


@pytest.mark.parametrize("ratio", [0.5, *in_time(0.01, 100.0)])
@pytest.mark.parametrize("solver", SOLVERS)
def test_momentum_goes_from_one_to_the_other(simulate, solver, ratio):
    """It is kept to 1e-5, angular momentum as the solver keeps it: pressures that are looked for act where particles
    will be, not where they are."""
    (linear, angular), (after, turning), speed = thrown(simulate, solver, ratio, viscosity=1e-3)
    mass = ratio * RHO * EDGE**3
    assert mass * speed[-1] > 0.1 * min(mass * 2, linear[0] / 2), "the box was not hit"
    whole = np.linalg.norm(linear)
    np.testing.assert_allclose(after, linear, atol=1e-5 * whole)
    np.testing.assert_allclose(turning, angular, atol=(1e-5 if solver == "wcsph" else 1e-3) * whole * EDGE)


THICK = {"viscosity_solver": "implicit"}


@pytest.mark.parametrize(
    ("solver", "ratio"),
    [("dfsph", 0.01), *(pytest.param(name, 0.5, marks=pytest.mark.slow) for name in SOLVERS)],
)
def test_implicit_viscosity_passes_momentum_on(simulate, solver, ratio):
    """As above, at 5 million times the viscosity of water."""
    (linear, angular), (after, turning), speed = thrown(simulate, solver, ratio, viscosity=5.0, **THICK)
    whole = np.linalg.norm(linear)
    np.testing.assert_allclose(after, linear, atol=1e-5 * whole)
    np.testing.assert_allclose(turning, angular, atol=1e-3 * whole * EDGE)
    assert speed.max() < 2.0 * 1.02, "the box was thrown faster than the fluid came"
    # Stuck together, both move as their centre of mass does but for the turning of the whole.
    common = linear[0] / (linear[0] / 2 + ratio * RHO * EDGE**3)
    assert speed[-1] == pytest.approx(common, rel=0.1)


@pytest.mark.slow
def test_implicit_viscosity_slows_as_explicit_does(simulate):
    """The same forces, whichever way they are found: after the blow the box moves as fast."""
    settings = {"viscosity": 0.05}
    implicit, explicit = (
        thrown(simulate, "dfsph", 0.5, viscosity_solver=solver, **settings)[2][-1]
        for solver in ("implicit", "explicit")
    )
    assert implicit == pytest.approx(explicit, rel=0.01)


@pytest.mark.slow
def test_a_ball_turns_in_thick_fluid_as_fast_as_its_torque_makes_it(simulate):
    """T = 8 pi mu omega / (1 / R^3 - 1 / b^3) within a sphere of radius b (Lamb 1932, sec. 334), here of a cube's half
    edge: to the first order of the spacing over R, a sixth: friction acts between centres of particles."""
    radius, half, viscosity = 0.06, 0.15, 0.1
    torque = 8 * np.pi * RHO * viscosity / (1 / radius**3 - 1 / half**3)
    body = {
        "shape": {"type": "sphere", "radius": radius},
        "density": RHO,
        "motion": "dynamic",
        "torque": [0, torque, 0],
    }
    walls = {"type": "box", "size": [2 * half] * 3, "position": [0, -half, 0], "open": []}
    water = {"shape": {"type": "box", "size": [2 * half] * 3}}
    fluid = {"solver": "dfsph", "particle_radius": 0.005, "viscosity": viscosity, "bodies": {"water": water}, **THICK}
    scene = {"fps": 50, "containers": {"tank": walls}, "fluid": fluid, "rigid": {"bodies": {"body": body}}}
    out = simulate(scene, 16)
    assert track(out, "wy")[-6:].mean() == pytest.approx(1.0, rel=0.17)
