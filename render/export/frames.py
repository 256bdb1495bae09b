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

    def shrink_absent_bodies(self) -> None:
        """Let bodies have no size in frames in which they are not there, in place of being out of sight: no file but a
        .blend says that, and Blender does not even move them then."""
        for name, thing in self.scene.bodies().items():
            there = {frame: name in self.poses[frame] for frame in self.numbers}
            if not all(there.values()):
                curves = versions.curves(thing)
                for curve in [curve for curve in curves if curve.data_path in ("hide_render", "hide_viewport")]:
                    curves.remove(curve)
                thing.hide_render = thing.hide_viewport = False
                give_size(thing, there)

    def done(self, frame: int) -> None:
        """Say that a frame is read."""
        self.report({"frame": frame, "wall_s": 0.0})


def give_size(thing: Any, seen: dict[int, bool]) -> None:
    """Give a thing its size in the frames in which it is seen, and none in others."""
    for frame, whole in seen.items():
        thing.scale = (float(whole),) * 3
        thing.keyframe_insert("scale", frame=frame)


def save(path: Path, operator: Any, **options: Any) -> None:
    """Let an operator of Blender write a file; raises Unusable where it cannot, or is not there."""
    try:
        check(operator(filepath=str(path), **versions.known_options(operator, options)), "exporting")
    except (AttributeError, KeyError, RuntimeError) as error:
        raise Unusable(f"this Blender cannot write {path.suffix} files: {error}") from error
