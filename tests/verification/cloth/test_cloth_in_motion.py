"""Moving cloth against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk, jn_zeros

from tests.support.cloths import HANGING, INTEGRATORS, G, part, period, places, rope, set_motion, sheet, step
from tests.support.in_time import in_time

EXACT = {"implicit_euler": {"velocity_error": 1e-7, "linear_error": 1e-5, "max_newton": 50}}


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_free_fall_is_exact(integrator):
    """v = g t, x = g t^2 / 2 to rounding, and the cloth keeps its shape."""
    made = part({"sheet": sheet((1, 1), spacing=0.1, velocity=[1, 2, 3], rotation=[{"axis": [1, 2, 3], "angle": 40}])},
                integrator=integrator, xpbd={"substeps": 1}, symplectic_euler={"share": 1.0}, **EXACT)  # fmt: skip
    start, dt, steps = places(made), 1e-4, 100
    step(made, steps * dt, dt)
    _, velocity = made.vertices("sheet")
    assert np.allclose(velocity, np.array([1, 2 - G * steps * dt, 3]), rtol=0, atol=1e-9)
    fallen = np.array([1, 2, 3]) * steps * dt - [0, G * (steps * dt) ** 2 / 2, 0]
    assert np.allclose(places(made) - start, fallen, rtol=0, atol=1e-9)


@pytest.mark.parametrize("dt", [4e-3, 16e-3])
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_towels_that_are_thrown_fly_as_far_as_they_should(integrator, dt):
    """v0 t + g t^2 / 2, for their centre of mass: they spin, and beat each other."""
    places_of = {"one": [0, 0, 0], "other": [0.01, 0.004, 0.02]}
    towel = sheet((0.3, 0.3), spacing=0.03)
    made = part({name: towel | {"position": place} for name, place in places_of.items()}, integrator=integrator)
    mass = made.mesh.mass / made.mesh.mass.sum()

    def middle() -> np.ndarray:
        return mass @ np.concatenate([places(made, name) for name in places_of])

    x = np.concatenate([places(made, name) for name in places_of])
    start, v0, t, touched = middle(), np.array([2.0, 3.0, 0.0]), 0.32, []
    beat = np.repeat([[0, 0.5, 0], [0, -0.5, 0]], len(x) // 2, axis=0)
    set_motion(made, velocity=v0 + np.cross([3, 5, 2], x - start) + beat)
    step(made, t, dt, lambda _: touched.append(made.collisions.count))
    assert max(touched) > 0
    np.testing.assert_allclose(middle() - start, v0 * t - [0, G * t**2 / 2, 0], rtol=0, atol=1e-9)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("mode", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_a_taut_rope_has_the_pitch_of_its_masses(integrator, mode):
    """w_n = 2 sqrt(T / (m a)) sin(n pi / (2 (N + 1))), N masses m at distances a under the tension T.

    The threads between the two ropes begin at rest: taut, they would swing, and pump what rounding leaves into other
    modes, to a fifth of the rope's own swing within this time.
    """
    cells, stiffness, weight, slack = 20, 1000.0, 0.2, 0.9
    string = rope(1.0, cells, pins=["left", "right"], rest_scale=slack, damping=0, mass_per_area=weight,
                  stretch_stiffness=stiffness)  # fmt: skip
    made = part({"rope": string}, gravity=(0, 0, 0), integrator=integrator, **EXACT)
    a = 1.0 / cells
    # Each rope stands for half of the strip's width.
    tension, mass = stiffness * a / 2 * (1 - slack), weight * a * a / 2
    expected = 2 * np.sqrt(tension / (mass * a)) * np.sin(mode * np.pi / (2 * cells))
    x = places(made)
    shape = np.sin(mode * np.pi * (x[:, 0] + 0.5))
    set_motion(made, position=x * [1, 1, slack], velocity=np.outer(1e-3 * expected * shape, [0, 1, 0]))
    dt = 2 * np.pi / expected / 100
    heights, times = [], []

    def look(time: float) -> None:
        times.append(time)
        heights.append((places(made)[:, 1] * shape).sum())

    step(made, 500 * dt, dt, look)
    bound = 0.02 if integrator == "xpbd" else 0.005
    assert 2 * np.pi / period(np.array(times), np.array(heights)) == pytest.approx(expected, rel=bound)
    if integrator == "implicit_euler":
        swing = np.exp(1j * expected * np.array(times[:100]))
        basis = np.column_stack([swing.real, swing.imag])
        first, last = (np.linalg.norm(np.linalg.lstsq(basis, part)[0]) for part in (heights[:100], heights[-100:]))
        kept = (last / first) ** (1 / 400)
        z = 1j * expected * dt
        assert 1 - kept == pytest.approx(1 - abs((2 + np.sqrt(1 + 2 * z)) / (3 - 2 * z)), rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("integrator", "angle"),
    [
        ("symplectic_euler", 90),
        *in_time(("symplectic_euler", 30), ("symplectic_euler", 60), ("xpbd", 90), ("implicit_euler", 90)),
    ],
)
def test_a_pendulum_swings_slower_the_wider_it_swings(integrator, angle):
    """T = 4 sqrt(L / g) K(sin^2(angle / 2)): 1.0174, 1.0732, 1.1803 of 2 pi sqrt(L / g)."""
    length = 0.5
    made = part({"pendulum": sheet((length, length), spacing=length, shear_stiffness=0, bend_stiffness=0, damping=0,
                                   stretch_stiffness=1e5, pins=["left"])},
                integrator=integrator, xpbd={"substeps": 4}, **EXACT)  # fmt: skip
    x = places(made)
    arm = x[:, 0] + length / 2
    turn = np.deg2rad(angle)
    set_motion(made, position=np.column_stack([arm * np.sin(turn), -arm * np.cos(turn), x[:, 2]]))
    expected = 4 * np.sqrt(length / G) * ellipk(np.sin(turn / 2) ** 2)
    sideways, times, end = [], [], int(np.argmax(arm))

    def look(time: float) -> None:
        times.append(time)
        sideways.append(places(made)[end, 0])

    step(made, 2.2 * expected, expected / 2000, look)
    # Implicit Euler takes 2 % of the swing in this time, and wide swings are slow.
    bound = 0.02 if integrator == "implicit_euler" else 0.005
    assert period(np.array(times), np.array(sideways)) == pytest.approx(expected, rel=bound)


def test_what_swings_freely_does_so_to_second_order():
    """phi'' = -g / L sin(phi), let go at 30 degrees; implicit Euler would take 4 % a swing in steps of 4 ms."""
    length, start, end, wrong = 0.5, np.pi / 6, 0.96, []
    exact = solve_ivp(lambda _, y: [y[1], -G / length * np.sin(y[0])], (0, end), [start, 0], rtol=1e-10, atol=1e-12)
    for dt in (16e-3, 8e-3, 4e-3):
        made = part({"pendulum": sheet((length, length), spacing=length, shear_stiffness=0, bend_stiffness=0,
                                       damping=0, stretch_stiffness=1e6, pins=["left"])}, **EXACT)  # fmt: skip
        arm = places(made)[:, 0] + length / 2
        turn = np.column_stack([np.sin(start) * arm, -np.cos(start) * arm, places(made)[:, 2]])
        set_motion(made, position=turn)
        step(made, end, dt)
        x, y, _ = places(made)[np.argmax(arm)]
        wrong.append(np.arctan2(x, -y) - exact.y[0, -1])
    assert np.abs(wrong[-1]) < 1e-3
    assert np.log2(np.abs(np.array(wrong[:-1]) / wrong[1:])) == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize("integrator", ["xpbd", *in_time("symplectic_euler", "implicit_euler")])
def test_a_hanging_rope_sways(integrator):
    """w = j / 2 sqrt(g / L), j = 2.4048 the first zero of Bessel's J0 (Daniel Bernoulli 1732)."""
    length = 1.0
    made = part({"rope": rope(length, 30, rotation=HANGING, pins=["left"], stretch_stiffness=2e4, damping=0)},
                integrator=integrator, **EXACT)  # fmt: skip
    expected = jn_zeros(0, 1)[0] / 2 * np.sqrt(G / length)
    from scipy.special import j0

    below = 0.5 - places(made)[:, 1]
    shape = j0(jn_zeros(0, 1)[0] * np.sqrt(np.maximum(length - below, 0) / length))
    set_motion(made, velocity=np.outer(0.01 * shape, [1, 0, 0]))
    sideways, times = [], []

    def look(time: float) -> None:
        times.append(time)
        sideways.append(places(made)[np.argmin(places(made)[:, 1]), 0])

    step(made, 5.0, 4e-3, look)
    assert 2 * np.pi / period(np.array(times), np.array(sideways)) == pytest.approx(expected, rel=0.02)


