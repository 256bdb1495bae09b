"""Every wrong setting is refused with its file, line, field and remedy."""

from __future__ import annotations

import subprocess
import sys

import pytest

RADIUS = "particle_radius: 25 mm"
SIZE = "size: [0.3, 0.3, 0.3]"
BALL = "{type: sphere, radius: 0.18}"
PLACE = "position: [0, 0.2, 0]"

REPLACED = {
    "unknown key": (RADIUS, "particle_radus: 25 mm", "fluid.particle_radus", "did you mean 'particle_radius'?"),
    "wrong unit": (RADIUS, "particle_radius: 10 s", "fluid.particle_radius", "number in m", "got '10 s'"),
    "not a number": ("duration: 0.5", "duration: fast", "duration", "number in s", "'2 s'"),
    "negative radius": (RADIUS, "particle_radius: -0.01", "fluid.particle_radius", "at least 1e-06 [m], got -0.01"),
    "radius of zero": (RADIUS, "particle_radius: 0", "fluid.particle_radius", "at least 1e-06 [m], got 0"),
    "denormal radius": (RADIUS, "particle_radius: 1e-30", "fluid.particle_radius", "at least 1e-06 [m]"),
    "zero size": (SIZE, "size: [0.3, 0, 0.3]", "fluid.bodies.drop.shape.size.1", "at least 1e-06 [m], got 0"),
    "two sizes": (SIZE, "size: [0.3, 0.3]", "drop.shape.size: must be a list of 3 values", "got 2"),
    "four sizes": (SIZE, "size: [1, 1, 1, 1]", "drop.shape.size: must be a list of 3 values", "got 4"),
    "boolean": (RADIUS, "particle_radius: true", "fluid.particle_radius", "number in m, got true"),
    "boolean as a rate": ("fps: 12", "fps: false", "fps", "number in Hz, got false"),
    "nothing": (RADIUS, "particle_radius:", "fluid.particle_radius", "number in m, got nothing"),
    "list": (RADIUS, "particle_radius: [1]", "fluid.particle_radius", "must be a number [m]"),
    "mapping": (RADIUS, "particle_radius: {a: 1}", "fluid.particle_radius", "must be a number [m]"),
    "nan": (RADIUS, "particle_radius: .nan", "fluid.particle_radius", "finite"),
    "infinite": (SIZE, "size: [0.3, .inf, 0.3]", "drop.shape.size.1", "finite"),
    "minus infinite": (PLACE, "position: [0, -.inf, 0]", "ball.position.1", "finite"),
    "beyond floats": (RADIUS, "particle_radius: 1e400", "fluid.particle_radius", "finite"),
    "thousands of digits": (RADIUS, f"particle_radius: 1{'0' * 5000}", "fluid.particle_radius", "finite"),
    "huge": (SIZE, "size: [1e300, 1, 1]", "drop.shape.size.0", "at most 1e+06 [m], got 1e+300"),
    "far away": (PLACE, "position: [0, 1e300, 0]", "ball.position.1", "at most 1e+06 [m]"),
    "years": ("duration: 0.5", "duration: 7200", "duration", "at most 3600 [s]"),
    "on": ("duration: 0.5", "duration: on", "duration", "got 'on'"),
    "no": ("fps: 12", "fps: no", "fps", "got 'no'"),
    "sexagesimal": ("duration: 0.5", "duration: 12:30", "duration", "got '12:30'"),
    "hexadecimal": ("fps: 12", "fps: 0x10", "fps", "got '0x10'"),
    "a sum to compute": ("duration: 0.5", "duration: 9**9**9**9 s", "duration", "number in s"),
    "part of a frame": ("duration: 0.5", "duration: 0.51", "duration", "6.12 frames", "0.5833333 s"),
    "no frame": ("duration: 0.5", "duration: 1 ms", "duration", "0.012 frames", "0.0833333"),
    "quality": ("quality: draft", "quality: drft", "quality", "did you mean 'draft'?"),
    "solver": ("fluid:", "fluid:\n  solver: wcsp", "fluid.solver", "did you mean 'wcsph'?"),
    "unsorted keyframes": (
        PLACE,
        "motion: prescribed\n      keyframes: [{at: 1, position: [0, 0, 0]}, {at: 0.5, position: [0, 1, 0]}]",
        "bodies.ball",
        "the keyframe at 0.5 s follows the one at 1 s",
    ),
    "half a turn": (
        PLACE,
        "motion: prescribed\n      keyframes:\n"
        "      - {at: 0, position: [0, 0, 0]}\n"
        "      - {at: 1, position: [0, 0, 0], rotation: [{axis: [0, 1, 0], angle: 180}]}",
        "ball",
        "half a turn or more",
    ),
    "static keyframes": (
        PLACE,
        "keyframes: [{at: 0, position: [0, 0, 0]}]",
        "ball.keyframes",
        "add `motion: prescribed`",
    ),
    "static spin": (PLACE, "angular_velocity: [0, 1, 0]", "bodies.ball", "add `motion: prescribed`"),
    "start of a static body": (PLACE, "start: 1", "ball.start", "for prescribed bodies"),
    "no keyframes": (PLACE, "motion: prescribed", "ball.motion", "needs keyframes"),
    "fat torus": (
        BALL,
        "{type: torus, radius: 0.1, tube_radius: 0.2}",
        "ball.shape.tube_radius",
        "must be smaller than radius",
    ),
    "normal": (BALL, "{type: plane, normal: [0, 0, 0]}", "ball.shape.normal", "must not be zero"),
    "axis": (PLACE, "rotation: [{axis: [0, 0, 0], angle: 3}]", "ball.rotation.0.axis", "must not be zero"),
    "one rotation": (PLACE, "rotation: {axis: [0, 1, 0], angle: 3}", "ball.rotation", "[{axis: ..., angle: ...}]"),
    "unknown shape": (BALL, "{type: spere, radius: 1}", "ball.shape", "unknown type 'spere'", "did you mean 'sphere'?"),
    "shape without type": (BALL, "{radius: 1}", "ball.shape", "missing its type", "add `type:`"),
    "shape as text": (BALL, "sphere", "ball.shape", "must be a group of settings"),
    "shape without size": (BALL, "{type: sphere}", "ball.shape.radius", "missing", "add `radius:` [m]"),
    "same name elsewhere": (
        "ball:",
        "drop: # too\n",
        "rigid.bodies.drop",
        "already a body named 'drop', fluid.bodies.drop",
    ),
    "name with a blank": ("ball:", "my ball:", "rigid.bodies.my ball", "not a valid name", "letters, digits"),
    "no rigid body": (
        f"rigid:\n  bodies:\n    ball:\n      shape: {BALL}\n      {PLACE}",
        "rigid: {bodies: {}}",
        "rigid.bodies",
        "is empty",
    ),
    "no bodies": (
        f"  bodies:\n    drop:\n      shape: {{type: box, {SIZE}}}\n      position: [0, 0.62, 0]\n",
        "  bodies: {}\n",
        "fluid",
        "the fluid has no bodies",
        "add fluid.bodies",
    ),
    "inside a solid": (PLACE, "position: [0, 0.62, 0]\n      scale: 5", "fluid.bodies.drop", "no particle of 'drop'"),
    "outside the container": ("position: [0, 0.62, 0]", "position: [3, 0.62, 0]", "fluid.bodies.drop", "there is room"),
    "thinner than a particle": (SIZE, "size: [0.03, 0.01, 0.03]", "fluid.bodies.drop.shape", "no particle fits"),
    "too many": (
        RADIUS,
        f"{RADIUS}\n  max_particles: 10",
        "fluid.bodies.drop",
        "about 216 particles",
        "use a particle_radius above 0.0696 m",
    ),
    "far too many": (RADIUS, "particle_radius: 0.3 mm", "fluid.bodies.drop", "use a particle_radius above 0.000877 m"),
}

