"""The page of looks is that of its file, and shows every look."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from PIL import Image

from render.looks.spec import OWN
from render.spec import RenderSpec
from scene.document import SceneError
from workflow.gallery.looks import pictures
from workflow.gallery.looks.exhibits import FOLDER, PAGE, exhibits
from workflow.gallery.looks.page import page

ROOT = Path(__file__).resolve().parents[3]
SHOWN = exhibits(ROOT)


def shown(exhibit):
    """The look that the lines of a scene give."""
    render = yaml.safe_load(exhibit.lines)
    RenderSpec.model_validate(render)
    return render.get("water") or next(iter(render["materials"].values()))


def test_the_page_is_up_to_date():
    assert (ROOT / PAGE).read_text() == page(SHOWN), "run python -m workflow.gallery.looks"


def test_every_look_is_shown():
    types = {look.model_fields["type"].annotation.__args__[0] for look in OWN}
    assert {shown(exhibit)["type"] for exhibit in SHOWN.exhibits} == types


@pytest.mark.parametrize("exhibit", SHOWN.exhibits, ids=lambda exhibit: exhibit.name)
def test_its_picture_is_there_and_small(exhibit):
    assert 1000 < (ROOT / FOLDER / f"{exhibit.name}.jpg").stat().st_size <= pictures.MOST_BYTES


def test_no_picture_is_left_of_what_is_shown_no_more():
    names = {exhibit.name for exhibit in SHOWN.exhibits}
    assert {path.stem for path in (ROOT / FOLDER).iterdir()} == names


def test_a_look_on_a_stand_that_is_not_there_is_refused(tmp_path):
    (tmp_path / "docs/gallery").mkdir(parents=True)
    one = {"name": "a", "says": "", "seen": "", "on": "shelf", "lines": "water: {}"}
    content = {"intro": "", "stands": {"ball": {}, "block": {}}, "exhibits": [one]}
    (tmp_path / "docs/gallery/looks.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(SceneError, match="a is shown on 'shelf'\n  fix: use one of ball, block"):
        exhibits(tmp_path)


@pytest.mark.parametrize("name", ["rubber", "glass"])
def test_a_picture_is_made_by_the_commands_of_the_stages(tmp_path, monkeypatch, name):
    """One dry and one with water, as small as can be."""
    monkeypatch.setattr(pictures, "PICTURE", {"resolution": [16, 16], "samples": 1, "ground": {"enabled": False}})
    exhibit = next(exhibit for exhibit in SHOWN.exhibits if exhibit.name == name)
    pictures.picture(exhibit, SHOWN, tmp_path / "look.jpg", tmp_path)
    with Image.open(tmp_path / "look.jpg") as made:
        assert made.size == (16, 16)
