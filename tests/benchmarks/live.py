"""Steps per second of a live run with and without a viewer, and pictures and frames a second that a viewer gets.

    python tests/benchmarks/live.py [--particles 20000] [--turns 5] [--steps 100] [--browser 800x600] [--threads 2]

A box falls into a pool. The same steps are taken again and again, by turns with and without a viewer, and the cost is
the median of what each turn with one cost against the turns beside it. By default the viewer is a process that takes
pictures and answers them without drawing, as a browser does that draws by a graphics card or on another machine. With
--browser it is a headless Chromium of that size, which draws on the same cores.
"""

from __future__ import annotations

import argparse
import itertools
import multiprocessing
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))

FIRST = 1
"""The frame from which steps are taken."""
WARM_UP = 3
"""Steps before the first that counts."""
COUNT_FRAMES = "window.frames_drawn = 0; const count = () => { window.frames_drawn++; requestAnimationFrame(count) }; "
COUNT_FRAMES += "count()"


def answering(port: int, leave: Event, pictures: Any) -> None:
    """Look at the page without drawing it, in a process of its own."""
    from tests.live.viewer import Viewer

    viewer = Viewer(port)
    while not leave.wait(0.05):
        pictures.value = viewer.pictures
    viewer.close()


class Watcher:
    """A viewer that only answers."""

    def __init__(self, port: int):
        spawn = multiprocessing.get_context("spawn")
        self._leave, self._pictures = spawn.Event(), spawn.Value("l", 0)
        self._process = spawn.Process(target=answering, args=(port, self._leave, self._pictures), daemon=True)
        self._process.start()
        while self._pictures.value == 0:
            time.sleep(0.05)

    @property
    def pictures(self) -> int:
        return self._pictures.value

    frames = pictures

    def leave(self) -> None:
        self._leave.set()
        self._process.join()


class Chromium:
    """A browser that draws by the processor."""

    def __init__(self, port: int, page: Any, size: str):
        from tests.live import test_page

        test_page.OPTIONS = test_page.OPTIONS.replace("900,600", size.replace("x", ","))
        self._answers = 0
        self._browser = test_page.Browser(port)
        self._browser.find("//button[normalize-space()='Play']")
        self._browser.driver.execute_script(COUNT_FRAMES)
        (viewer,) = page.viewers
        viewer.client.camera.on_update(self._answered)

    def _answered(self, camera: Any) -> None:
        self._answers += 1

    @property
    def pictures(self) -> int:
        return self._answers

    @property
    def frames(self) -> int:
        return int(self._browser.driver.execute_script("return window.frames_drawn"))

    def leave(self) -> None:
        self._browser.driver.quit()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--particles", type=int, default=20_000)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--steps", type=int, default=100, help="of a turn")
    parser.add_argument("--browser", metavar="WIDTHxHEIGHT")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()

    from live.page import Page
    from tests.live.stage import SCENE, Stage

    radius = (0.4 * 0.3 * 0.4 / options.particles) ** (1 / 3) / 2
    with tempfile.TemporaryDirectory() as folder:
        stage = Stage(Path(folder), SCENE.replace("10 mm", f"{1000 * radius:.3f} mm"), threads=options.threads)
        session = stage.session
        session.display.watched = False
        page = Page(session, host="127.0.0.1", port=0)
        stage.step()
        alone, watched, pictures, frames = [], [], [], []
        for _ in range(options.turns):
            alone.append(rates(stage, options.steps, lambda: [])[0])
            viewer = Chromium(page.port, page, options.browser) if options.browser else Watcher(page.port)
            found = rates(stage, options.steps, lambda seen=viewer: [seen.pictures, seen.frames])
            viewer.leave()
            for column, value in zip((watched, pictures, frames), found, strict=True):
                column.append(value)
        alone.append(rates(stage, options.steps, lambda: [])[0])
        print(f"{session.status.particles:,} particles, {options.threads} threads")
        for name, column in (
            ("steps/s alone", alone),
            ("steps/s with a viewer", watched),
            ("pictures/s", pictures),
            ("frames/s", frames),
        ):
            print(f"{name:22} {statistics.median(column):8.2f}   of {', '.join(f'{value:.2f}' for value in column)}")
        beside = [(early + late) / 2 for early, late in itertools.pairwise(alone)]
        costs = [1 - there / none for there, none in zip(watched, beside, strict=True)]
        print(f"cost {statistics.median(costs):.1%}   of {', '.join(f'{cost:.1%}' for cost in costs)}")
        page.close()
        stage.close()


def rates(stage: Any, steps: int, counts: Callable[[], list[int]]) -> list[float]:
    """How fast a number of steps after the first frame is taken, and how fast counts grow meanwhile [1/s]."""
    session = stage.session
    session.go_back(FIRST)
    stage.until(lambda session: session.status.frame == FIRST and session.status.mode == "paused", 600)
    start = session.clock.step + WARM_UP
    session.play()
    stage.until(lambda session: session.clock.step >= start, 600)
    began, before = time.perf_counter(), counts()
    stage.until(lambda session: session.clock.step >= start + steps, 3600)
    passed, after = time.perf_counter() - began, counts()
    session.pause()
    stage.until(lambda session: session.status.mode == "paused", 600)
    return [steps / passed, *((late - early) / passed for late, early in zip(after, before, strict=True))]


if __name__ == "__main__":
    main()