def test_a_spring_sends_waves_at_its_speed():
    """c = a sqrt(k / m) along a chain: sqrt(K / rho), whatever the spacing."""
    stiffness, weight, cells = 100.0, 0.25, 200
    made = part({"rope": rope(4.0, cells, stretch_stiffness=stiffness, mass_per_area=weight, damping=0)},
                gravity=(0, 0, 0), integrator="symplectic_euler")  # fmt: skip
    x = places(made)
    pulse = 1e-3 * np.exp(-(((x[:, 0] + 1.0) / 0.2) ** 2))
    speed = np.sqrt(stiffness / weight)
    gradient = -2 * (x[:, 0] + 1.0) / 0.04 * pulse
    set_motion(made, position=x + np.outer(pulse, [1, 0, 0]), velocity=np.outer(-speed * gradient, [1, 0, 0]))
    step(made, 2.0 / speed, 1e-3)
    after = (places(made) - x)[:, 0]
    assert x[np.argmax(after), 0] == pytest.approx(1.0, abs=0.02 * 2)
    assert after.max() == pytest.approx(1e-3, rel=0.02)


@pytest.mark.parametrize("integrator", ["xpbd", *in_time("symplectic_euler", "implicit_euler")])
def test_what_falls_in_air_comes_to_its_last_speed(integrator):
    """m g = rho / 2 C A v^2 for a flat piece that falls flat."""
    made = part({"sheet": sheet((0.5, 0.5), spacing=0.1, mass_per_area=0.1)}, integrator=integrator,
                air={"density": 1.3, "drag": 1.1, "skin_friction": 0})  # fmt: skip
    step(made, 3.0, 0.005)
    assert -made.vertices("sheet")[1][:, 1].mean() == pytest.approx(np.sqrt(2 * 0.1 * G / (1.3 * 1.1)), rel=0.002)


