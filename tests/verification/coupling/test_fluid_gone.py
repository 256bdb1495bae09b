"""Bodies and cloth where there is no fluid any more, or none yet: nothing acts on them but gravity."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.support.in_time import in_time
from tests.support.particles import read_frame, read_table
from tests.support.wet import G, point_masses, read_sheet

GONE = 5
"""The frame in which the last fluid goes."""
FPS = 50
WATER = {"shape": {"type": "box", "size": [0.3, 0.2, 0.3]}, "position": [0, 0.1, 0], "velocity": [0, 1.5, 0]}
ALL = {"shape": {"type": "box", "size": [9, 9, 9]}, "start": (GONE - 0.5) / FPS}
ENDS = {
    "drained": lambda scene: scene["fluid"].update(drains={"all": ALL}),
    "taken away": lambda scene: scene.update(events=[{"at": (GONE - 0.5) / FPS, "remove": ["water"]}]),
}


def scene(solver, water=None, **things):
    fluid = {"solver": solver, "particle_radius": 0.02, "bodies": {"water": WATER} if water is None else water}
    return {"fps": FPS, "fluid": fluid, **things}


def ball():
    body = {"shape": {"type": "sphere", "radius": 0.06}, "motion": "dynamic", "density": 500}
    return {"rigid": {"bodies": {"ball": body | {"position": [0.02, 0.32, 0], "angular_velocity": [0, 0, 3]}}}}


def cloth():
    sheet = {"shape": {"type": "sheet", "size": [0.2, 0.2]}, "spacing": 0.04, "mass_per_area": 0.3, "thickness": 0.006}
    precise = {"velocity_error": 1e-7, "linear_error": 1e-5, "max_newton": 50}
    return {"cloth": {"sheets": {"sheet": sheet | {"position": [0.02, 0.26, 0]}}, "implicit_euler": precise}}


def speeds(out, frames, of):
    """Upward, of the centre of mass [m/s]."""
    if of is ball:
        return read_table(out / "bodies.csv")["vy"][frames]
    mass = point_masses(read_sheet(out, 0)[0], 0.3)
    return np.array([np.average(read_sheet(out, k)[1][:, 1], weights=mass) for k in frames])


MET = pytest.mark.parametrize(
    ("solver", "of"),
    [
        ("dfsph", ball),
        ("dfsph", cloth),
        ("wcsph", ball),
        *in_time(("wcsph", cloth), ("iisph", ball), ("iisph", cloth), ("pcisph", ball)),
    ],
)
"""What is beside the water: pcisph refuses cloth."""


@pytest.mark.parametrize("end", ENDS)
@MET
def test_what_water_has_pushed_falls_freely_once_it_is_gone(simulate, solver, of, end):
    """dv = -g t. The force of the last step that had fluid went on acting: a ball rose at 8 m/s^2 for ever."""
    made = scene(solver, **of())
    ENDS[end](made)
    out = simulate(made, 12)
    assert len(read_frame(out, GONE - 1)) > 200
    assert len(read_frame(out, GONE)) == 0
    found = speeds(out, range(GONE, 13), of)
    assert speeds(out, range(GONE), of)[-1] > 0.1 - G * (GONE - 1) / FPS, "water has pushed it"
    assert found - found[0] == pytest.approx(-G * np.arange(13 - GONE) / FPS, abs=1e-6)
    with np.load(out / "state_00012.npz") as state:
        acting = [name for name in state if name.split(".")[-1] in ("fluid_force", "fluid_torque", "fluid_hold")]
        assert acting and not any(state[name].any() for name in acting)


@MET
def test_what_falls_before_there_is_water_falls_freely(simulate, solver, of):
    """A tap is opened after 60 ms; what it pours on then holds up what it meets, or pushes it down."""
    tap = {"shape": {"type": "disc", "radius": 0.06}, "speed": 1.5, "position": [0, 1, 0], "start": 0.06,
           "rotation": [{"axis": [1, 0, 0], "angle": 180}]}  # fmt: skip
    made = scene(solver, {}, **of())
    made["fluid"]["emitters"] = {"tap": tap}
    out = simulate(made, 5)
    assert len(read_frame(out, 3)) == 0 < len(read_frame(out, 5))
    assert speeds(out, range(4), of) == pytest.approx(-G * np.arange(4) / FPS, abs=1e-6)


@pytest.mark.parametrize("of", [ball, cloth])
def test_lists_of_what_is_near_are_empty_where_there_is_no_fluid(of):
    """They were not made, and read all the same where pressures follow from positions: one run in many crashed."""
    from sim.run.stepping import Run
    from sim.spec import SimulationSpec

    made = scene("wcsph", {}, **of())
    made["fluid"]["emitters"] = {"tap": {"shape": {"type": "disc", "radius": 0.1}, "speed": 1, "start": 0.06}}
    run = Run(SimulationSpec.model_validate(made), Path(), threads=1, arch="cpu", warn=lambda _: None)
    run.start()
    system = run.world.fluid.system
    if of is ball:
        assert not system.bodies.reaction.sums.ends.to_numpy().any()
    else:
        sizes = system.bodies.reaction.near.size.to_numpy()
        assert len(sizes) >= system.boundary.sheets.count > 0
        assert not sizes.any()
