"""What a hand does to a body, to cloth and to an emitter."""

from __future__ import annotations

import numpy as np
import pytest

from live.page import Page
from tests.live.stage import Stage
from tests.live.viewer import Viewer

FALLING = """\
duration: 1
fps: 50
fluid:
  solver: wcsph
  particle_radius: 20 mm
  emitters:
    tap: {shape: {type: disc, radius: 0.06}, position: [2, 1, 0], speed: 1, start: 0}
rigid:
  bodies:
    box: {shape: {type: box, size: [0.1, 0.1, 0.1]}, position: [0, 1, 0], density: 300, motion: dynamic}
cloth:
  sheets:
    flag: {shape: {type: sheet, size: [0.3, 0.3]}, position: [-2, 1, 0], pins: [left], mass_per_area: 0.2,
           spacing: 0.06}
"""


@pytest.fixture
def stage(tmp_path):
    stage = Stage(tmp_path, FALLING)
    yield stage
    stage.close()


@pytest.mark.slow
def test_a_hand_holds_a_body_releases_cloth_and_closes_a_tap(stage):
    session = stage.session
    page = Page(session, host="127.0.0.1", port=0)
    viewer = Viewer(page.port)
    stage.until(lambda session: viewer.values[viewer.wait_for("body")[0]] == "box")
    viewer.set("draw it to the handle", True)
    stage.until(lambda session: session.spec.rigid.bodies["box"].pulls)
    stage.play_to(8)
    sag = 9.81 * (0.2 / (2 * np.pi)) ** 2
    assert session.display.picture.poses["box"].position[1] == pytest.approx(1 - sag, abs=0.002)
    left = session.display.picture.cloths["flag"][:, 1].max()
    assert left == pytest.approx(1.0, abs=1e-6), "it is pinned"
    viewer.set("draw it to the handle", False)
    viewer.press("Release")
    viewer.press("Close")
    stage.until(lambda session: session.spec.fluid.emitters["tap"].stop and not session.spec.rigid.bodies["box"].pulls)
    stage.until(lambda session: not session.spec.cloth.sheets["flag"].pins)
    sent = session.status.particles
    stage.play_to(13)
    fallen = 9.81 * 0.1**2 / 2
    assert session.display.picture.poses["box"].position[1] == pytest.approx(1 - sag - fallen, rel=0.02)
    assert session.display.picture.cloths["flag"][:, 1].max() < 0.995
    assert session.status.particles == sent > 0
    page.close()
