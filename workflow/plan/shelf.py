"""Files that targets are named after: `renders/tiny/splash` after `scenes/tiny/splash.yaml`, and studies alike.

Those of the working directory come first; those that come with this software are found from any folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from common.distribution import HOME
from scene.diagnostics.suggestions import similar
from scene.document import SceneError
from workflow.plan.jobs import FILMS

STUDIES = "studies"


@dataclass(frozen=True)
class Shelf:
    """A folder of such files, with what they and their targets are called."""

    folder: Path
    noun: str
    plural: str
    target: str

    def names(self, root: Path | None = None) -> list[str]:
        """Names of all files, sorted: of one folder, or of the working directory and of those that come with this
        software."""
        roots = (Path(), HOME) if root is None else (root,)
        return sorted({name for root in roots for name in self._below(root / self.folder)})

    def _below(self, folder: Path) -> Iterator[str]:
        for path in folder.rglob("*.yaml"):
            name = path.relative_to(folder).with_suffix("")
            if name.parts[0] != STUDIES:
                yield name.as_posix()

    def locate(self, written: str) -> Path:
        """The file that a user names by its path or by its name; raises SceneError as `find` does."""
        is_file = written.endswith((".yaml", ".yml")) or os.path.exists(written)
        return Path(written) if is_file else self.find(written)

    def find(self, name: str) -> Path:
        """The file of a name; raises SceneError, with the names that are close, where there is none."""
        known = self.names()
        path = self.folder / f"{name}.yaml"
        if name not in known:
            close = similar(name, known, most=3)
            close += [other for other in known if other.endswith(f"/{name}") or name.startswith(f"{other}/")]
            hint = " or ".join(f"{self.target}/{other}" for other in dict.fromkeys(close))
            fix = f"did you mean {hint}?" if hint else f"the {self.plural} are {', '.join(known) or 'none yet'}"
            raise SceneError([f"there is no {self.noun} '{name}': no file {path}\n  fix: {fix}"])
        if not path.is_file():
            path = HOME / path
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
