"""A range of frames, and its text."""

from __future__ import annotations

import pytest

from common.frames import Frames


def test_frames_as_text():
    assert str(Frames(13, 24)) == "13:24"
    assert Frames.parse("13:24") == Frames(13, 24)
    assert len(Frames(13, 24)) == 12
    for text in ("24:13", "3", "a:b", "-1:3", ""):
        with pytest.raises(ValueError, match="FIRST:LAST"):
            Frames.parse(text)
