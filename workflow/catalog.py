"""The films of the project by the names of their scenes, and of combinations of their wedges.

`python -m workflow.catalog` lists them, and the studies, and says what to call.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from common.command import end_with
from scene.document import SceneError
from scene.load import Scene, combination_of, load
from scene.presets import QUALITIES
from scene.reader import read
from scene.settings import Refused
from scene.wedge import MARK, Combination, split
from sim.device.compiler_choice import chosen
from workflow.plan import grants
from workflow.plan.aims import AIMS, Aim, aim_of
from workflow.plan.jobs import RESULTS, Digests, Job, Plan
from workflow.plan.lookup import JobLookup, stop
from workflow.plan.shelf import SCENE_FILES, STUDY_FILES, Shelf
from workflow.wedge.plan import wedge_job

CONFIG_KEYS = ("quality", "keep", *grants.KEYS, *(aim.key for aim in AIMS))
COMMAND = "python -m workflow.catalog"
KEEP = ("all", "film")
"""What is kept of a film: its parts too, or nothing else."""


class Catalog(JobLookup):
    """Plans of the scenes, each made once."""

    def __init__(self, root: Path, config: Mapping[str, Any], cores: int = 1, dry: Callable[[], bool] = lambda: True):
        super().__init__(dry)
        self._root = root
        self._plans: dict[tuple[str, str | None], Plan] = {}
        self._digests: Digests = {}
        for key in config:
            if key not in CONFIG_KEYS:
                stop(f"--config {key}: unknown setting\n  fix: known here: {', '.join(CONFIG_KEYS)}")
        try:
            chosen()
        except Refused as refused:
            stop(f"{refused.message}\n  fix: {refused.remedy}")
        self._quality = config.get("quality")
        if self._quality is not None and self._quality not in QUALITIES:
            stop(f"--config quality={self._quality}: no such preset\n  fix: one of {', '.join(QUALITIES)}")
        self.keep = config.get("keep", "all")
        if self.keep not in KEEP:
            stop(f"--config keep={self.keep}: nothing of that name can be kept\n  fix: one of {', '.join(KEEP)}")
        grants.grant(config)
        self._aim = aim_of(config, cores)
        if self._aim is not None:
            self._quality = self._aim.quality

    def plan(self, name: str, quality: str | None = None) -> Plan:
        """The plan of a scene at a quality, by default that of the configuration, or the scene's own; ends the process
        with a message where the scene cannot be used."""
        key = (name, quality or self._quality)
        if key not in self._plans:
            try:
                scene = self._load(name, key[1])
            except SceneError as error:
                stop(str(error))
            try:
                scene.film.copy_path(Path.cwd())
            except Refused as refused:
                stop(str(scene.error(refused)))
            same = (name, scene.quality)
            if same not in self._plans:
                self._plans[same] = Plan(scene, self._root, self._digests)
            self._plans[key] = self._plans[same]
        return self._plans[key]

    def wedge(self, name: str) -> dict[str, tuple[Combination, Plan]]:
        """The combinations of a scene's wedge with the plans of their films, by name."""
        scene = self.plan(name).scene
        if not scene.wedge:
            example = "wedge: {fluid.viscosity: [1e-6, 1e-3]}"
            stop(f"{scene.path} has no wedge, so there is nothing to compare\n  fix: add one, as `{example}`")
        films = {f"{name}{MARK}{found.name}": found for found in scene.wedge}
        return {film: (found, self.plan(film)) for film, found in films.items()}

    def _load(self, name: str, quality: str | None) -> Scene:
        base, combination = split(name)
        aim = next((aim for aim in AIMS if aim.quality == quality), None)
        if aim is not None:
            return self._aimed(name, aim)
        if combination:
            return combination_of(self.plan(base, quality).scene, combination)
        return load(SCENE_FILES.find(base), quality=quality)

    def _aimed(self, name: str, aim: type[Aim]) -> Scene:
        if MARK in name:
            stop(
                f"--config {aim.key}: {name} is one of a wedge, which has to be made as the others are\n"
                f"  fix: use quality"
            )
        if not isinstance(self._aim, aim):
            stop(
                f"{RESULTS}/{name}/{aim.quality} was made with --config {aim.example} or the like\n  fix: give it again"
            )
        return self._aim.scene(SCENE_FILES.find(name), name)

    def find(self, stage: str, wildcards: Any) -> Job:
        """Wildcards: scene, quality, and the number of the part."""
        if stage == "wedge":
            return wedge_job(wildcards.scene, self.wedge(wildcards.scene), self._root)
        plan = self.plan(wildcards.scene, wildcards.get("quality"))
        try:
            return plan.job(stage, int(wildcards.get("segment", wildcards.get("block", 0))))
        except IndexError as error:
            stop(f"{plan.scene.name}: {error}")

    def complete(self, job: Job, wildcards: Any) -> bool:
        """Whether the copy of the film that the scene asks for is there."""
        if job.stage != "film":
            return True
        copy = self.plan(wildcards.scene, wildcards.get("quality")).scene.film.copy_path(Path.cwd())
        original = Path(job.folder, f"{Path(job.folder).name}.mp4")
        return copy is None or (original.exists() and copy.exists() and copy.stat().st_size == original.stat().st_size)


def main(arguments: Sequence[str] | None = None, called: str = COMMAND) -> None:
    argparse.ArgumentParser(prog=called, description="List scenes and studies, and say how to use them.").parse_args(
        arguments
    )
    presets = "|".join(QUALITIES)
    choices = [f"quality={presets}", *(aim.example for aim in AIMS)]
    by_command = called.startswith("tidemill ")
    options = " | ".join([f"--quality {presets}", *(aim.option for aim in AIMS)])
    config = f"[--config {' | '.join(choices)}]"
    film = f"tidemill render NAME [{options}]" if by_command else f"snakemake --cores all renders/NAME {config}"
    study = "tidemill study NAME" if by_command else "snakemake --cores all studies/NAME"
    print(f"Make the film of a scene with\n\n  {film}\n")
    _list(SCENE_FILES, _seen)
    print(f"\nMeasure what accuracy costs with\n\n  {study}\n")
    _list(STUDY_FILES, lambda path: read(path).data.get("description", ""))


def _list(shelf: Shelf, tell: Callable[[Path], str]) -> None:
    own = shelf.names(Path())
    print(f"{shelf.plural.capitalize()}:" if own else f"There is no {shelf.noun} in {shelf.folder}/ yet.")
    _tell_names(shelf, own, tell)
    if shipped := [name for name in shelf.names() if name not in own]:
        print(f"{shelf.plural.capitalize()} that come with Tidemill:")
        _tell_names(shelf, shipped, tell)


def _tell_names(shelf: Shelf, names: Sequence[str], tell: Callable[[Path], str]) -> None:
    width = max(map(len, names), default=0)
    for name in names:
        try:
            about = tell(shelf.find(name))
        except SceneError as error:
            about = f"refused: {error.problems[0].splitlines()[0]}"
        print(f"  {shelf.target}/{name:<{width}}  {' '.join(str(about).split())}")


def _seen(path: Path) -> str:
    scene = load(path)
    return scene.document.data.get("description") or f"{scene.duration:g} s, {scene.last_frame + 1} frames"


if __name__ == "__main__":
    end_with(main)
