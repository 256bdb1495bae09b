"""What every format is written from: the scene, and what is in it in each frame."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from render.blender import versions
from render.blender.session import check
from render.content.scene import Scene
from render.errors import Unusable
from render.export.clouds import Cloud
from render.inputs import Pose
from render.job import Report


@dataclass(frozen=True)
class Frames:
    """The frames of an animation."""

    scene: Scene
    numbers: range
    fps: float
    """Frames per simulated second [Hz]."""
    poses: dict[int, dict[str, Pose]]
    """Of the bodies, by frame and name."""
    clouds: tuple[Cloud, ...]
    """What is drawn as points."""
    report: Report

    def key(self) -> None:
        """Make keyframes of bodies and camera."""
        for frame in self.numbers:
            self.scene.key(frame, self.poses[frame])

    def done(self, frame: int) -> None:
        """Say that a frame is read."""
        self.report({"frame": frame, "wall_s": 0.0})


def save(path: Path, operator: Any, **options: Any) -> None:
    """Let an operator of Blender write a file; raises Unusable where it cannot, or is not there."""
    try:
        check(operator(filepath=str(path), **versions.known_options(operator, options)), "exporting")
    except (AttributeError, KeyError, RuntimeError) as error:
        raise Unusable(f"this Blender cannot write {path.suffix} files: {error}") from error
