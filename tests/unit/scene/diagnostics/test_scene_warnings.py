"""`check` tells what a run would warn of or refuse as it begins, and what a film would not show."""

from __future__ import annotations

import pytest

PLACE = "position: [0, 0.2, 0]"
WATER = "position: [0, 0.62, 0]"
TAP = "{shape: {type: disc, radius: 0.1}, position: [0, 0.9, 0], rotation: [{axis: [1, 0, 0], angle: 180}], speed: 1"
LATE = "{rigid: {late: {shape: {type: sphere, radius: 0.1}, position: [0, 2, 0]}}}"
BLOCK = "rigid: {bodies: {block: {shape: {type: box, size: [0.3, 0.3, 0.3]}}}}"
SHEET = "cloth: {sheets: {towel: {shape: {type: sheet, size: [1, 1]}, spacing: 0.1}}}"

ADDED = {
    "event after the end": (
        "events: [{at: 5, remove: [ball]}]",
        "events.0: happens at 5 s, and the film ends at 0.5 s: raise duration",
    ),
    "event at the end": ("events: [{at: 0.5, remove: [ball]}]", "events.0: happens at 0.5 s"),
    "probe of what comes after the end": (
        f"events: [{{at: 3, add: {LATE}}}]\nprobes: {{p: {{type: force, body: late}}}}",
        "probes.p.body: 'late' is not there before the film ends",
    ),
    "height behind a wall": (
        "probes: {p: {type: water_height, x: 9}}",
        "probes.p.x: 'p' is 8.6 m behind a wall of 'tank'",
    ),
    "pressure in the air": ("probes: {p: {type: pressure, at: [0, 90, 0]}}", "probes.p.at: 'p' is 89.2 m from all"),
    "pressure under the floor": ("probes: {p: {type: pressure, at: [0, -1, 0]}}", "1 m behind a wall of 'tank'"),
    "pressure in a body": ("probes: {p: {type: pressure, at: [0, 0.2, 0]}}", "'p' is 0.18 m inside 'ball'"),
    "region beside a body": (
        "probes: {p: {type: force, body: ball, region: {low: [1, 1, 1], high: [2, 2, 2]}}}",
        "probes.p.region: 'p' looks at a region in which 'ball' never is",
    ),
    "hem of a body": (
        "render: {materials: {ball: {type: cloth, hem: 0.01}}}",
        "render.materials.ball.hem: changes nothing: only a sheet of cloth shows it",
    ),
    "back of the ground": (
        "render: {ground: {material: {type: cloth, back: '#ff0000'}}}",
        "render.ground.material.back: changes nothing: only a sheet of cloth shows it",
    ),
    "rounded edges of a tank": (
        "render: {materials: {tank: {type: glass, rounding: 0.01}}}",
        "render.materials.tank.rounding: changes nothing: only a rigid body shows it",
    ),
    "transparent film": (
        "render: {background: {type: transparent}}",
        "render.background.type: the MP4 cannot keep it: add one of prores, vp9, webp to film.also",
    ),
    "caustics of nothing": (
        "render: {caustics: true, water: {type: matte}}",
        "render.caustics: changes nothing: no look is of water or glass",
    ),
    "caustics without a lamp": (
        "render: {caustics: true, lights: {sun: {strength: 0}}}",
        "render.caustics: changes nothing: light of the environment alone",
    ),
    "camera in a body": (
        "render: {camera: {position: [0, 0.2, 0.1], target: [0, 0, 0]}}",
        "render.camera.position: the camera begins inside 'ball'",
    ),
    "camera in the water": (
        "render: {camera: {position: [0, 0.62, 0.1], target: [0, 0, 0]}}",
        "render.camera.position: the camera begins under water",
    ),
    "camera that moves in the water": (
        "render: {camera: {keyframes: [{at: 0, position: [0, 0.6, 0], target: [0, 0, 0]}, "
        "{at: 1, position: [0, 2, 2], target: [0, 0, 0]}]}}",
        "render.camera.keyframes.0.position: the camera begins under water",
    ),
    "camera under the ground": (
        "render: {camera: {position: [0, -1, 3], target: [0, 0, 0]}}",
        "the camera begins below the ground",
    ),
}


@pytest.mark.parametrize("case", ADDED)
def test_a_section_that_is_not_as_it_was_meant(bench, scene, case):
    line, words = ADDED[case]
    said = bench.accepts(scene(more=line))
    assert "\n  warning: line " in said and words in said, said


