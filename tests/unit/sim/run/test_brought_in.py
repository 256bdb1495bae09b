"""What comes in while a run steps is an event as any other: known from the start, it gives the same bytes."""

from __future__ import annotations

import pytest

from sim.run.output import Output
from sim.run.stepping import Run
from sim.spec import Event, SimulationSpec
from tests.support.floating import BOX, box_in_pool
from tests.support.in_time import in_time

CHANGES = {
    0: {"set": {"gravity": [0, -5, 0]}},
    2: {"set": {"fluid.viscosity": 1e-3}},
    3: {"add": {"rigid": {"late": {"shape": BOX, "position": [0.1, 0.4, 0.1], "density": 300, "motion": "dynamic"}}}},
    4: {"set": {"rigid.bodies.late.force": [0.5, 0, 0]}},
    11: {"remove": ["body"]},
    12: {"set": {"gravity": [1, -9.81, 0]}},
    14: {"set": {"gravity": [0, -9.81, 0]}},
    15: {"set": {"step.cfl": 0.2}},
}
LAST = 3


def live(spec: SimulationSpec, folder) -> Run:
    """A run to which the changes come, each before the step of its number."""
    run = Run(spec, folder, threads=1, arch="cpu", warn=lambda text: None)
    run.start()
    coming = dict(CHANGES)

    def before_step() -> None:
        for step in [step for step in coming if step <= run.clock.step]:
            data = coming.pop(step)
            run.bring_in(Event.model_validate({"at": run.earliest(), **data}))

    run.before_step = before_step
    output = Output(folder, spec)
    run.frames(LAST, output, write_first=True, done=lambda: None)
    output.close()
    assert not coming
    return run


@pytest.mark.parametrize(("solver", "fps"), [("dfsph", 50), *in_time(("dfsph", 20), ("wcsph", 50))])
def test_events_that_come_in_give_the_bytes_of_those_known_from_the_start(simulate, tmp_path, solver, fps):
    data = box_in_pool(solver, 0.4, fps=fps)
    folder = tmp_path / "live"
    folder.mkdir()
    run = live(SimulationSpec.model_validate(data), folder)
    assert len(run.spec.events) == len(CHANGES)
    assert len({event.at for event in run.spec.events}) > 2, "all at frames: nothing came in between two steps"
    again = simulate(run.spec.model_dump(mode="json", exclude_none=True), LAST, "again", threads=1)
    names = [f"fluid_{frame:05d}.ply" for frame in range(LAST + 1)] + ["bodies.csv"]
    assert [name for name in names if (folder / name).read_bytes() != (again / name).read_bytes()] == []
