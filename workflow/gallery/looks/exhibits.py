"""What is shown: docs/gallery/looks.yaml."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Self

from annotated_types import Len
from pydantic import model_validator

from scene.diagnostics.problems import validated
from scene.reader import read
from scene.settings import Name, Settings

FOLDER = Path("docs/images/looks")
PAGE = Path("docs/looks.md")


class Exhibit(Settings):
    """One look."""

    name: Name
    """Of its picture."""
    says: str
    """What it is, in a sentence of Markdown."""
    seen: str
    """What is seen, for those who cannot see it."""
    on: str
    """The stand that it is shown on."""
    lines: str
    """Of a scene, within `render:`, that give it."""


class Exhibits(Settings):
    """All of them, in the order of the page."""

    intro: str
    stands: dict[str, dict[str, Any]]
    """Scenes without looks, by name."""
    exhibits: Annotated[tuple[Exhibit, ...], Len(1)]

    @model_validator(mode="after")
    def _stands_exist(self) -> Self:
        for exhibit in self.exhibits:
            if exhibit.on not in self.stands:
                raise ValueError(f"{exhibit.name} is shown on '{exhibit.on}': use one of {', '.join(self.stands)}")
        return self


def exhibits(root: Path) -> Exhibits:
    """Those of a checkout; raises SceneError for a file that cannot be used."""
    return validated(read(root / "docs/gallery/looks.yaml"), Exhibits)