def test_a_blender_that_is_not_there(bench, scene, monkeypatch):
    monkeypatch.setenv("TIDEMILL_BLENDER", "/none/blender")
    said = bench.accepts(scene())
    assert "warning: there is no Blender at /none/blender on this machine, which TIDEMILL_BLENDER names" in said


IN_THE_BALL = LATE.replace("[0, 2, 0]", "[0, 0.3, 0], motion: dynamic")
THIN = "{fluid: {film: {shape: {type: box, size: [0.3, 0.01, 0.3]}, position: [0, 0.9, 0]}}}"
COMING = {
    "body in another": (IN_THE_BALL, "events.0.add: 'late' and 'ball' begin 180 mm or more inside each other"),
    "sheet through a body": (
        "{cloth: {towel: {shape: {type: sheet, size: [0.5, 0.5]}, position: [0, 0.2, 0], spacing: 0.1}}}",
        "events.0.add.cloth.towel: the sheet 'towel' is placed through 'ball'",
    ),
    "thin fluid": (THIN, "events.0.add: 'film' is 10 mm thick"),
}


@pytest.mark.parametrize("case", COMING)
def test_what_an_event_brings_in_is_not_as_it_was_meant(bench, scene, case):
    addition, words = COMING[case]
    said = bench.accepts(scene(more=f"events: [{{at: 0.1, add: {addition}}}]"))
    assert "\n  warning: line 17: " in said and words in said, said


REPLACED = {
    "bodies in each other": (
        PLACE,
        f"{PLACE}\n      motion: dynamic\n    box:\n      shape: {{type: box, size: [0.1, 0.1, 0.1]}}\n      {PLACE}",
        "rigid.bodies.ball: 'ball' and 'box' begin",
    ),
    "a body in a wall": (PLACE, "position: [0.3, 0.2, 0]\n      motion: dynamic", "'ball' and 'tank' begin 80 mm or"),
    "an emitter that begins after the end": (
        "  bodies:\n    drop",
        f"  emitters: {{tap: {TAP}, start: 7}}}}\n  bodies:\n    drop",
        "fluid.emitters.tap.start: begins at 7 s",
    ),
    "a motion that begins after the end": (
        PLACE,
        f"{PLACE}\n      motion: prescribed\n      velocity: [0, 1, 0]\n      start: 2",
        "rigid.bodies.ball.start: begins at 2 s",
    ),
    "fluid for which there is no room": (WATER, "position: [0.36, 0.85, 0.36]", "'drop' has room for "),
}


@pytest.mark.parametrize("case", REPLACED)
def test_a_value_that_is_not_as_it_was_meant(bench, scene, case):
    old, new, words = REPLACED[case]
    said = bench.accepts(scene(old, new))
    assert "\n  warning: " in said and words in said, said


def test_a_sheet_that_is_placed_through_a_body(bench):
    said = bench.accepts(f"duration: 0.5\nfps: 12\n{SHEET}\n{BLOCK}")
    assert "warning: line 3: cloth.sheets.towel: the sheet 'towel' is placed through 'block'" in said


NONE = {
    "as it is": "",
    "an event in time": "events: [{at: 0.4, remove: [ball]}]",
    "probes that see": "probes: {a: {type: pressure, at: [0, 0.1, 0.3]}, b: {type: water_height, x: 0.2}, "
    "c: {type: force, body: ball, region: {low: [0, 0, 0], high: [1, 1, 1]}}}",
    "a probe inside a body that is taken out": (
        "probes: {p: {type: pressure, at: [0, 0.2, 0]}}\nevents: [{at: 0.2, remove: [ball]}]"
    ),
    "a camera outside": "render: {camera: {position: [0, 1, 2], target: [0, 0, 0]}}",
    "a camera below, and no ground": (
        "render: {ground: {enabled: false}, camera: {position: [0, -1, 3], target: [0, 0, 0]}}"
    ),
}


@pytest.mark.parametrize("case", NONE)
def test_nothing_is_said_of_what_is_right(bench, scene, case):
    assert "warning" not in bench.accepts(scene(more=NONE[case]))


def test_the_ground_is_where_things_fall_to(bench):
    camera = "render: {camera: {position: [0, 1, 3], target: [0, 0, 0]}}"
    towel = SHEET.replace("spacing: 0.1", "position: [0, 3, 0], spacing: 0.1")
    assert "warning" not in bench.accepts(f"duration: 0.5\nfps: 12\n{towel}\n{camera}")
    floor = "rigid: {bodies: {floor: {shape: {type: plane}, position: [0, 2, 0]}}}"
    assert "below the ground at y = 2 m" in bench.accepts(f"duration: 0.5\nfps: 12\n{towel}\n{floor}\n{camera}")


