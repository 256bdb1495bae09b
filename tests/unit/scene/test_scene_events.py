"""An event that cannot be applied is refused before anything is simulated."""

from __future__ import annotations

import pytest

SET = {
    "unknown setting": ("fluid.viscosty: 1", "no setting 'fluid.viscosty'", "did you mean 'fluid.viscosity'?"),
    "unknown group": ("flud.viscosity: 1", "no setting 'flud.viscosity'", "did you mean 'fluid.viscosity'?"),
    "of another stage": ("render.samples: 1", "no setting 'render.samples'", "known here: "),
    "duration": ("duration: 1", "no setting 'duration'", "known here: "),
    "wrong unit": ("fluid.viscosity: 1 m", "number in m^2/s", "got '1 m'"),
    "wrong kind": ("gravity: 3", "gravity"),
    "part of a list": ("gravity.1: 3", "'gravity' is a list", "set the whole list, as `gravity: ["),
    "fixed": ("fluid.particle_radius: 1 mm", "fluid.particle_radius cannot change"),
    "how pressures are found": ("fluid.dfsph.iteration: jacobi", "fluid.dfsph.iteration cannot change"),
    "group of something fixed": ("fluid: {particle_radius: 1 mm}", "fluid.particle_radius cannot change"),
    "nothing for the fluid": ("fluid: null", "fluid.particle_radius cannot change"),
    "rate of frames": ("fps: 3", "fps cannot change"),
    "not a name": ('"": 1', "name of a setting"),
}


@pytest.mark.parametrize("case", SET)
def test_a_wrong_set(bench, scene, case):
    value, *words = SET[case]
    more = f"events:\n  - at: 0.1\n    set:\n      gravity: [0, 0, 0]\n      {value}"
    if value.startswith("gravity:"):
        more = more.replace("      gravity: [0, 0, 0]\n", "")
    bench.refuses(scene(more=more), "events.0.set", *words, at=f"      {value}")


EVENTS = {
    "nothing to do": ("- at: 0.1", "- at", "events.0", "needs add, remove or set"),
    "before the start": ("- {at: -1, remove: [ball]}", "- {at", "events.0.at", "at least 0 [s], got -1"),
    "no time": ("- {remove: [ball]}", "- {", "events.0.at", "missing", "add `at:` [s]"),
    "remove of nothing": ("- {at: 0.1, remove: [bal]}", "- {", "events.0.remove", "did you mean 'ball'?"),
    "remove twice": (
        "- {at: 0.1, remove: [ball]}\n  - {at: 0.2, remove: [ball]}",
        "- {at: 0.2",
        "events.1.remove",
        "at that time there is no body named 'ball'",
    ),
    "a name again": (
        "- {at: 0.1, add: {rigid: {ball: {shape: {type: sphere, radius: 0.1}}}}}",
        "- {",
        "events.0.add.rigid.ball",
        "already a body named 'ball'",
    ),
    "another motion": (
        "- {at: 0.1, set: {rigid.bodies.ball: {shape: {type: sphere, radius: 0.18}, motion: prescribed, "
        "velocity: [0, 1, 0]}}}",
        "- {",
        "events.0",
        "the motion of 'ball' cannot be changed by an event",
    ),
    "cloth": (
        "- {at: 0.1, add: {cloth: {b: {shape: {type: sheet, size: [1, 1]}, spacing: 0.1}}}, "
        "set: {fluid.viscosity_solver: implicit}}",
        "- {",
        "events.0",
        "cloth does not meet fluid whose viscosity is implicit yet",
    ),
    "no room": (
        "- {at: 0.1, add: {fluid: {b: {shape: {type: sphere, radius: 0.1}, position: [9, 9, 9]}}}}",
        "- {",
        "events.0.add.fluid.b",
        "no particle of 'b'",
    ),
    "mesh": (
        "- {at: 0.1, add: {rigid: {b: {shape: {type: mesh, file: none.ply}}}}}",
        "- {",
        "events.0.add.rigid.b.shape.file",
        "does not exist",
    ),
}


@pytest.mark.parametrize("case", EVENTS)
def test_a_wrong_event(bench, scene, case):
    event, at, *words = EVENTS[case]
    bench.refuses(scene(more=f"events:\n  {event}"), *words, at=at)


def test_events_out_of_order(bench, scene):
    more = "events:\n  - {at: 0.2, remove: [ball]}\n  - {at: 0.1, set: {gravity: [0, 0, 0]}}"
    bench.refuses(scene(more=more), "events must be sorted", "the earliest first", at="events:")


def test_a_name_can_be_removed_after_it_was_added(bench, scene):
    body = "{shape: {type: sphere, radius: 0.1}}"
    bench.accepts(
        scene(more=f"events:\n  - {{at: 0.1, add: {{rigid: {{b: {body}}}}}}}\n  - {{at: 0.2, remove: [b, ball]}}")
    )
