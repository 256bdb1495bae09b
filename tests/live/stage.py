"""A live session in a thread of its own, for tests."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from live.playing.session import Session
from scene.load import load

SCENE = """\
duration: 1
fps: 50
containers:
  tank: {type: box, size: [0.4, 0.8, 0.4]}
fluid:
  solver: dfsph
  particle_radius: 10 mm
  bodies:
    water: {shape: {type: box, size: [0.4, 0.3, 0.4]}, position: [0, 0.15, 0]}
rigid:
  bodies:
    box: {shape: {type: box, size: [0.1, 0.1, 0.1]}, position: [0, 0.4, 0], density: 300, motion: dynamic}
"""
COARSE = SCENE.replace("10 mm", "20 mm")


class Stage:
    """A session of the scene above, and what was refused."""

    def __init__(self, folder: Path, text: str = SCENE, **options: Any):
        path = folder / "scenes" / "pool.yaml"
        path.parent.mkdir()
        path.write_text(text)
        self.session = Session(load(path), **{"threads": 1, "arch": "cpu", **options})
        self.session.display.watched = True
        self.problems: list[str] = []
        self._thread = threading.Thread(target=self.session.run, daemon=True)
        self._thread.start()
        assert self.session.ready.wait(300)

    def change(self, **data: Any) -> None:
        self.session.change(data, self.problems.append)

    def until(self, reached: Callable[[Session], Any], seconds: float = 60.0) -> None:
        end = time.monotonic() + seconds
        while not reached(self.session):
            assert time.monotonic() < end and self._thread.is_alive(), (self.session.status, self.problems)
            time.sleep(0.005)

    def step(self) -> None:
        frame = self.session.status.frame
        self.session.step()
        self.until(lambda session: session.status.frame > frame and session.status.mode == "paused")

    def play_to(self, frame: int) -> None:
        while self.session.status.frame < frame:
            self.step()

    def until_closed(self) -> None:
        self._thread.join(30)
        assert self.session.status.mode == "closed"

    def close(self) -> None:
        self.session.close()
        self._thread.join(30)
        assert not self._thread.is_alive()

    def bytes(self) -> bytes:
        """Of places of particles and bodies after the last frame."""
        state = self.session._simulation.good
        return _bytes(state.fluid.tag, state.fluid.position, state.rigid.position)


def bytes_in(path: Path) -> bytes:
    """The same of a state that a run left."""
    with np.load(path) as state:
        return _bytes(state["fluid.tag"], state["fluid.position"], state["rigid.position"])


def _bytes(tag: np.ndarray, position: np.ndarray, bodies: np.ndarray) -> bytes:
    return position[np.argsort(tag[:, 0])].tobytes() + bodies.tobytes()
