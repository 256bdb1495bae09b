"""The page of the gallery is that of its files, and shows every scene."""

from __future__ import annotations

import json
import re
from pathlib import Path

from workflow.gallery.page import page
from workflow.gallery.shots import FOLDER, PAGE, Shot, Shots, shots
from workflow.plan.shelf import SCENE_FILES

ROOT = Path(__file__).resolve().parents[3]
SHOT = {"title": "Pond", "says": "It is still.", "seen": "A pond", "frame": 3}
RECORD = {
    "command": "snakemake --cores 2 renders/pond",
    "quality": "standard",
    "picture": {"quality": "final", "particles": 9876543},
    "frames": 49,
    "fps": 24.0,
    "size": [640, 360],
    "particles": 1234567,
    "wall_s": {"simulate": 99.4, "reconstruct": 12.0, "render": 1190.8, "film": 2.0},
}


def test_the_page_is_up_to_date():
    assert (ROOT / PAGE).read_text() == page(shots(ROOT), ROOT), "run python -m workflow.gallery"


def test_what_the_page_links_is_there():
    text = (ROOT / PAGE).read_text()
    for target in re.findall(r"\]\(([^)]+)\)", text):
        assert (ROOT / "docs" / target).exists(), target


def test_every_scene_has_a_shot():
    known = {name for name in SCENE_FILES.names() if "/" not in name}
    assert {shot.scene for shot in shots(ROOT).shots} == known


def test_figures_are_those_of_the_record(tmp_path):
    (tmp_path / FOLDER).mkdir(parents=True)
    (tmp_path / FOLDER / "pond.json").write_text(json.dumps(RECORD))
    gallery = Shots(intro="Films.", shots=(Shot(scene="pond", **SHOT), Shot(scene="lake", **SHOT)))
    text = page(gallery, tmp_path)
    assert "| 49 of 640 x 360, 24 a second | 1,234,567 | 99 s | 12 s | 20 min | final, 9,876,543 particles |" in text
    assert "`snakemake --cores 2 renders/pond`" in text
    assert "Not shown here yet: [lake](../scenes/lake.yaml)." in text
