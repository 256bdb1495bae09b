"""Files that targets are named after: `renders/tiny/splash` after `scenes/tiny/splash.yaml`, and studies alike."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from scene.diagnostics.suggestions import similar
from scene.document import SceneError
from workflow.plan.jobs import FILMS

STUDIES = "studies"
_UNFIT = re.compile(r"[{}\x00-\x1f\x7f-\x9f\ud800-\udfff]")
"""In the name of a file: Snakemake takes braces for a wildcard, and terminals take signs that control them."""


@dataclass(frozen=True)
class Shelf:
    """A folder of such files, with what they and their targets are called."""

    folder: Path
    noun: str
    plural: str
    target: str

    def names(self, root: Path = Path()) -> list[str]:
        """Names of all files, sorted."""
        folder = root / self.folder
        paths = (path.relative_to(folder).with_suffix("") for path in folder.rglob("*.yaml"))
        names = (path.as_posix() for path in paths if path.parts[0] != STUDIES)
        return sorted(name for name in names if not _UNFIT.search(name))

    def find(self, name: str) -> Path:
        """The file of a name; raises SceneError, with the names that are close, where there is none."""
        path = self.folder / f"{name}.yaml"
        if _UNFIT.search(name):
            raise SceneError([f"{name!r} cannot be the name of a {self.noun}\n  fix: rename the file: no {{ or }}"])
        known = self.names()
        if name not in known:
            close = similar(name, known, most=3)
            close += [other for other in known if other.endswith(f"/{name}") or name.startswith(f"{other}/")]
            hint = " or ".join(f"{self.target}/{other}" for other in dict.fromkeys(close))
            fix = f"did you mean {hint}?" if hint else f"the {self.plural} are {', '.join(known) or 'none yet'}"
            raise SceneError([f"there is no {self.noun} '{name}': no file {path}\n  fix: {fix}"])
        if path.with_suffix("").is_dir():
            raise SceneError(
                [
                    f"{path} and the folder {path.with_suffix('')}/ have the same name: what they make would be "
                    f"written into one another\n  fix: rename one of them"
                ]
            )
        return path


SCENE_FILES = Shelf(Path("scenes"), "scene", "scenes", FILMS)
STUDY_FILES = Shelf(Path("scenes", STUDIES), "study", "studies", STUDIES)
