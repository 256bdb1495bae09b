"""What people type by mistake: the answer says what was meant, and what to write."""

from __future__ import annotations

import pytest

RADIUS = "particle_radius: 25 mm"
SIZE = "size: [0.3, 0.3, 0.3]"
BALL = "{type: sphere, radius: 0.18}"
PLACE = "position: [0, 0.2, 0]"
TANK = "{type: box, size: [0.8, 1, 0.8]}"
BODY = f"    ball:\n      shape: {BALL}\n      {PLACE}\n"
RIGID = f"rigid:\n  bodies:\n{BODY}"
DISC = "{shape: {type: disc, radius: 0.1}, position: [0, 0.9, 0]"


def viscosity(value: str) -> tuple[str, str]:
    return "fluid:", f"fluid:\n  viscosity: {value}"


def look(color: str) -> tuple[str, str]:
    return "", f"render: {{materials: {{ball: {{type: metal, color: {color}}}}}}}"


SLIPS = {
    # numbers
    "decimal comma": (RADIUS, "particle_radius: 0,025", "fluid.particle_radius", "have a point: write 0.025\n"),
    "one comma of a thousand": ("fluid:", "fluid:\n  viscosity: 1,000", "write 1.000, or 1000 if thousands"),
    "decimal comma with a unit": (RADIUS, "particle_radius: 2,5 cm", "write 2.5 cm"),
    "decimal comma in a list": ("", "gravity: [0, -9,81, 0]", "gravity", "got 4", "if 9,81 is one number, write 9.81"),
    "comma of thousands": ("fluid:", "fluid:\n  max_particles: 1,000,000", "write 1000000 without commas"),
    "dash for a minus": ("", "gravity: [0, \u20139.81, 0]", "gravity.1", "that is a dash: write -9.81"),
    "quotes of a word processor": (RADIUS, "particle_radius: “25 mm”", "write 25 mm without these quotes"),
    "inches": (RADIUS, 'particle_radius: 1"', "write 1 in"),
    "percent": (PLACE, f"{PLACE}\n      friction: 50%", "ball.friction", "write 0.5"),
    "a fraction": (PLACE, f"{PLACE}\n      friction: 1/2", "write 0.5"),
    "metres for millimetres": (RADIUS, "particle_radius: 25", "at most 10 [m]", "or '25 mm' if millimetres were"),
    "a radius larger than the body": (RADIUS, "particle_radius: 5", "drop.shape", "below 0.15 m, or 5 mm if that"),
    "a body of millimetres": (SIZE, "size: [300, 300, 300]", "216,000,000,000 particles", "are written as 300 mm"),
    # units
    "dynamic viscosity": (*viscosity("5 Pa·s"), "fluid.viscosity", "over the density: write 0.005 for a liquid"),
    "centipoise": (*viscosity("5 cP"), "write 5e-06 for a liquid of 1000 kg/m^3"),
    "grams of gravity": ("", "gravity: [0, -1 g, 0]", "gravity.1", "g is the gram: write -9.81"),
    "capital unit": (RADIUS, "particle_radius: 25 MM", "write 25 mm"),
    "hertz of a turn": (
        PLACE,
        f"{PLACE}\n      motion: prescribed\n      angular_velocity: [0, 2 Hz, 0]",
        "write it in rad/s, deg/s or rpm",
    ),
    "weight": (PLACE, f"{PLACE}\n      motion: dynamic\n      mass: 9.81 N", "write 1 kg"),
    "frames per second": ("fps: 12", "fps: 12 fps", "write 12"),
    # colours
    "colour without quotes": (
        "",
        "render:\n  materials:\n    ball:\n      type: metal\n      color: #ff0000",
        "put #ff0000 in quotes",
    ),
    "colour without quotes in brackets": (*look("#ff0000"), "a colour is taken for a comment", "put #ff0000 in quotes"),
    "colour without its sign": (*look("ff0000"), "materials.ball.color", "write '#ff0000'"),
    "colour of digits": (*look("123456"), "is not a colour, got 123456", "write '#123456'"),
    "colour by name": (*look("red"), "write '#ff0000'"),
    "colour in bytes": (*look("[255, 0, 0]"), "write '#ff0000', or numbers from 0 to 1"),
    "colour with opacity": (*look("'#ff000080'"), "write '#ff0000': a colour has no opacity"),
    "colour in other quotes": (*look("\u2018#ff0000\u2019"), "write '#ff0000', in straight quotes"),
    # YAML
    "tab before a key": (f"  {RADIUS}", f"\t{RADIUS}", "write spaces instead of tabs"),
    "tab after a key": (RADIUS, "particle_radius:\t25 mm", "write spaces instead of tabs"),
    "no colon": (RADIUS, "particle_radius 25 mm", "no ': ' between", "write `particle_radius: 25 mm`"),
    "no blank": (RADIUS, "particle_radius:25 mm", "write `particle_radius: 25 mm`"),
    "equals": (RADIUS, "particle_radius = 25 mm", "write `particle_radius: 25 mm`"),
    "key twice": ("", "fps: 24", "'fps' is given twice, first in line 2"),
    "yes for a number": ("duration: 0.5", "duration: yes", "number in s", "got 'yes'"),
    "off for a list": (TANK, TANK.replace("}", ", open: off}"), "write [] for none"),
    # lists and groups
    "one for a list": (TANK, TANK.replace("}", ", open: top}"), "containers.tank.open", "write [top]"),
    "nothing for a list": (TANK, TANK.replace("}", ", open: }"), "got nothing", "write [] for none"),
    "a name for a list": ("", "events: [{at: 0.1, remove: ball}]", "events.0.remove", "write [ball]"),
    "a place without brackets": (PLACE, "position: 0 0.2 0", "ball.position", "write [0, 0.2, 0]"),
    "a place in round brackets": (PLACE, "position: (0, 0.2, 0)", "write [0, 0.2, 0]"),
    "a place with semicolons": (PLACE, "position: [0; 0.2; 0]", "part values by commas, as [0, 0.2, 0]"),
    "a place by axes": ("", "gravity: {x: 0, y: -9.81, z: 0}", "gravity", "write [0, -9.81, 0]"),
    "a list of bodies": (BODY, f"    - {{name: ball, shape: {BALL}}}\n", "rigid.bodies", "in place of the `-`"),
    "a list of probes": ("", "probes:\n  - {type: volume}", "probes", "a name of its own in place of the `-`"),
    "events by name": (
        "",
        "events: {first: {at: 0.1, remove: [ball]}}",
        "events: must be a list, got groups by name",
        "write a `-` in place of each name",
    ),
    "an angle for a list of turns": (PLACE, f"{PLACE}\n      rotation: 45", "as [{axis: ..., angle: ...}]"),
    "a shape by its name": (BALL, "sphere", "ball.shape", "write {type: sphere, ...} with its settings"),
    "a size of pictures": ("", "render: {resolution: 640x360}", "render.resolution", "write [640, 360]"),
    "one event": ("", "events: {at: 0.1, remove: [ball]}", "events", "put it in a list, as [{at: ..., remove: ...}]"),
    # keys and words
    "capital key": ("fluid:", "Fluid:", "unknown key 'Fluid'", "did you mean 'fluid'?"),
    "capital word": ("fluid:", "fluid:\n  solver: DFSPH", "fluid.solver", "did you mean 'dfsph'?"),
    "capital type": (BALL, "{type: Sphere, radius: 0.18}", "unknown type 'Sphere'", "did you mean 'sphere'?"),
    "key in camel case": (RADIUS, "particleRadius: 25 mm", "did you mean 'particle_radius'?"),
    "key with a dash": (RADIUS, "particle-radius: 25 mm", "did you mean 'particle_radius'?"),
    "singular": ("  bodies:\n    drop", "  body:\n    drop", "fluid.body", "did you mean 'bodies'?"),
    "plural": ("rigid:", "rigids:", "unknown key 'rigids'", "did you mean 'rigid'?"),
    "word in other quotes": ("fluid:", "fluid:\n  solver: “dfsph”", "write dfsph without these quotes"),
    "name in other quotes": ("    ball:", "    “ball”:", "is not a valid name", "write ball without these quotes"),
    # levels
    "setting of the fluid at the margin": ("", "viscosity: 1e-6", "it belongs to `fluid`: indent it below that"),
    "setting of pictures at the margin": ("", "samples: 12", "it belongs to `render`"),
    "section too deep": (RIGID, "".join(f"  {line}\n" for line in RIGID.splitlines()), "fluid.rigid", "left margin"),
    "setting of a shape beside it": (
        BALL,
        "{type: sphere}\n      radius: 0.18",
        "belongs to `rigid.bodies.ball.shape`",
    ),
    "settings beside a name": (
        BODY,
        BODY.replace("      ", "    "),
        "rigid.bodies.ball: is empty, and what stands beside it, `shape:`, `position:`, are settings of it",
        "further than `ball:`",
    ),
    "one setting beside a name": (
        f"      {PLACE}",
        f"    {PLACE}",
        "bodies.position: this is a setting",
        "indent it further",
    ),
    "bodies in the place of their group": (
        RIGID,
        f"rigid:\n  ball:\n    shape: {BALL}\n",
        "rigid.ball",
        "indent `ball:` below `rigid.bodies:`",
    ),
    "a group between an event and its bodies": (
        "",
        f"events: [{{at: 0.1, add: {{rigid: {{bodies: {{b: {{shape: {BALL}}}}}}}}}}}]",
        "events.0.add.rigid.bodies: names stand directly in `events.0.add.rigid`",
        "leave `bodies:` out",
    ),
    "a sheet in the place of its group": (
        "",
        "cloth: {towel: {shape: {type: sheet, size: [1, 1]}}}",
        "cloth.towel",
        "indent `towel:` below `cloth.sheets:`",
    ),
    "a body that is named like a look": (
        "  bodies:\n    drop:\n      shape: {type: box",
        "  water:\n      shape: {type: box",
        "fluid.water",
        "indent `water:` below `bodies:` or `emitters:` or `drains:`",
    ),
    "settings in a group too many": (RADIUS, "settings: {particle_radius: 25 mm}", "leave `settings:` out"),
    "an axis by its letter": (PLACE, f"{PLACE}\n      rotation: [{{axis: y, angle: 3}}]", "write [0, 1, 0]"),
    "a name for a place": ("", "render: {camera: {position: ball, target: [0, 0, 0]}}", "write a list, as [0, 1, 0]"),
    "setting of another solver": ("fluid:", "fluid:\n  density_error: 1e-3", "`fluid.dfsph` or `fluid.iisph` or"),
    # two that exclude each other
    "mass and density": (
        PLACE,
        f"{PLACE}\n      motion: dynamic\n      mass: 3\n      density: 500",
        "rigid.bodies.ball.mass: mass and density exclude each other",
        "remove one of them",
    ),
    "speed and rate": (
        "  bodies:\n    drop",
        f"  emitters: {{tap: {DISC}, speed: 1, rate: 1 l/s}}}}\n  bodies:\n    drop",
        "exactly one of speed and rate",
        "remove one of them",
    ),
    "neither speed nor rate": (
        "  bodies:\n    drop",
        f"  emitters: {{tap: {DISC}}}}}\n  bodies:\n    drop",
        "exactly one of speed and rate",
        "add one of them",
    ),
    "least above most": (
        "fluid:",
        "fluid:\n  solver: dfsph\n  dfsph: {min_iterations: 9, max_iterations: 3}",
        "fluid.dfsph.min_iterations: min_iterations (9) must be at most max_iterations (3)",
        "lower the one, or raise the other",
    ),
    "fixed and longest step": ("", "step: {fixed: 1e-3, maximum: 1e-4}", "exclude each other", "remove one of them"),
}


