"""When an event happens, seen from a run and from a segment that ends or starts at its time."""

from __future__ import annotations

import pytest

from scene.events import events_between, spec_at, spec_before
from sim.spec import SimulationSpec

TIMES = (0.1, 0.25, 0.25, 0.3)
SPEC = SimulationSpec.model_validate(
    {"events": [{"at": t, "set": {"gravity": [i, 0, 0]}} for i, t in enumerate(TIMES)]}
)


def strength(spec):
    return spec.gravity[0]


@pytest.mark.parametrize(("time", "before", "after"), [(0.1, 0, 0), (0.25, 0, 2), (0.3, 2, 3), (3 / 10, 2, 3)])
def test_the_scene_around_an_event(time, before, after):
    if time > TIMES[0]:
        assert strength(spec_before(SPEC, time)) == before
    else:
        assert spec_before(SPEC, time).gravity == SimulationSpec().gravity
    assert strength(spec_at(SPEC, time)) == after


def test_every_event_happens_in_one_frame():
    for fps in (4, 10, 12, 24, 1000):
        found = [events_between(SPEC, k / fps, (k + 1) / fps) for k in range(fps)]
        assert [len(events) for frame in found for _, events in frame] == [1, 2, 1]


def test_an_event_at_the_time_of_a_frame_belongs_to_the_next():
    assert not events_between(SPEC, 0.2, 0.25)
    assert [time for time, _ in events_between(SPEC, 0.25, 0.3)] == [0.25]


def test_a_segment_has_no_event_of_its_last_frame():
    """So that its settings, and its result, do not depend on what comes after."""
    assert len(SPEC.before(0.25).events) == 1
    assert events_between(SPEC.before(0.25), 0, 0.25) == events_between(SPEC, 0, 0.25)
