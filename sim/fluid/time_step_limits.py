"""Largest stable time steps, for every solver (Monaghan 1992, sec. 10; `half` is half the support radius)."""

import math

from sim.fluid.spec import Fluid


def force_limit(half: float, acceleration: float) -> float:
    """0.25 sqrt(half / a) [s]."""
    return 0.25 * math.sqrt(half / acceleration) if acceleration > 0 else math.inf


def fall_limit(half: float, gravity: float) -> float:
    """0.1 sqrt(half / g) [s]: who falls by more than a hundredth of `half` before pressures answer, heats the fluid."""
    return 0.1 * math.sqrt(half / gravity) if gravity > 0 else math.inf


def viscosity_limit(half: float, viscosity: float, strongest: float = 0.0) -> float:
    """0.08 half^2 / nu [s], for explicit viscosity [m^2/s].

    The friction of a particle between others at rest has the rate 10 nu / half^2, that of neighbours that move against
    each other twice as much; at 2 over this rate they would be thrown back as fast as they came. `strongest`: what
    solids add to that rate, times the support radius squared [m^2/s].
    """
    rate = 20.0 * viscosity + 0.25 * strongest
    return 1.6 * half * half / rate if rate > 0 else math.inf


def capillary_limit(half: float, surface_tension: float, density: float) -> float:
    """sqrt(rho half^3 / (4 pi sigma)) [s]: the shortest capillary wave goes its length (Brackbill et al. 1992);
    surface_tension [N/m]."""
    return math.sqrt(density * half**3 / (4.0 * math.pi * surface_tension)) if surface_tension > 0 else math.inf


TENSION_STEP = {"becker2007": 0.5, "akinci2013": 1.0}
"""Share of the step that resolves capillary waves: at 0.7 of it the attraction of Becker & Teschner, which pulls
harder the nearer particles are, bursts drops of iterative solvers."""


def tension_limit(half: float, fluid: Fluid) -> float:
    """The step [s] for the surface tension and adhesion of a fluid."""
    tension = max(fluid.surface_tension, fluid.adhesion)
    return TENSION_STEP[fluid.surface_tension_model] * capillary_limit(half, tension, fluid.rest_density)


def displacement_limit(distance: float, pace: float) -> float:
    """The step [s] in which a particle at most goes the `distance` [m]: at the `pace` [m/s] that was measured for
    it."""
    return distance / pace if pace > 0 else math.inf


PRESSED = 0.4
"""Beyond this CFL number, steps of fluid under pressure do not get longer."""


def pressure_limit(half: float, cfl: float, pressure: float, density: float) -> float:
    """The step [s] in which sqrt(p / rho) goes 1.25 cfl half, but with no larger CFL number than PRESSED; pressure
    [Pa].

    Under a pressure p, particles of a lattice swing about their places, however pressures are found. The fastest wave
    that keeps densities is as short as two spacings; its frequency is 2.92 sqrt(p / rho) over the spacing
    (`tests/verification/fluid/pressure/test_pressed_lattice.py`), so that symplectic Euler is stable up to 0.69
    spacings of sqrt(p / rho) in a step. PRESSED makes that 0.5.
    """
    return 1.25 * min(cfl, PRESSED) * half * math.sqrt(density / pressure) if pressure > 0 else math.inf


LIGHT = 25.0
"""From here on pressure throws bodies back in a step of sound: half of what was found with boxes and plates."""


def light_limit(signal: float, layer_mass_ratio: float) -> float:
    """The step [s], of `signal` [s] for sound, in which pressures that follow from positions do not throw about a body
    whose layer of fluid has `layer_mass_ratio` times its mass: stiffness is the layer's, so that frequencies grow by
    the square root of the ratio."""
    return signal / math.sqrt(1.0 + layer_mass_ratio / LIGHT)
