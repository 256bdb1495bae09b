"""The page in a headless Chromium: what it shows, and what its buttons do to the simulation behind it."""

from __future__ import annotations

import shutil
import time
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from live.page import Page
from scene.load import load
from tests.live.stage import COARSE, Stage, bytes_in

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
pytestmark = pytest.mark.skipif(not (BROWSER and DRIVER), reason="no chromium, or no chromium-driver")
OPTIONS = """--headless=new --no-sandbox --disable-dev-shm-usage --use-gl=angle --use-angle=swiftshader
--enable-unsafe-swiftshader --window-size=900,600 --disable-background-networking --disable-component-update"""


class Browser:
    """One page, and what a person would do with it."""

    def __init__(self, port: int):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service

        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for option in OPTIONS.split():
            options.add_argument(option)
        self.driver = webdriver.Chrome(options=options, service=Service(DRIVER))
        self.driver.get(f"http://127.0.0.1:{port}")

    def find(self, path: str, seconds: float = 40.0):
        """The first element of an XPath that is shown."""
        end = time.monotonic() + seconds
        while True:
            shown = [item for item in self.driver.find_elements("xpath", path) if item.is_displayed()]
            if shown:
                return shown[0]
            assert time.monotonic() < end, path
            time.sleep(0.1)

    def press(self, text: str) -> None:
        found = self.find(f"//button[normalize-space()='{text}']")
        self.driver.execute_script("arguments[0].scrollIntoView()", found)
        found.click()

    def turn_to(self, tab: str) -> None:
        path, end = f"//*[@role='tab'][normalize-space()='{tab}']", time.monotonic() + 40
        while self.find(path).get_attribute("aria-selected") != "true":
            assert time.monotonic() < end, tab
            self.find(path).click()
            time.sleep(0.3)

    def slide(self, label: str, key: str) -> None:
        """Press a key on the slider with a label."""
        slider = self.find(f"//label[normalize-space()='{label}']/following::*[@role='slider'][1]")
        self.driver.execute_script("arguments[0].scrollIntoView()", slider)
        slider.send_keys(key)

    def picture(self) -> np.ndarray:
        image = Image.open(BytesIO(self.driver.get_screenshot_as_png())).convert("RGB")
        return np.asarray(image, int)[:, :500]


@pytest.fixture
def stage(tmp_path):
    stage = Stage(tmp_path, COARSE)
    yield stage
    stage.close()


@pytest.fixture
def page(stage):
    page = Page(stage.session, host="127.0.0.1", port=0)
    yield page
    page.close()


@pytest.fixture
def browser(page):
    browser = Browser(page.port)
    yield browser
    browser.driver.quit()


def coloured(picture: np.ndarray, *, warm: bool) -> int:
    """How many pixels are as red as bodies, or as blue as slow particles."""
    red, blue = picture[..., 0], picture[..., 2]
    return int((red - blue > 60).sum() if warm else (blue - red > 25).sum())


def mean_speed_up(stage: Stage) -> float:
    return float(stage.session._simulation.good.fluid.velocity[:, 1].mean())


def height(stage: Stage, name: str, frame: int) -> float:
    """Of a body in a frame [m]."""
    (state,) = [kept.rigid for kept in stage.session.history.kept if kept.clock.frame == frame]
    return float(state.position[state.names.index(name), 1])


def test_what_is_done_in_the_page_happens_and_replays(stage, browser, simulate, tmp_path):
    session = stage.session
    browser.find("//button[normalize-space()='Play']")
    end = time.monotonic() + 40
    while min(coloured(browser.picture(), warm=True), coloured(browser.picture(), warm=False)) < 300:
        assert time.monotonic() < end, "no particles, or no body"
    browser.turn_to("Change")
    browser.slide("y [m/s^2]", "\ue010")
    stage.until(lambda session: session.spec.gravity[1] == 20.0)
    browser.turn_to("Play")
    speeds = []
    for frame in (1, 2, 3):
        browser.press("Next frame")
        stage.until(lambda session, frame=frame: session.status.frame >= frame and session.status.mode == "paused")
        speeds.append(mean_speed_up(stage))
    assert speeds[2] - speeds[0] == pytest.approx(20.0 * 2 / 50, rel=0.05), "once it has left the floor"
    browser.press("Go back")
    stage.until(lambda session: session.status.frame == 0 and session.status.mode == "paused")
    assert session.spec.gravity[1] == -9.81
    browser.turn_to("Add")
    browser.press("Add")
    stage.until(lambda session: "added1" in session.spec.rigid.bodies)
    above = session.spec.rigid.bodies["added1"].position[1]
    browser.turn_to("Play")
    browser.press("Play")
    stage.until(lambda session: session.clock.frame >= 5, 300)
    browser.press("Pause")
    stage.until(lambda session: session.status.mode == "paused")
    assert height(stage, "added1", 3) == pytest.approx(above - 9.81 * (3 / 50) ** 2 / 2, abs=1e-6), "it falls"
    browser.turn_to("Add")
    browser.press("Remove")
    stage.until(lambda session: session.played.waiting or "added1" not in session.spec.rigid.bodies)
    stage.step()
    stage.until(lambda session: list(session.spec.rigid.bodies) == list(session.display.picture.poses) == ["box"])
    browser.turn_to("Save")
    browser.press("Save as scene")
    path = tmp_path / "scenes" / "pool_live.yaml"
    stage.until(lambda session: path.exists())
    time.sleep(0.5)
    scene = load(path)
    out = simulate(scene.simulation.model_dump(mode="json", exclude_none=True), scene.last_frame, threads=1)
    assert bytes_in(out / f"state_{scene.last_frame:05d}.npz") == stage.bytes()
