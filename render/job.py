"""One block of frames, as plain data: what `python -m render` hands to the Blender side."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

FORMATS = (".usd", ".usda", ".usdc", ".abc", ".blend", ".glb", ".vdb")
"""Kinds of files of a whole animation; of the last, one a frame."""
Report = Callable[[dict[str, Any]], None]
"""Takes what happened: `{"frame": 42, "wall_s": 3.1}` after each frame."""


@dataclass(frozen=True)
class Job:
    """Frames `first` to `last`, both included, to be rendered into the folder `out`."""

    settings: dict[str, Any]
    """The dumped RenderSpec, None where it is open."""
    simulation: str
    surface: str | None
    first: int
    last: int
    out: str
    log: str
    """File that takes what Blender prints."""
    foam: str | None = None
    wet: str | None = None
    fps: float = 24.0
    """Frames per simulated second [Hz]."""
    threads: int | None = None
    save_blend: str | None = None
    packages: dict[str, str] = field(default_factory=dict)
    """Those that add looks, and their files: Blender's own Python does not know where they are installed."""
    export: str | None = None
    """Instead of pictures: a file of the animation, of one of the FORMATS."""
    particles: float | None = None
    """Radius of the fluid's particles [m], if the file is to have them as points."""
    voxel: float | None = None
    """Edge of a cell of a volume [m]; without it, the spacing of the particles."""

    def frames(self) -> range:
        """Numbers of the frames to be rendered."""
        return range(self.first, self.last + 1)

    def write(self, path: Path) -> None:
        """Write it as JSON, for `load`."""
        path.write_text(json.dumps(asdict(self)))

    @classmethod
    def load(cls, path: Path) -> Job:
        """Read what `write` wrote."""
        return cls(**json.loads(path.read_text()))
