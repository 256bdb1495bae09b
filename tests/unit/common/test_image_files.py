"""Pictures that end too early are told from whole ones."""

import io

import pytest
from PIL import Image

from common.imported.image_files import cut_off, too_large

IMAGE = Image.effect_noise((64, 64), 80)


def saved(kind: str) -> bytes:
    stream = io.BytesIO()
    IMAGE.save(stream, kind)
    return stream.getvalue()


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "TIFF"])
def test_a_whole_picture_and_what_is_left_of_it(kind):
    whole = saved(kind)
    assert not cut_off(whole)
    assert [size for size in (8, 20, 100, len(whole) // 2, len(whole) - 20) if not cut_off(whole[:size])] == []


def test_what_follows_a_picture_does_not_matter():
    for kind in ("PNG", "JPEG", "TIFF"):
        assert not cut_off(saved(kind) + b"\0" * 500)


def test_a_small_picture_within_the_head_of_a_photograph_is_not_its_end():
    """As cameras write them: two bytes of marker, two of length, then a whole JPEG."""
    small, whole = saved("JPEG"), saved("JPEG")
    head = b"\xff\xe1" + (len(small) + 2).to_bytes(2, "big") + small
    photograph = whole[:2] + head + whole[2:]
    assert not cut_off(photograph)
    assert cut_off(photograph[: len(photograph) // 2 + len(head) // 2 + 100])


def test_of_other_formats_nothing_is_known():
    assert not cut_off(b"#?RADIANCE\n") and not cut_off(b"")


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "TIFF"])
@pytest.mark.parametrize(("size", "large"), [((16384, 1), False), ((16385, 1), True), ((1, 16385), True)])
def test_large_images_are_told_by_their_heads(kind, size, large):
    stream = io.BytesIO()
    Image.new("L", size).save(stream, kind)
    assert too_large(stream.getvalue()) == large


def test_of_what_is_no_image_no_size_is_known():
    for content in (b"", b"#?RADIANCE\n", b"\x89PNG\r\n\x1a\n", b"\xff\xd8", b"\xff\xd8\xff\xe0", b"II*\0\1"):
        assert not too_large(content)