@pytest.mark.parametrize("case", SLIPS)
def test_a_slip(bench, scene, case):
    old, new, *words = SLIPS[case]
    said = bench.refuses(scene(old, new) if old else scene(more=new), *words)
    assert said.count("\n  fix: ") == 1, said


def test_a_name_that_a_preset_or_an_override_misspells(bench, scene):
    more = "presets: {draft: {rigid: {bodies: {bal: {density: 3}}}}}"
    bench.refuses(scene(more=more), "rigid.bodies.bal.shape: missing", "or did you mean 'ball'?", at=more)
    override = ("--set", "rigid.bodies.bal.density=3")
    bench.refuses(scene(), "--set rigid.bodies.bal.density=3", "or did you mean 'ball'?", options=override)
    bench.refuses(scene(more="wedge: {rigid.bodies.bal.density: [1, 2]}"), "did you mean 'ball'?", at="wedge:")


def test_words_for_true_and_false(bench, scene):
    """As YAML 1.1 has them; without doubt where only these can be meant."""
    bench.accepts(scene(more="render: {denoise: yes, motion_blur: off, ground: {enabled: 'no'}}"))


UNHARMED = {
    "a description in other quotes": "description: “Splash” \u2013 water, 5 mm deep, see #ff0000",
    "a comment that looks like a colour": "render: #ff0000\n  samples: 4",
    "names like settings": "probes: {volume: {type: volume}, body: {type: force, body: ball}}",
    "a body that is named like a setting": f"presets: {{draft: {{rigid: {{bodies: {{shape: {{shape: {BALL}}}}}}}}}}}",
}


@pytest.mark.parametrize("case", UNHARMED)
def test_what_only_looks_like_a_slip(bench, scene, case):
    bench.accepts(scene(more=UNHARMED[case]))