LINES = {
    "same name elsewhere": "drop: # too",
    "inside a solid": "drop:",
    "outside the container": "drop:",
    "too many": "drop:",
    "far too many": "drop:",
    "no bodies": "fluid:",
    "thinner than a particle": "shape: {type: box",
    "no keyframes": "motion:",
    "solver": "solver:",
    "unsorted keyframes": "ball:",
    "half a turn": "ball:",
    "static spin": "ball:",
}


@pytest.mark.parametrize("case", REPLACED)
def test_a_wrong_value(bench, scene, case):
    old, new, *words = REPLACED[case]
    line = "particle_radus" if case == "unknown key" else LINES.get(case, new.split("\n")[0])
    bench.refuses(scene(old, new), *words, at=line)


ADDED = {
    "gravity as a number": ("gravity: 9.81", "gravity", "must be a list [m/s^2], got 9.81", "write [0, -9.81, 0]"),
    "gravity as text": ("gravity: down", "gravity", "must be a list"),
    "gravity in two": ("gravity: [0, -9.81]", "gravity", "3 values [m/s^2], got 2"),
    "gravity as a speed": ("gravity: [0, 9 m/s, 0]", "gravity.1", "number in m/s^2", "got '9 m/s'"),
    "camera is null": ("render: {camera: }", "render.camera", "camera missing", "leave the key out"),
    "half a camera": (
        "render: {camera: {position: [0, 1, 2]}}",
        "render.camera.position",
        "belong together",
        "give both",
    ),
    "colour": ("render: {materials: {ball: {type: metal, color: blu}}}", "ball.color", "not a colour", "#3a7bd5"),
    "material of nothing": (
        "render: {materials: {bal: {type: metal}}}",
        "render.materials.bal",
        "no body named 'bal'",
        "did you mean 'ball'?",
    ),
    "unknown look": ("render: {materials: {ball: {type: metl}}}", "materials.ball", "did you mean 'metal'?"),
    "unknown set": ("render: {set: tabel}", "render.set", "must be 'none', 'studio'", "did you mean 'table'?"),
    "samples": ("render: {samples: 2.5}", "render.samples", "must be a whole number, got 2.5"),
    "denoise": ("render: {denoise: maybe}", "render.denoise", "must be true or false, got 'maybe'"),
    "description": ("description: [1]", "description", "must be text", "quotes"),
    "no step": ("step: {fixed: 1e-4, maximum: 1e-3}", "step.fixed", "exclude each other", "remove one"),
    "section is a list": ("surface: [1]", "surface", "must be a group of settings"),
    "section is nothing": ("render:", "render", "must be a group of settings, got nothing"),
    "cloth": (
        "cloth: {integrator: xpbd, sheets: {flag: {shape: {type: sheet, size: [1, 1]}, spacing: 0.1}}}",
        "cloth.integrator",
        "cloth meets fluid with implicit_euler only, not with xpbd yet",
        "implicit_euler",
    ),
    "probe of a vertex": (
        "probes: {p: {type: vertex, sheet: ball, vertex: 3}}",
        "probes.p.sheet",
        "'ball' is no sheet of cloth",
    ),
    "probe of no body": ("probes: {p: {type: force, body: bal}}", "probes.p.body", "did you mean 'ball'?"),
    "probe of the fluid": ("probes: {p: {type: force, body: drop}}", "probes.p.body", "no rigid body with a surface"),
    "unknown probe": ("probes: {p: {type: forc, body: ball}}", "probes.p", "did you mean 'force'?"),
    "preset": ("presets: {drft: {fps: 24}}", "presets.drft", "must be 'draft'", "did you mean 'draft'?"),
    "preset is a number": ("presets: {draft: 3}", "presets.draft", "must be a group of settings"),
    "film": ("film: {copy_to: film.avi}", "film.copy_to", "must end in .mp4"),
    "copy to an absolute path": ("film: {copy_to: /tmp/film.mp4}", "film.copy_to", "outside of the project"),
    "copy to a path above": ("film: {copy_to: ../film.mp4}", "film.copy_to", "outside of the project", "gallery/"),
    "copy among the results": ("film: {copy_to: renders/film.mp4}", "film.copy_to", "the workflow manages"),
    "copy to no path": ('film: {copy_to: "a\\0b.mp4"}', "film.copy_to", "control character"),
    "copy to a long path": (f"film: {{copy_to: {'a' * 5000}.mp4}}", "film.copy_to", "not a path"),
}


