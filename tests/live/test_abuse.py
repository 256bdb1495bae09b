"""What no browser would send, and more than anybody would do: the simulation goes on, and so does the page."""

from __future__ import annotations

import gc
import random
import time
import tracemalloc
from collections.abc import Callable

import numpy as np
import psutil
import pytest

from live.page import Page
from live.panel import Panel
from live.playing.session import Session
from tests.live.stage import SCENE, Stage
from tests.live.viewer import Viewer

COARSE = SCENE.replace("10 mm", "20 mm")
MB = 1e6
VALUES = [0, 1, -1, 1e300, -1e300, float("nan"), float("inf"), "", "x" * 10_000, "[1, 2", "{}", "null", "../..", True]
VALUES += [[0, 0, 0], [1e9] * 3, [float("nan")] * 3, [], None, {"a": 1}, b"\x00", 1 << 62]
MALFORMED = [b"", b"\x00", b"\xff" * 1000, b"\x80", "text", b"\x81\xa4type\xa4Nope", b"\xc1", b"\x93\x01\x02\x03"]


@pytest.fixture
def stage(tmp_path):
    stage = Stage(tmp_path, COARSE, history=int(20 * MB))
    yield stage
    stage.close()


@pytest.fixture
def page(stage):
    page = Page(stage.session, host="127.0.0.1", port=0)
    yield page
    page.close()


def still_works(stage: Stage, page: Page) -> None:
    """A newcomer that takes over can go back to the start and simulate a frame, all of which is finite."""
    viewer = Viewer(page.port)
    viewer.press("Take over")
    viewer.press("Pause")
    stage.until(lambda session: session.status.mode == "paused")
    viewer.set("frame", 0)
    viewer.press("Go back")
    stage.until(lambda session: session.status.frame == 0)
    viewer.press("Next frame")
    stage.until(lambda session: session.status.frame == 1 and session.status.mode == "paused", 120)
    assert all_finite(stage.session)
    assert stage.session.status.particles == round(0.4 * 0.3 * 0.4 / 0.04**3)
    assert viewer.pictures > 0
    viewer.close()


def all_finite(session: Session) -> bool:
    picture = session.display.picture
    poses = [part for pose in picture.poses.values() for part in (pose.position, pose.quaternion)]
    return all(
        np.isfinite(values).all() for values in [picture.points, picture.velocity, *poses, *picture.cloths.values()]
    )


def memory() -> float:
    """Of this process [MB]."""
    gc.collect()
    return psutil.Process().memory_info().rss / MB


def kept(level: int, seconds: float = 20.0) -> bool:
    """Whether Python holds more than this [B] of what it took since tracing began."""
    end = time.monotonic() + seconds
    while gc.collect() >= 0 and tracemalloc.get_traced_memory()[0] > level:
        if time.monotonic() > end:
            return True
        time.sleep(0.5)
    return False


def act(viewer: Viewer, random: random.Random) -> None:
    """Press, slide, choose or type something, sensible or not."""
    fields = viewer.all_fields
    if not fields:
        return
    field = random.choice(fields)
    known = viewer.values.get(field)
    near = known * random.uniform(0, 2) if isinstance(known, float) else known
    value = random.choice([True, near, random.choice(VALUES)])
    viewer.send(type="GuiUpdateMessage", uuid=field, updates={"value": value})


def act_for(viewers: list[Viewer], actions: int, seconds: float, watch: Callable[[], None]) -> None:
    chance = random.Random(7)
    began = time.monotonic()
    for number in range(actions):
        act(chance.choice(viewers), chance)
        if number % 20 == 0:
            watch()
        time.sleep(max(0.0, began + seconds * (number + 1) / actions - time.monotonic()))


def test_malformed_messages_close_their_sender_only(stage, page):
    watching = Viewer(page.port)
    watching.wait_for("Play")
    for message in MALFORMED:
        bad = Viewer(page.port)
        bad.wait_for("Play")
        bad.send_raw(message)
    wrong = Viewer(page.port)
    for value in VALUES:
        wrong.set("size [m]", value)
        wrong.set("frame", value)
    wrong.send(type="GuiUpdateMessage", uuid="nobody", updates={"value": 1})
    wrong.send(type="GuiUpdateMessage", uuid=wrong.fields["Play"][0], updates={"nothing": 1})
    assert not watching.closed
    still_works(stage, page)


def test_a_click_on_a_page_that_is_still_being_made_is_heard(stage, page, monkeypatch):
    class Slow(Panel):
        def __init__(self, *given):
            time.sleep(0.3)
            super().__init__(*given)

    Viewer(page.port).wait_for("Play")
    monkeypatch.setattr("live.page.Panel", Slow)
    other = Viewer(page.port)
    other.press("Take over")
    other.press("Next frame")
    stage.until(lambda session: session.status.frame == 1)


def test_what_is_being_done_is_done_before_somebody_takes_over(stage, monkeypatch):
    happened = []

    def asked(name: str) -> None:
        happened.append(f"{name} begins")
        time.sleep(0.5 if name == "step" else 0.0)
        happened.append(f"{name} ends")

    for name in ("play", "step"):
        monkeypatch.setattr(stage.session, name, lambda name=name: asked(name))
    page = Page(stage.session, host="127.0.0.1", port=0)
    one = Viewer(page.port)
    one.wait_for("Set fluid")
    other = Viewer(page.port)
    other.wait_for("Take over")
    one.press("Next frame")
    stage.until(lambda session: happened)
    one.press("Next frame")
    other.press("Take over")
    other.press("Play")
    stage.until(lambda session: "play ends" in happened)
    assert happened == ["step begins", "step ends", "play begins", "play ends"]
    one.close()
    other.close()
    page.close()


