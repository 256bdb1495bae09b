"""Cloth in equilibrium against closed forms.

Implicit Euler with steps of seconds finds equilibria as Newton's method would; the others have to swing out.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.cloths import HANGING, INTEGRATORS, G, part, places, rope, sheet, step
from tests.support.in_time import in_time

STATIC = {"implicit_euler": {"velocity_error": 1e-6, "linear_error": 1e-3, "max_newton": 200}}


def settled(sheets: dict, steps: int = 20, dt: float = 0.3, **cloth):
    made = part(sheets, **(STATIC | cloth))
    step(made, steps * dt, dt)
    return made


@pytest.mark.parametrize("cells", [5, 40])
def test_a_column_stretches_under_its_own_weight(cells):
    """N masses m on N springs k: m g N (N + 1) / (2 k); with half a mass at the end m g N^2 / (2 k), which is
    rho g L^2 / (2 K) at any spacing."""
    weight, stiffness, length = 0.3, 500.0, 2.0
    made = settled({"column": rope(length, cells, rotation=HANGING, pins=["left"], mass_per_area=weight,
                                   stretch_stiffness=stiffness)})  # fmt: skip
    stretch = np.ptp(places(made)[:, 1]) - length
    assert stretch == pytest.approx(weight * G * length**2 / (2 * stiffness), rel=1e-4)


@pytest.mark.parametrize(("slack", "sag"), [*in_time((1.2, 0.2923)), (1.05, 0.1393)])
def test_a_rope_hangs_as_a_catenary(slack, sag):
    made = settled({"rope": rope(1.0, 60, pins=["left", "right"], rest_scale=slack, stretch_stiffness=1e6)}, 40)
    assert -places(made)[:, 1].min() == pytest.approx(sag, rel=0.01)


def test_a_strip_is_as_stiff_as_it_is_said_to_be():
    """A strip that may contract, pulled along its threads: K = force / width / strain; and it contracts by
    nu = G / c, c = (K + sqrt(K^2 + 4 G^2)) / 2."""
    stretch, shear, weight = 1000.0, 400.0, 1e-3
    made = settled(
        {"strip": sheet((2.0, 0.2), spacing=0.02, rotation=HANGING, pins=["left"], stretch_stiffness=stretch,
                        shear_stiffness=shear, mass_per_area=weight, bend_stiffness=0)},
        gravity=(0, -1e4, 0),
    )  # fmt: skip
    strain = np.ptp(places(made)[:, 1]) / 2.0 - 1
    assert strain == pytest.approx(weight * 1e4 * 2.0 / (2 * stretch), rel=0.01)
    middle = np.abs(places(made)[:, 1]) < 0.011
    contraction = 1 - np.ptp(places(made)[middle, 2]) / 0.2
    whole = (stretch + np.sqrt(stretch**2 + 4 * shear**2)) / 2
    assert contraction == pytest.approx(shear / whole * weight * 1e4 * 1.0 / stretch, rel=0.05)


@pytest.mark.parametrize("most", [40, pytest.param(80, marks=pytest.mark.slow)])
@pytest.mark.parametrize("pins", [["left", "right"], ["left", "right", "front", "back"]])
def test_a_sheet_sags_as_much_at_any_spacing(pins, most):
    """Material parameters are per area and length, not per spring."""
    cloth = {"pins": pins, "stretch_stiffness": 200.0, "mass_per_area": 0.3}
    sags = [
        -places(settled({"sheet": sheet((1.0, 1.0), spacing=1 / cells, **cloth)}))[:, 1].min() for cells in (10, most)
    ]
    assert max(sags) / min(sags) < 1.05, sags


@pytest.mark.parametrize("bend", [2e-3, 8e-3])
def test_a_cantilever_bends_by_its_stiffness(bend):
    """q L^4 / (8 B) (Euler, Bernoulli), with two rows of points held: clamped half a cell from the first hinge."""
    length, cells, weight = 0.5, 25, 1e-3
    edge = length / cells
    clamped = [[x, 0, z] for x in (-length / 2, -length / 2 + edge) for z in np.linspace(-0.1, 0.1, 11)]
    made = settled(
        {"strip": sheet((length, 0.2), spacing=edge, pins=[{"at": clamped}], mass_per_area=weight,
                        stretch_stiffness=1e4, bend_stiffness=bend)},
    )  # fmt: skip
    drop = -places(made)[:, 1].min()
    assert drop == pytest.approx(weight * G * (length - edge / 2) ** 4 / (8 * bend), rel=0.02)
    assert drop < 0.1 * length


@pytest.mark.slow
def test_equilibrium_does_not_depend_on_the_integrator():
    cloth = {"pins": ["corners"], "stretch_stiffness": 50.0, "damping": 1.0, "bend_damping": 1.0, "mass_per_area": 0.3}
    air = {"density": 1000.0}
    sags = {}
    for integrator in INTEGRATORS:
        # One sweep in long substeps leaves XPBD softer: 2.7 % with the default of 10, in proportion to their length.
        made = part(
            {"sheet": sheet((1.0, 1.0), spacing=0.125, **cloth)}, integrator=integrator, air=air, xpbd={"substeps": 80}
        )
        step(made, 12.0, 0.01)
        assert made.measure().v_max < 1e-4
        sags[integrator] = -places(made)[:, 1].min()
    assert max(sags.values()) / min(sags.values()) < 1.005, sags
