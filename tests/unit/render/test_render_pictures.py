"""PNG files are whole, and hold nothing but the picture."""

import io

import numpy as np
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from render.blender.pictures import without_metadata


def _png(**texts):
    info = PngInfo()
    for key, text in texts.items():
        info.add_text(key, text)
    file = io.BytesIO()
    Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)).save(file, "PNG", pnginfo=info)
    return file.getvalue()


def test_metadata_is_left_out_and_the_picture_is_kept():
    assert _png(time="1 s") != _png(time="2 s")
    assert without_metadata(_png(time="1 s")) == without_metadata(_png(time="2 s"))
    kept = np.asarray(Image.open(io.BytesIO(without_metadata(_png(time="1 s")))))
    assert (kept == np.arange(48).reshape(4, 4, 3)).all()


@pytest.mark.parametrize("cut", [1, 12, 30])
def test_a_file_cut_short_is_an_error(cut):
    with pytest.raises(ValueError, match="cut short"):
        without_metadata(_png()[:-cut])
