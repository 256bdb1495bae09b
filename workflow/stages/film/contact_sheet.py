"""One picture of many: the frames of a film in a grid, each with its time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from workflow.stages.film.spec import ContactSheet

PAPER = "#f6f5f2"
INK = "#1f2933"
FAINT = "#7b8794"


def chosen(frames: int, wanted: int) -> list[int]:
    """Up to `wanted` of the frames 0 to frames - 1, evenly spread, the first and the last among them."""
    count = min(frames, wanted)
    return [0] if count == 1 else [round(index * (frames - 1) / (count - 1)) for index in range(count)]


@dataclass(frozen=True)
class Cell:
    """A picture, and what stands below it on the left and on the right."""

    picture: Path
    left: str
    right: str


def contact_sheet(pictures: Sequence[Path], *, fps: float, title: str, spec: ContactSheet) -> Image.Image:
    """The sheet of a film's pictures, in order, `fps` frames per simulated second [Hz]."""
    frames = chosen(len(pictures), spec.frames)
    cells = [Cell(pictures[frame], f"{frame / fps:.2f} s", f"{frame}") for frame in frames]
    about = f"{(len(pictures) - 1) / fps:.4g} s, {len(pictures)} frames, {fps:g} per second"
    return draw_sheet(cells, columns=min(spec.columns, len(frames)), width=spec.width, title=title, about=about)


def draw_sheet(cells: Sequence[Cell], *, columns: int, width: int, title: str, about: str) -> Image.Image:
    """Pictures of the size of the first in rows; `width` of the sheet [px]."""
    rows = -(-len(cells) // columns)
    with Image.open(cells[0].picture) as first:
        ratio = first.height / first.width
    edge, gap = max(1, width // 60), max(1, width // 120)
    across = max(1, (width - 2 * edge - (columns - 1) * gap) // columns)
    height = max(1, round(across * ratio))
    text = max(8, min(width // 70, across // 9))
    caption, header = round(2.0 * text), round(3.2 * text)
    sheet = Image.new("RGB", (width, header + rows * (height + caption + gap) + edge), PAPER)
    draw = ImageDraw.Draw(sheet)
    large, small = ImageFont.load_default(1.35 * text), ImageFont.load_default(text)
    draw.text((edge, header * 0.55), title, INK, large, anchor="lm")
    if draw.textlength(title, large) + draw.textlength(about, small) < width - 3 * edge:
        draw.text((width - edge, header * 0.55), about, FAINT, small, anchor="rm")
    for index, cell in enumerate(cells):
        left = edge + index % columns * (across + gap)
        top = header + index // columns * (height + caption + gap)
        with Image.open(cell.picture) as picture:
            sheet.paste(flat(picture).resize((across, height), Image.Resampling.LANCZOS), (left, top))
        middle = top + height + caption / 2
        draw.text((left, middle), cell.left, INK, small, anchor="lm")
        draw.text((left + across, middle), cell.right, FAINT, small, anchor="rm")
    return sheet


def flat(picture: Image.Image) -> Image.Image:
    """The picture without transparency: on paper."""
    if picture.mode not in {"RGBA", "LA", "PA"}:
        return picture.convert("RGB")
    base = Image.new("RGBA", picture.size, PAPER)
    return Image.alpha_composite(base, picture.convert("RGBA")).convert("RGB")