@pytest.mark.parametrize("case", ADDED)
def test_a_wrong_section(bench, scene, case):
    line, *words = ADDED[case]
    bench.refuses(scene(more=line), *words, at=line)


def test_a_format_without_transparency(bench, scene):
    more = "render: {background: {type: transparent}}\nfilm: {also: [webp, gif]}"
    bench.refuses(scene(more=more), "film.also.1: 'gif' cannot keep", "take prores, vp9 or webp", at="film: {also")


NOT_BY_JACOBI = {
    "cloth": "cloth: {sheets: {flag: {shape: {type: sheet, size: [1, 1]}, position: [0, 2, 0], spacing: 0.1}}}",
    "bodies that obey forces": "events: [{at: 0.1, add: {rigid: {cork: {shape: {type: sphere, radius: 0.1}, "
    "position: [0, 2, 0], motion: dynamic}}}}]",
}


@pytest.mark.parametrize("what", NOT_BY_JACOBI)
def test_what_jacobi_iterations_do_not_move(bench, scene, what):
    text = scene(RADIUS, f"{RADIUS}\n  solver: dfsph\n  dfsph: {{iteration: jacobi}}", more=NOT_BY_JACOBI[what])
    told = f"the Jacobi iterations of dfsph do not move {what} yet"
    bench.refuses(text, "fluid.dfsph.iteration", told, "iteration: conjugate_gradients", at="  dfsph:")


