"""One picture of a whole film: frames in a grid, each with its time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from workflow.film_spec import ContactSheet

PAPER = "#f6f5f2"
INK = "#1f2933"
FAINT = "#7b8794"


def chosen(frames: int, wanted: int) -> list[int]:
    """Up to `wanted` of the frames 0 to frames - 1, evenly spread, the first and the last among them."""
    count = min(frames, wanted)
    return [0] if count == 1 else [round(index * (frames - 1) / (count - 1)) for index in range(count)]


def contact_sheet(pictures: Sequence[Path], *, fps: float, title: str, spec: ContactSheet) -> Image.Image:
    """The sheet of a film's pictures, in order, `fps` frames per simulated second [Hz]."""
    frames = chosen(len(pictures), spec.frames)
    columns = min(spec.columns, len(frames))
    rows = -(-len(frames) // columns)
    with Image.open(pictures[0]) as first:
        ratio = first.height / first.width
    edge, gap = max(1, spec.width // 60), max(1, spec.width // 120)
    width = max(1, (spec.width - 2 * edge - (columns - 1) * gap) // columns)
    height = max(1, round(width * ratio))
    text = max(8, min(spec.width // 70, width // 9))
    caption, header = round(2.0 * text), round(3.2 * text)
    sheet = Image.new("RGB", (spec.width, header + rows * (height + caption + gap) + edge), PAPER)
    draw = ImageDraw.Draw(sheet)
    large, small = ImageFont.load_default(1.35 * text), ImageFont.load_default(text)
    draw.text((edge, header * 0.55), title, INK, large, anchor="lm")
    about = f"{(len(pictures) - 1) / fps:.4g} s, {len(pictures)} frames, {fps:g} per second"
    if draw.textlength(title, large) + draw.textlength(about, small) < spec.width - 3 * edge:
        draw.text((spec.width - edge, header * 0.55), about, FAINT, small, anchor="rm")
    for index, frame in enumerate(frames):
        left = edge + index % columns * (width + gap)
        top = header + index // columns * (height + caption + gap)
        with Image.open(pictures[frame]) as picture:
            sheet.paste(_flat(picture).resize((width, height), Image.Resampling.LANCZOS), (left, top))
        middle = top + height + caption / 2
        draw.text((left, middle), f"{frame / fps:.2f} s", INK, small, anchor="lm")
        draw.text((left + width, middle), f"{frame}", FAINT, small, anchor="rm")
    return sheet


def _flat(picture: Image.Image) -> Image.Image:
    """The picture without transparency."""
    if picture.mode not in {"RGBA", "LA", "PA"}:
        return picture.convert("RGB")
    base = Image.new("RGBA", picture.size, PAPER)
    return Image.alpha_composite(base, picture.convert("RGBA")).convert("RGB")