SCENES = ("tiny/still", "tiny/splash", "tiny/tap", "tiny/drain", "tiny/foam", "stack", "fold", "drape", "everything")


@pytest.mark.parametrize("name", SCENES)
def test_nothing_is_said_of_scenes_of_the_project(bench, project, name):
    status, said = bench.check("--quality", "draft", path=project / "scenes" / f"{name}.yaml")
    assert status == 0 and "warning" not in said, said


def test_a_pin_of_a_sheet_that_an_event_brings_in(bench, scene):
    pins = "[{at: left, keyframes: [{at: 0, offset: [0, 1, 0]}]}]"
    towel = f"{{shape: {{type: sheet, size: [0.5, 0.5]}}, position: [0, 3, 0], spacing: 0.1, pins: {pins}}}"
    more = f"events: [{{at: 0.1, add: {{cloth: {{towel: {towel}}}}}}}]"
    bench.refuses(scene(more=more), "events.0.add.cloth.towel.pins: a pin would take points 1 m elsewhere", at=more)


def test_a_panorama_that_is_none(bench, scene):
    """In the format of Ward's Radiance, 2 by 2 pixels of four bytes; cut off, and with nothing but its first line."""
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n"
    light = "render: {lights: {environment: {file: sky.hdr}}}"
    (bench.folder / "sky.hdr").write_bytes(head + bytes((128, 128, 128, 129)) * 4)
    bench.accepts(scene(more=light))
    for broken in (head + bytes((128, 128, 128, 129)), head[:11], b""):
        (bench.folder / "sky.hdr").write_bytes(broken)
        bench.refuses(scene(more=light), "render.lights.environment.file: Blender cannot read 'sky.hdr'", at=light)


TWO = "rigid: {bodies: {floor: {shape: {type: plane}}, ball: {shape: {type: sphere, radius: 0.2}, motion: dynamic, "
REFUSED = {
    "step of sound": ("step: {fixed: 0.05}", "step.fixed: a fixed step of 0.05 s is beyond the stability limit"),
    "step of a body": (
        f"duration: 0.5\nfps: 12\nstep: {{fixed: 0.05}}\n{TWO}position: [0, 0.3, 0]}}}}}}",
        "step.fixed: a fixed step of 0.05 s is beyond the stability limit of 0.01 s",
    ),
    "step of cloth": (
        f"duration: 0.5\nfps: 12\nstep: {{fixed: 0.02}}\n{SHEET}",
        "step.fixed: a fixed step of 0.02 s is longer than those of cloth may be",
    ),
    "step of stiff cloth": (
        f"duration: 0.5\nfps: 12\n{SHEET}".replace(
            "cloth: {", "cloth: {integrator: symplectic_euler, max_step: 0.05, "
        ).replace("spacing: 0.1", "spacing: 0.1, stretch_stiffness: 1e11"),
        "cloth.integrator: the stiffness of the cloth allows explicit steps of ",
        "use implicit_euler",
    ),
    "pin that begins elsewhere": (
        f"duration: 0.5\nfps: 12\n{SHEET}".replace(
            "spacing: 0.1", "spacing: 0.1, pins: [{at: left, keyframes: [{at: 0, offset: [0, 1, 0]}]}]"
        ),
        "cloth.sheets.towel.pins: a pin would take points 1 m elsewhere at once at 0 s",
    ),
    "spin": (
        f"duration: 0.5\nfps: 12\n{TWO}position: [0, 0.3, 0], angular_velocity: [0, 1e6, 0]}}}}}}",
        "the spin of a body allows steps of 1e-07 s only",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_step_that_a_run_would_refuse(bench, scene, case):
    text, *words = REFUSED[case]
    bench.refuses(text if text.startswith("duration") else scene(more=text), *words)


SOUND = {
    "slow": ("speed_of_sound: 1", "fluid.wcsph.speed_of_sound: the fluid begins at 3 m/s, faster than sound (1 m/s)"),
    "fast": ("speed_of_sound: 1e6", "sound of 1e+06 m/s allows steps of 2e-08 s only"),
}


@pytest.mark.parametrize("case", SOUND)
def test_a_speed_of_sound_that_a_run_would_refuse(bench, scene, case):
    sound, words = SOUND[case]
    moving = scene(WATER, f"{WATER}\n      velocity: [0, -3, 0]").replace("fluid:\n", f"fluid:\n  wcsph: {{{sound}}}\n")
    bench.refuses(moving, words)
