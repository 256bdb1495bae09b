"""Pictures as studies compare them."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from workflow.study.pictures import difference, read


def test_what_is_transparent_counts_as_the_paper_it_lies_on(tmp_path):
    """Colours that alpha hides do not count, and alpha itself does."""
    for name, pixel in {"red": (255, 0, 0, 0), "blue": (0, 0, 255, 0), "black": (0, 0, 0, 255)}.items():
        (tmp_path / name).mkdir()
        Image.new("RGBA", (4, 3), pixel).save(tmp_path / name / "00000.png")
    red, blue, black = (read(tmp_path / name) for name in ("red", "blue", "black"))
    assert difference(red, blue) == 0
    assert difference(black, blue) == pytest.approx(np.sqrt(np.mean(np.square([0xF6, 0xF5, 0xF2]))) / 255)
