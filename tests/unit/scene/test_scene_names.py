"""A name that refers to something is that of something that there is, at the start or through an event."""

from __future__ import annotations

import pytest

PLACE = "position: [0, 0.2, 0]"
DYNAMIC = f"{PLACE}\n      motion: dynamic"
SHEET = "cloth: {sheets: {towel: {shape: {type: sheet, size: [1, 1]}, position: [0, 3, 0], spacing: 0.1}}}"
LATE = "{rigid: {late: {shape: {type: sphere, radius: 0.1}, position: [0, 2, 0]}}}"

UNKNOWN = {
    "pair": ("  pairs: [{between: [bal, tank]}]", "rigid.pairs.0.between: there is no body named 'bal'", "'ball'?"),
    "pair with a container": ("  pairs: [{between: [ball, tnk]}]", "no body named 'tnk'", "did you mean 'tank'?"),
    "pair with fluid": ("  pairs: [{between: [ball, drop]}]", "'drop' is a fluid body", "name two rigid bodies"),
    "pair of one": ("  pairs: [{between: [ball, ball]}]", "'ball' is named twice", "name two bodies"),
    "pair of nothing like it": ("  pairs: [{between: [ball, xyz]}]", "named 'xyz'", "known here: ball, tank"),
    "pair that an event sets": (
        "events: [{at: 0.1, set: {rigid.pairs: [{between: [bal, tank]}]}}]",
        "events.0.set.rigid.pairs: there is no body named 'bal'",
        "did you mean 'ball'?",
    ),
    "new body by set": (
        "events: [{at: 0.1, set: {rigid.bodies.bal: {shape: {type: sphere, radius: 0.1}}}}]",
        "there is no setting 'rigid.bodies.bal'",
        "did you mean 'rigid.bodies.ball'?",
    ),
    "new container by set": (
        "events: [{at: 0.1, set: {containers.sink: {type: box, size: [1, 1, 1]}}}]",
        "set can neither bring in nor take out 'sink'",
        "use add and remove",
    ),
    "other bodies by set": (
        "events: [{at: 0.1, set: {rigid: {bodies: {cube: {shape: {type: box, size: [1, 1, 1]}}}}}}]",
        "set can neither bring in nor take out 'ball'",
        "use add and remove",
    ),
    "velocity of fluid that is there": (
        "events: [{at: 0.1, set: {fluid.bodies.drop.velocity: [0, 1, 0]}}]",
        "events.0.set.fluid.bodies.drop.velocity: 'drop' is there already",
        "remove it and add another",
    ),
    "velocity of a body that moves by itself": (
        "events: [{at: 0.1, set: {rigid.bodies.ball.velocity: [0, 1, 0]}}]",
        "'ball' is there already: how it begins cannot be changed",
    ),
    "place of a sheet": (
        f"{SHEET}\nevents: [{{at: 0.1, set: {{cloth.sheets.towel.position: [0, 1, 0]}}}}]",
        "'towel' is there already",
    ),
    "force on a sheet": (
        f"{SHEET}\nprobes: {{p: {{type: force, body: towel}}}}",
        "the force on 'towel' cannot be measured",
        "known here: ball",
    ),
    "force on a body like it": ("probes: {p: {type: force, body: tall}}", "no body named 'tall'", "mean 'ball'?"),
    "vertex of a sheet like it": (
        f"{SHEET}\nprobes: {{p: {{type: vertex, sheet: towl, vertex: 0}}}}",
        "probes.p.sheet: 'towl' is no sheet of cloth",
        "did you mean 'towel'?",
    ),
    "pins of no sheet": ("probes: {p: {type: pin_force, sheet: flag}}", "'flag' is no sheet", "the scene has none"),
    "look of a fluid body": (
        "render: {materials: {drop: {type: metal}}}",
        "render.materials.drop: 'drop' is a fluid body",
        "give it as render.water",
    ),
    "look of the water": ("render: {materials: {water: {type: water}}}", "none is named 'water'", "as render.water"),
}


@pytest.mark.parametrize("case", UNKNOWN)
def test_an_unknown_name(bench, scene, case):
    line, *words = UNKNOWN[case]
    bench.refuses(scene(PLACE, DYNAMIC, more=line), *words, at=line.split("\n")[-1])


KNOWN = {
    "pair with a container": "  pairs: [{between: [ball, tank], friction: 0}]",
    "pair with what an event adds": f"  pairs: [{{between: [ball, late]}}]\nevents: [{{at: 0.1, add: {LATE}}}]",
    "pair that is set with what the same event adds": (
        f"events: [{{at: 0.1, add: {LATE}, set: {{rigid.pairs: [{{between: [ball, late]}}]}}}}]"
    ),
    "pair that is set with what comes later": (
        "events:\n  - {at: 0.1, set: {rigid.pairs: [{between: [ball, late]}]}}\n"
        f"  - {{at: 0.2, add: {LATE}}}\n  - {{at: 0.3, remove: [late]}}"
    ),
    "probe of what comes later": (
        "probes: {p: {type: force, body: late}}\nevents:\n  - {at: 0.1, set: {gravity: [0, 0, 0]}}\n"
        f"  - {{at: 0.2, add: {LATE}}}"
    ),
    "a body that is let go with a velocity": (
        "events:\n  - {at: 0.1, set: {rigid.bodies.ball.motion: static}}\n"
        "  - {at: 0.2, set: {rigid.bodies.ball.motion: dynamic, rigid.bodies.ball.velocity: [0, 1, 0]}}"
    ),
    "a container given anew": "events: [{at: 0.1, set: {containers: {tank: {type: box, size: [1, 1, 1]}}}}]",
}


@pytest.mark.parametrize("case", KNOWN)
def test_a_known_name(bench, scene, case):
    bench.accepts(scene(PLACE, DYNAMIC, more=KNOWN[case]))


def test_a_pair_with_what_is_gone_by_then(bench, scene):
    line = "- {at: 0.2, set: {rigid.pairs: [{between: [ball, late]}]}}"
    more = f"events:\n  - {{at: 0.05, add: {LATE}}}\n  - {{at: 0.1, remove: [late]}}\n  {line}"
    bench.refuses(scene(PLACE, DYNAMIC, more=more), "no body named 'late'", "known here: ball, tank", at=line)