def test_a_copy_through_a_link_that_leads_out(bench, scene, tmp_path, tmp_path_factory):
    (tmp_path / "gallery").symlink_to(tmp_path_factory.mktemp("elsewhere"))
    bench.refuses(scene(more="film: {copy_to: gallery/film.mp4}"), "film.copy_to", "outside", at="copy_to")


def test_a_key_given_twice_names_both_lines(bench, scene):
    text = scene(more="fps: 24")
    bench.refuses(text, "fps: 'fps' is given twice, first in line 2", "a name of its own", at="fps: 24")
    twice = scene("    ball:\n", "    ball:\n      shape: {type: sphere, radius: 1}\n    ball: # again\n")
    bench.refuses(twice, "rigid.bodies.ball", "given twice, first in line 14", at="# again")


def test_all_problems_are_told_at_once(bench, scene):
    said = bench.refuses(scene("fps: 12", "fps: -1", more="gravity: 3\nfilms: {}"), "fps", "gravity", "films")
    assert said.count("fix:") == 3


OVERRIDES = {
    "fluid.viscosity": "expected path.to.key=value",
    "=3": "expected path.to.key=value",
    "fluid..viscosity=3": "expected path.to.key=value",
    "fluid.viscosity=": "got nothing",
    "fluid.viscosity=fast": "number in m^2/s",
    "fluid.viscosty=3": "did you mean 'viscosity'?",
    "gravity.1=3": "must be a list",
    "fluid.bodies.drop.position.9=3": "the list has the entries 0 to 2",
    "fluid.bodies.drop.position.x=3": "the list has the entries 0 to 2",
    "fps.x=3": "fps holds one value",
    "gravity=[0,0": "quote lists for the shell",
    "fluid.viscosity=!!python/name:os.system": "no value of a setting",
    "quality=final": "use --quality",
    "presets.draft.fps=3": "use --quality",
    "film.copy_to=../film.mp4": "outside of the project",
}


@pytest.mark.parametrize("override", OVERRIDES)
def test_a_wrong_override(bench, scene, override):
    bench.refuses(scene(), f"--set {override}: ", OVERRIDES[override], options=("--set", override))


def test_an_unknown_quality(bench, scene):
    bench.write(scene())
    status, said = bench.check("--quality", "drft")
    assert status == 2
    assert "no preset 'drft'" in said and "did you mean 'draft'?" in said


def test_a_missing_file_brings_the_close_name(bench, scene):
    bench.write(scene())
    status, said = bench.check(path=bench.folder / "bed.yaml")
    assert status == 2
    assert "no such scene file" in said and "did you mean 'bad.yaml'?" in said
    status, said = bench.check(path=bench.folder / "none" / "bed.yaml")
    assert status == 2 and "scenes/bunny.yaml" in said


@pytest.mark.parametrize("text", ["duration: fast\n", "a: [1\n", ""])
def test_the_process_exits_with_2_and_no_traceback(bench, project, text):
    command = [sys.executable, "-m", "sim", "check", str(bench.write(text))]
    ran = subprocess.run(command, cwd=project, capture_output=True, text=True, check=False)
    assert ran.returncode == 2
    assert str(bench.path) in ran.stderr and "fix:" in ran.stderr and "Traceback" not in ran.stderr
