"""What is shown: docs/gallery/shots.yaml."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from annotated_types import Ge, Len
from pydantic import Field

from scene.diagnostics.problems import validated
from scene.presets import Quality
from scene.reader import read
from scene.settings import Settings

FOLDER = Path("docs/gallery")
PAGE = Path("docs/gallery.md")


class Shot(Settings):
    """One film of the gallery."""

    scene: str
    title: str
    says: str
    """What the scene does, in a sentence or two of Markdown."""
    seen: str
    """What is seen, for those who cannot see it."""
    frame: Annotated[int, Ge(0)]
    """That the large picture shows."""
    quality: Quality | None = None
    """Preset of the film, where it is not the scene's own."""
    set: tuple[str, ...] = ()
    """Other settings of the film than those of the scene, as `--config set` takes them."""
    picture: Quality | None = None
    """Preset of the large picture, where it is finer than the film."""


class Shots(Settings):
    """All of them, in the order of the page."""

    intro: str
    shots: Annotated[tuple[Shot, ...], Len(1)] = Field()


def shots(root: Path) -> Shots:
    """Those of a checkout; raises SceneError for a file that cannot be used."""
    return validated(read(root / FOLDER / "shots.yaml"), Shots)
