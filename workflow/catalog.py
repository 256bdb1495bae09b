"""The scenes of the project by name: `scenes/tiny/splash.yaml` is `tiny/splash`.

`python -m workflow.catalog` lists them, and the studies, and says what to call.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sim.settings import Refused
from sim.similar import similar
from workflow.document import SceneError, read
from workflow.lookup import JobLookup, stop
from workflow.plan import FILMS, Job, Plan
from workflow.scene import QUALITIES, Scene, load, load_combination
from workflow.wedge.combinations import MARK, Combination, split
from workflow.wedge.plan import wedge_job

SCENES = "scenes"
STUDIES = "studies"
"""The folder beside the scenes that holds files of studies, which are none."""
CONFIG_KEYS = ("quality",)


def names(folder: Path = Path(SCENES)) -> list[str]:
    """Names of all scenes, sorted."""
    paths = (path.relative_to(folder).with_suffix("") for path in folder.rglob("*.yaml"))
    return sorted(path.as_posix() for path in paths if path.parts[0] != STUDIES)


def find(name: str, folder: Path = Path(SCENES)) -> Path:
    """The file of a scene; raises SceneError, with the names that are close, where there is none."""
    path = folder / f"{name}.yaml"
    known = names(folder)
    if name not in known:
        close = similar(name, known, most=3)
        close += [other for other in known if other.endswith(f"/{name}") or name.startswith(f"{other}/")]
        hint = " or ".join(f"{FILMS}/{other}" for other in dict.fromkeys(close))
        fix = f"did you mean {hint}?" if hint else f"the scenes are {', '.join(known) or 'none yet'}"
        raise SceneError([f"there is no scene '{name}': no file {path}\n  fix: {fix}"])
    if (folder / name).is_dir():
        raise SceneError(
            [
                f"{path} and the folder {folder / name}/ have the same name: their films would be written "
                f"into one another\n  fix: rename one of them"
            ]
        )
    return path


class Catalog(JobLookup):
    """Plans of the scenes, each made once."""

    def __init__(self, root: Path, config: Mapping[str, Any]):
        super().__init__()
        self._root = root
        self._plans: dict[tuple[str, str | None], Plan] = {}
        for key in config:
            if key not in CONFIG_KEYS:
                stop(f"--config {key}: unknown setting\n  fix: known here: {', '.join(CONFIG_KEYS)}")
        self._quality = config.get("quality")
        if self._quality is not None and self._quality not in QUALITIES:
            stop(f"--config quality={self._quality}: no such preset\n  fix: one of {', '.join(QUALITIES)}")

    def plan(self, name: str, quality: str | None = None) -> Plan:
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
                self._plans[same] = Plan(scene, self._root)
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
        name, combination = split(name)
        if combination:
            return load_combination(find(name), combination, quality=quality)
        return load(find(name), quality=quality)

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


def main() -> None:
    print("Make the film of a scene with")
    print("\n  snakemake --cores all renders/NAME [--config quality=draft|standard|final]\n")
    known = names()
    width = max(map(len, known), default=0)
    print("Scenes:" if known else f"There is no scene in {SCENES}/ yet.")
    for name in known:
        try:
            scene = load(find(name))
            about = scene.document.data.get("description") or f"{scene.duration:g} s, {scene.last_frame + 1} frames"
        except SceneError as error:
            about = f"refused: {error.problems[0].splitlines()[0]}"
        print(f"  {FILMS}/{name:<{width}}  {' '.join(str(about).split())}")
    studies = sorted(Path(SCENES, STUDIES).glob("*.yaml"))
    if studies:
        print("\nMeasure what accuracy costs with\n\n  snakemake --cores all studies/NAME\n\nStudies:")
        width = max(len(path.stem) for path in studies)
        for path in studies:
            print(f"  {STUDIES}/{path.stem:<{width}}  {_about(path)}")


def _about(study: Path) -> str:
    try:
        return " ".join(str(read(study).data.get("description", "")).split())
    except SceneError as error:
        return f"refused: {error.problems[0].splitlines()[0]}"


if __name__ == "__main__":
    main()