def test_explicit_steps_blow_up_where_the_formula_says():
    """dt < 2 / w_max; for a long chain of equal masses w_max^2 = 4 k / m sin^2(pi N / (2 (N + 1)))."""
    cells, stiffness, weight = 40, 1000.0, 0.2
    made = {}
    for share in (0.99, 1.01):
        chain = rope(1.0, cells, pins=["left", "right"], damping=0, stretch_stiffness=stiffness, mass_per_area=weight)
        made[share] = part({"rope": chain}, gravity=(0, 0, 0), integrator="symplectic_euler")
        a = 1.0 / cells
        k, m = stiffness / 2, weight * a * a / 2
        limit = 2 / np.sqrt(4 * k / m) / np.sin(np.pi * (cells - 1) / (2 * cells))
        noise = np.random.default_rng(1).normal(size=(made[share].mesh.count, 3)) * 1e-6
        set_motion(made[share], velocity=np.where(made[share].mesh.held[:, None], 0, noise))
        made[share].integrator.run(share * limit, 4000)
        # Threads across, of stiffness K, count for the bound as well: 2 sum k / m = 2 (2 K/2 + K) / m.
        assert made[share].integrator.stable == pytest.approx(0.69 * 2 / np.sqrt(4 * stiffness / m), rel=1e-6)
    assert made[0.99].measure().v_max < 1e-3
    wild = made[1.01].measure()
    assert not wild.finite or wild.v_max > 1.0


@pytest.mark.parametrize("integrator", ["symplectic_euler", "xpbd", *in_time("implicit_euler")])
def test_one_thread_and_many_do_the_same(integrator, monkeypatch):
    """Small cloths are stepped by one thread; larger ones as here by all of them."""
    found = []
    for alone in (4000, 0):
        monkeypatch.setattr("sim.cloth.fabric.mesh.ALONE", alone)
        made = part(
            {"sheet": sheet((1, 1), spacing=0.1, pins=["left"])}, integrator=integrator, air={}, threads=2, **EXACT
        )
        step(made, 0.1, 0.005)
        found.append(places(made))
    assert np.allclose(*found, rtol=0, atol=1e-6)
    assert np.abs(found[0][:, 1]).max() > 0.01
