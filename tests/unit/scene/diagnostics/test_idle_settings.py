"""What a scene gives and nothing depends on is told: a value that changes nothing was meant to change something."""

from __future__ import annotations

import pytest

from scene.diagnostics import idle
from scene.load import load

SCENE = """\
duration: 1
containers: {tank: {type: box, size: [1, 1, 1]}}
fluid: {particle_radius: 25 mm, bodies: {drop: {shape: {type: sphere, radius: 0.1}, position: [0, 0.5, 0]}}}
rigid: {bodies: {ball: {shape: {type: sphere, radius: 0.1}}}}
cloth: {sheets: {towel: {shape: {type: sheet, size: [1, 1]}}}}
"""
FALLS = "{shape: {type: sphere, radius: 0.1}, motion: dynamic, density: 300}"
TURNS = "{shape: {type: sphere, radius: 0.1}, motion: prescribed, angular_velocity: [0, 1, 0], mass: 3}"
IDLE = {
    "fluid.wcsph={speed_of_sound: 30}": ("fluid.solver=dfsph", "solver: wcsph, and the scene has solver: dfsph"),
    "fluid.dfsph={density_error: 0.001}": ("fluid.solver=wcsph", "the scene has solver: wcsph"),
    "fluid.implicit_viscosity={error: 0.01}": ("fluid.viscosity_solver=explicit", "make it auto or implicit"),
    "fluid.surface_tension_model=akinci2013": ("fluid.surface_tension=0", "give surface_tension"),
    "cloth.xpbd={substeps: 20}": ("cloth.integrator=implicit_euler", "change one of the two"),
    "rigid.bodies.ball.density=300": ("rigid.bodies.ball.motion=static", "add `motion: dynamic`"),
    f"rigid.bodies.wheel={TURNS}": ("fps=24", "a body of motion: prescribed obeys no forces"),
    "render.lights.sun.azimuth=30": ("render.lights.sun.strength=0", "raise strength"),
    "render.lights.environment.rotation=30": ("render.lights.environment.strength=0", "raise strength"),
    "render.ground.height=1": ("render.ground.enabled=false", "no ground is drawn"),
    "render.shutter=0.7": ("render.motion_blur=false", "switch it on"),
    "render.contrast=low": ("render.view_transform=Standard", "take AgX or Filmic"),
    "surface.layers.reach=2": ("surface.layers.enabled=false", "layers are off"),
    "surface.smoothing.weighted=false": ("surface.smoothing.iterations=0", "raise iterations"),
    "surface.cleanup.snap_distance=0.2": ("surface.cleanup.enabled=false", "cleanup is off"),
}
COUNTS = {
    "fluid.dfsph={density_error: 0.001}": "fluid.solver=dfsph",
    "fluid.implicit_viscosity={error: 0.01}": "fluid.viscosity_solver=auto",
    "fluid.surface_tension_model=akinci2013": "fluid.surface_tension=0.07",
    f"rigid.bodies.ball={FALLS}": "fps=24",
    "render.shutter=0.7": "render.motion_blur=true",
}
VARIED = {
    "a preset": "presets: {final: {fluid: {surface_tension: 0.07}}}",
    "the wedge": "wedge: {fluid.surface_tension: [0, 0.07]}",
    "an event": "events: [{at: 0.5, set: {fluid.surface_tension: 0.07}}]",
}


def _told(folder, *overrides, more=""):
    path = folder / "scene.yaml"
    path.write_text(SCENE + more)
    return list(idle.cautions(load(path, quality="draft", overrides=overrides)))


@pytest.mark.parametrize("setting", IDLE)
def test_a_setting_that_changes_nothing_is_told(tmp_path, setting):
    other, words = IDLE[setting]
    told = _told(tmp_path, other, setting)
    assert len(told) == 1 and words in told[0].text
    assert ".".join(told[0].location).startswith(setting.partition("=")[0])


@pytest.mark.parametrize("setting", COUNTS)
def test_a_setting_that_counts_is_not(tmp_path, setting):
    assert not _told(tmp_path, COUNTS[setting], setting)


@pytest.mark.parametrize("by", VARIED)
def test_a_setting_that_counts_in_another_film_or_later_is_not(tmp_path, by):
    given = "fluid.surface_tension_model=akinci2013"
    assert not _told(tmp_path, given, more=VARIED[by])
    assert _told(tmp_path, given)


def test_what_an_event_brings_in(tmp_path):
    late = "events: [{at: 0.5, add: {rigid: {late: {shape: {type: sphere, radius: 0.1}, density: 300}}}}]"
    assert [caution.location for caution in _told(tmp_path, more=late)] == [
        ("events", 0, "add", "rigid", "late", "density")
    ]


def test_check_names_the_line(bench, scene):
    said = bench.accepts(scene(more="surface: {cleanup: {enabled: false, decimate_barnacles: true}}"))
    assert "warning: line 17: surface.cleanup.decimate_barnacles: changes nothing: cleanup is off" in said


def test_damping_that_jacobi_iterations_do_not_have(bench, scene):
    radius = "particle_radius: 25 mm"
    fluid = f"{radius}\n  solver: dfsph\n  dfsph: {{iteration: jacobi, hyperviscosity: 2}}"
    said = bench.accepts(scene(radius, fluid))
    assert "fluid.dfsph.hyperviscosity: changes nothing: iteration: jacobi damps nothing" in said


def test_a_run_tells_as_it_begins(bench, scene, capsys):
    from sim.__main__ import main

    path = bench.write(scene(more="surface: {cleanup: {enabled: false, decimate_barnacles: true}}"))
    command = ["run", str(path), "--out", str(path.parent / "out"), "--arch", "cpu", "--threads", "1"]
    assert main([*command, "--frames", "0:0"]) == 0
    assert "warning: line 17: surface.cleanup.decimate_barnacles" in capsys.readouterr().err