def test_what_is_asked_for_fast_happens_in_order(stage, monkeypatch):
    happened = []

    def asked(name: str) -> None:
        time.sleep(0.05 if name == "pause" else 0.0)
        happened.append(name)

    for name in ("play", "pause", "step"):
        monkeypatch.setattr(stage.session, name, lambda name=name: asked(name))
    page = Page(stage.session, host="127.0.0.1", port=0)
    viewer = Viewer(page.port)
    for label in ["Pause", "Next frame", "Play"] * 5:
        viewer.press(label)
    stage.until(lambda session: len(happened) == 15)
    page.close()
    assert happened == ["pause", "step", "play"] * 5


def test_who_leaves_before_the_page_is_built_does_not_steer(stage, page):
    left = []
    page.server.on_client_disconnect(left.append)
    for _ in range(5):
        Viewer(page.port).close()
    stage.until(lambda session: len(left) == 5 and not page.viewers and not session.display.watched)
    viewer = Viewer(page.port)
    viewer.press("Next frame")
    stage.until(lambda session: session.status.frame == 1)


def test_uploads_that_are_no_mesh_or_too_large_are_refused(stage, page, tmp_path):
    viewer = Viewer(page.port)
    refused = [("pool.stl", b"solid nothing"), ("run.py", b"print(1)"), ("../../out.stl", b"")]
    for number, (name, content) in enumerate(refused):
        viewer.upload("Upload a mesh", name, content)
        stage.until(lambda session, number=number: len(viewer.told) > number)
    tracemalloc.start()
    viewer.upload("Upload a mesh", "large.stl", bytes(200_000_000))
    stage.until(lambda session: len(viewer.told) > len(refused))
    assert "has 200 MB, at most 50 are taken" in viewer.told[-1]
    held = kept(30_000_000)
    tracemalloc.stop()
    assert not held
    uploads = tmp_path / "scenes" / "uploads"
    assert not uploads.exists() or not list(uploads.iterdir())
    still_works(stage, page)


def test_only_one_of_two_steers(stage, page):
    first = Viewer(page.port)
    first.wait_for("Play")
    second = Viewer(page.port)
    second.press("Next frame")
    stage.until(lambda session: second.told)
    assert "somebody else steers" in second.told[0] and stage.session.status.frame == 0
    second.press("Take over")
    second.press("Next frame")
    stage.until(lambda session: session.status.frame == 1)
    first.press("Next frame")
    stage.until(lambda session: first.told)
    assert stage.session.status.frame == 1
    second.close()
    stage.until(lambda session: first.press("Next frame") or session.status.frame > 1)


def test_a_page_of_another_site_sees_and_does_nothing(stage, page, monkeypatch):
    """A browser that shows it would let it connect to this machine."""
    shared = []
    monkeypatch.setattr(page.server, "request_share_url", lambda: shared.append("published"))
    stranger = Viewer(page.port, origin="https://evil.example")
    stage.until(lambda session: stranger.told)
    stranger.send(type="ShareUrlRequest")
    assert "the address that the terminal shows" in stranger.told[0]
    own = Viewer(page.port, origin=f"http://127.0.0.1:{page.port}")
    own.press("Next frame")
    stage.until(lambda session: session.status.frame == 1)
    assert not stranger.fields and not stranger.pictures and not shared
    assert len(page.viewers) == 1


def test_who_does_not_know_the_token_sees_and_does_nothing(stage):
    page = Page(stage.session, host="127.0.0.1", port=0, token="the token")
    stranger = Viewer(page.port)
    stranger.set("token", "another")
    stranger.press("Enter")
    stage.until(lambda session: stranger.told)
    assert "not the token" in stranger.told[0]
    assert "Play" not in stranger.fields and stranger.pictures == 0
    friend = Viewer(page.port)
    friend.set("token", "the token")
    friend.press("Enter")
    friend.press("Next frame")
    stage.until(lambda session: session.status.frame == 1)
    assert "Play" not in stranger.fields and stranger.pictures == 0 < friend.pictures
    page.close()


def test_the_run_ends_with_the_last_viewer_only_if_asked(stage):
    page = Page(stage.session, host="127.0.0.1", port=0)
    viewer = Viewer(page.port)
    viewer.press("Play")
    stage.until(lambda session: session.status.frame >= 1)
    viewer.close()
    stage.until(lambda session: not page.viewers)
    frame = stage.session.status.frame
    stage.until(lambda session: session.clock.frame > frame)
    page.close()
    page = Page(stage.session, host="127.0.0.1", port=0, stop_when_left=True)
    viewer = Viewer(page.port)
    viewer.wait_for("Play")
    stage.until(lambda session: page.viewers)
    viewer.close()
    stage.until_closed()
    page.close()


@pytest.mark.parametrize(
    ("actions", "seconds"),
    [(200, 10), pytest.param(1000, 60, marks=[pytest.mark.slow, pytest.mark.timeout(900)])],
)
def test_random_actions_leave_it_whole(stage, page, actions, seconds):
    viewers = [Viewer(page.port), Viewer(page.port)]
    for viewer in viewers:
        viewer.wait_for("Set fluid")
    levels = []
    for _ in range(2):

        def watch() -> None:
            assert all_finite(stage.session)
            assert not any(viewer.closed for viewer in viewers)

        act_for(viewers, actions, seconds, watch)
        still_works(stage, page)
        levels.append(memory())
    assert levels[1] < levels[0] + 100, levels
