"""What a scene costs: memory and files as estimated, times as its last film took them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from common.ply import FLUID_POINT
from scene.load import Scene
from sim.checks.explain import Line
from workflow.plan.jobs import FILMS
from workflow.plan.memory import estimate, particles
from workflow.stages.film.summaries import read


def measured(scene: Scene, overrides: Sequence[str]) -> list[Line]:
    """What the film is predicted to take on all cores, after coarse copies of it; raises SceneError, PilotFailed."""
    from workflow.budget.detail import Presets
    from workflow.budget.forecast import predicted, teller

    cores = os.cpu_count() or 1
    found = predicted(Presets(scene.path, overrides), scene, cores, teller(scene.name))
    return [Line("forecast", f"{found}, on {cores} cores")]


def costs(scene: Scene) -> list[Line]:
    """Memory of the jobs, the size of the particles' files, and what the last film took, if there is one."""
    fluid = ["reconstruct"] if particles(scene) else []
    stages = ["simulate", *fluid, *(["foam"] if scene.foam else [])]
    stages += [*(["wet"] if scene.render.wetness else []), "render"]
    memory = ", ".join(f"{stage} {estimate(stage, scene):,} MB" for stage in stages)
    found = [Line("memory", f"at most about {memory}")]
    count, frames = particles(scene), scene.last_frame + 1
    if count:
        each = count * FLUID_POINT.itemsize / 1e6
        found.append(
            Line("files", f"{frames} of up to {each:.3g} MB with particles, {frames * each / 1000:.3g} GB in all")
        )
    film = read(Path(FILMS, scene.name))
    if film.get("quality") == scene.quality and "wall_s" in film:
        times = ", ".join(f"{stage} {wall['total']:.0f} s" for stage, wall in film["wall_s"].items() if stage in stages)
        found.append(Line("time", f"the film in {FILMS}/{scene.name} took {times}, added up over its jobs"))
    else:
        found.append(Line("time", f"not known: there is no film of this quality in {FILMS}/{scene.name}"))
    return found
