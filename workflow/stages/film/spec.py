"""Typed settings of the film: from rendered frames to what people look at."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le
from pydantic import StringConstraints

from scene.settings import Refused, Settings
from scene.units import FrameRate

MANAGED = frozenset({"results", "renders", "studies", "wedges", ".snakemake", ".git"})
"""Folders of the project in which nothing else may be written."""


ALPHA = ("prores", "vp9", "webp")
"""Formats of films that keep an alpha channel."""


class ContactSheet(Settings):
    """One picture with frames from the whole film, each labelled with its time."""

    frames: Annotated[int, Ge(1), Le(400)] = 12
    """Number of frames, spread evenly from the first to the last."""
    columns: Annotated[int, Ge(1), Le(40)] = 4
    """Frames in a row."""
    width: Annotated[int, Gt(0), Le(16_000)] = 1920
    """Width of the sheet [px]."""


class FilmSpec(Settings):
    """Everything that the film depends on, besides the frames."""

    playback_fps: Annotated[FrameRate, Le(1000)] | None = None
    """Frames shown per second [Hz]; without it the scene's fps, which is real time. Fewer are slow motion: 96 frames a
    simulated second at `24000/1001` are four times slower."""
    crf: Annotated[int, Ge(0), Le(51)] = 18
    """Quality of the H.264 encoder: 0 lossless, which few players take, 18 visually lossless, 28 small files."""
    also: tuple[Literal["h265", "av1", "vp9", "prores", "webp", "gif"], ...] = ()
    """The film in other formats, beside the MP4 in H.264 that plays everywhere: H.265, AV1 and VP9 (WebM) at a half to
    two thirds of its size, ProRes to edit, WebP and GIF for pages. Of pictures with an alpha channel
    (`render.background: {type: transparent}`) `prores` (4444), `vp9` and `webp` keep it, and the MP4 shows them on
    paper."""
    contact_sheet: ContactSheet = ContactSheet()
    copy_to: Annotated[str, StringConstraints(min_length=1, pattern=r"\.mp4$")] | None = None
    """Where a copy of the film is written, relative to the project's folder, as `gallery/bunny.mp4`."""

    def copy_path(self, project: Path) -> Path | None:
        """Absolute path of the copy, links resolved.

        Raises Refused where it would leave the project's folder or lands where the workflow keeps its results.
        """
        if self.copy_to is None:
            return None
        project = project.resolve()
        path = (project / self.copy_to).resolve()
        location = ("film", "copy_to")
        if not path.is_relative_to(project):
            raise Refused(
                f"'{self.copy_to}' is outside of the project's folder {project}",
                location=location,
                remedy="give a path inside it, such as gallery/film.mp4",
            )
        if path.relative_to(project).parts[0] in MANAGED:
            raise Refused(
                f"'{self.copy_to}' is inside of {path.relative_to(project).parts[0]}/, which the workflow manages",
                location=location,
                remedy="give a path elsewhere in the project, such as gallery/film.mp4",
            )
        if path.is_dir():
            raise Refused(f"'{self.copy_to}' is a folder", location=location, remedy="name a file ending in .mp4")
        return path

    def refuse_opaque(self) -> None:
        """Raise Refused for formats without an alpha channel, of a film that has one."""
        for index, name in enumerate(self.also):
            if name not in ALPHA:
                raise Refused(
                    f"'{name}' cannot keep the transparent background",
                    location=("film", "also", index),
                    remedy=f"take {', '.join(ALPHA[:-1])} or {ALPHA[-1]}, or another render.background",
                )


class FilmJobSpec(Settings):
    """What `python -m workflow.film --spec` takes: the film, and what it is the film of."""

    name: Annotated[str, StringConstraints(min_length=1)]
    """Name of the scene, with its folder, as `tiny/splash`."""
    quality: str = "standard"
    fps: Annotated[FrameRate, Le(10_000)]
    """Frames per simulated second [Hz]."""
    last_frame: Annotated[int, Ge(0)]
    """The film shows the frames 0 to this one."""
    transparent: bool = False
    """Whether the frames have an alpha channel."""
    film: FilmSpec = FilmSpec()
