"""What a user would get wrong with emitters and drains is refused, with field and remedy; what is right is not."""

from __future__ import annotations

import pytest

TAP = "tap: {shape: {type: disc, radius: 0.08}, position: [0.2, 0.9, 0.2], rotation: [{axis: [1, 0, 0], angle: 180}], "
SPEED = TAP + "speed: 1}"
SINK = "sink: {shape: {type: box, size: [0.8, 0.1, 0.8]}, position: [0, 0.05, 0]}"


def emitters(line, more=""):
    return f"fluid:\n  emitters:\n    {line}\n{more}"


def drains(line):
    return f"fluid:\n  drains:\n    {line}\n"


def test_a_scene_with_both_says_what_comes(bench, scene):
    said = bench.accepts(scene("fluid:\n", emitters(SPEED, f"  drains:\n    {SINK}\n")))
    # 9 particles of 0.05 m a layer.
    assert "tap: 0.0225 m^3/s at 1 m/s, 180 particles a second" in said


def test_a_scene_may_start_without_fluid(bench, scene):
    body = "  bodies:\n    drop:\n      shape: {type: box, size: [0.3, 0.3, 0.3]}\n      position: [0, 0.62, 0]\n"
    said = bench.accepts(scene(body, "").replace("fluid:\n", emitters(SPEED)))
    assert "0 fluid particles" in said
    with_event = f"events:\n  - {{at: 0.1, add: {{emitters: {{{SPEED}}}}}}}"
    bench.accepts(scene(body, "", more=with_event))


EMITTERS = {
    "neither": (TAP.rstrip(", ") + "}", "fluid.emitters.tap", "exactly one of speed and rate"),
    "both": (TAP + "speed: 1, rate: 1e-3}", "fluid.emitters.tap", "exactly one of speed and rate"),
    "no speed": (TAP + "speed: 0}", "fluid.emitters.tap.speed", "greater than 0"),
    "backward": (TAP + "speed: -1}", "fluid.emitters.tap.speed", "greater than 0"),
    "rate in other units": (TAP + "rate: 1 m/s}", "fluid.emitters.tap.rate", "number in m^3/s"),
    "stop before start": (TAP + "speed: 1, start: 2, stop: 1}", "fluid.emitters.tap.stop", "later than start"),
    "small": (SPEED.replace("0.08", "0.02"), "fluid.emitters.tap.shape", "smaller than one particle"),
    "in the ball": (SPEED.replace("[0.2, 0.9, 0.2]", "[0, 0.25, 0]"), "fluid.emitters.tap", "'ball' is in the way"),
    "at the ball": (SPEED.replace("[0.2, 0.9, 0.2]", "[0, 0.45, 0]"), "fluid.emitters.tap", "'ball' is in the way"),
    "in the wall": (SPEED.replace("0.2, 0.9", "0.35, 0.9"), "fluid.emitters.tap", "'tank' is in the way"),
    "into the floor": (SPEED.replace("0.9", "0.09"), "fluid.emitters.tap", "'tank' is in the way", "point into free"),
    "a volume": (SPEED.replace("disc", "sphere"), "fluid.emitters.tap.shape", "unknown type 'sphere'"),
    "no mesh": (
        SPEED.replace("{type: disc, radius: 0.08}", "{type: mesh, file: tap.stl, face: 0}"),
        "fluid.emitters.tap.shape.file",
        "does not exist",
    ),
    "no face": (
        SPEED.replace("{type: disc, radius: 0.08}", "{type: mesh, file: tap.stl}"),
        "fluid.emitters.tap.shape.face",
        "missing",
    ),
    "a name again": (SPEED.replace("tap:", "ball:"), "rigid.bodies.ball", "already a body named 'ball'"),
}


@pytest.mark.parametrize("case", EMITTERS)
def test_a_wrong_emitter(bench, scene, case):
    line, *words = EMITTERS[case]
    bench.refuses(scene("fluid:\n", emitters(line)), *words)


DRAINS = {
    "thin": (SINK.replace("0.1,", "0.04,"), "fluid.drains.sink.shape", "0.04 m thick", "make it thicker"),
    "thin and turned": (
        SINK.replace("0.1,", "0.04,").replace("position", "rotation: [{axis: [0, 0, 1], angle: 45}], position"),
        "fluid.drains.sink.shape",
        "0.04 m thick",
    ),
    "a surface": (SINK.replace("box", "sheet"), "fluid.drains.sink.shape", "unknown type 'sheet'"),
    "no mesh": (
        "sink: {shape: {type: mesh, file: sink.stl}}",
        "fluid.drains.sink.shape.file",
        "does not exist",
    ),
    "with a speed": (SINK.replace("}, pos", "}, speed: 1, pos"), "fluid.drains.sink.speed", "unknown"),
}


@pytest.mark.parametrize("case", DRAINS)
def test_a_wrong_drain(bench, scene, case):
    line, *words = DRAINS[case]
    bench.refuses(scene("fluid:\n", drains(line)), *words)


EVENTS = {
    "remove": "- {at: 0.1, remove: [tap]}",
    "speed": "- {at: 0.1, set: {fluid.emitters.tap.speed: 2}}",
    "stop": "- {at: 0.1, set: {fluid.emitters.tap.stop: 0.2 s}}",
    "add": f"- {{at: 0.1, add: {{emitters: {{{SPEED.replace('tap', 'tup')}}}, drains: {{{SINK}}}}}}}",
}


@pytest.mark.parametrize("case", EVENTS)
def test_events_change_them(bench, scene, case):
    bench.accepts(scene("fluid:\n", emitters(SPEED), more=f"events:\n  {EVENTS[case]}"))


WRONG_EVENTS = {
    "both": ("- {at: 0.1, set: {fluid.emitters.tap.rate: 1e-3}}", "events.0", "exactly one of speed and rate"),
    "name": ("- {at: 0.1, set: {fluid.emitters.tup.speed: 2}}", "no setting 'fluid.emitters.tup.speed'", "rs.tap.sp"),
    "gone": ("- {at: 0.1, remove: [tup]}", "events.0.remove", "did you mean 'tap'?"),
    "into a wall": (
        f"- {{at: 0.1, add: {{emitters: {{{SPEED.replace('tap', 'tup').replace('0.9', '0.05')}}}}}}}",
        "events.0.add.emitters.tup",
        "'tank' is in the way",
    ),
    "thin": (
        f"- {{at: 0.1, add: {{drains: {{{SINK.replace('0.1,', '0.04,')}}}}}}}",
        "events.0.add.drains.sink",
        "0.04 m thick",
    ),
}


@pytest.mark.parametrize("case", WRONG_EVENTS)
def test_a_wrong_change(bench, scene, case):
    event, *words = WRONG_EVENTS[case]
    bench.refuses(scene("fluid:\n", emitters(SPEED), more=f"events:\n  {event}"), *words)


def test_they_need_a_fluid(bench, scene):
    plain = "duration: 0.5\nfps: 12\nrigid: {bodies: {ball: {shape: {type: sphere, radius: 1}}}}\n"
    for group, what in (("emitters", SPEED), ("drains", SINK)):
        event = f"events:\n  - {{at: 0.1, add: {{{group}: {{{what}}}}}}}\n"
        bench.refuses(plain + event, f"events.0.add.{group}", "a scene that has a fluid section")
