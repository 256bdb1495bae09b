"""How films are written: the one that plays everywhere, and those for editing, for pages and for small files.

Pictures are sRGB. Players take the matrix of BT.709 for larger films and that of BT.601 for smaller ones where a file
says nothing, so it is converted to BT.709 (ITU-R BT.709-6, sec. 3) and said in the file.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

VIDEO = ",".join(
    (
        "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int",
        "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=black@0",
        "setparams=color_primaries=bt709:color_trc=iec61966-2-1:colorspace=bt709:range=tv",
    )
)
"""Odd sizes are padded to even ones, as colours at half the resolution need."""
PALETTE = "split[whole][sample];[sample]palettegen[palette];[whole][palette]paletteuse"
"""The 256 colours of a GIF are those of the film at hand."""
ON_PAPER = "split[under][over];[under]drawbox=t=fill:color=0xf6f5f2:replace=1[paper];[paper][over]overlay=format=gbrp"
"""The colour of contact sheets."""


@dataclass(frozen=True)
class Codec:
    """A format of films."""

    suffix: str
    """What follows the name of the film."""
    container: str
    """As ffmpeg calls it."""
    pixels: str
    """As ffmpeg calls them."""
    options: Callable[[int], tuple[str, ...]]
    """Of the encoder, for a quality from 0, the best, to 51."""
    filters: str = VIDEO
    alpha: str | None = None
    """As `pixels`, of pictures with an alpha channel; None where the format has none."""
    alpha_options: tuple[str, ...] = ()
    """Of the encoder, for these."""

    def transparent(self) -> Codec:
        """The same for pictures with an alpha channel: what cannot keep it shows them on paper."""
        if self.alpha is None:
            return replace(self, filters=f"{ON_PAPER},{self.filters}")
        options = self.options
        return replace(
            self, pixels=self.alpha, options=lambda crf: (*options(crf), *self.alpha_options), filters=self.filters
        )


def _h264(crf: int) -> tuple[str, ...]:
    return ("-c:v", "libx264", "-crf", str(crf), "-movflags", "+faststart")


def _h265(crf: int) -> tuple[str, ...]:
    """A quality of 18 looks as 22 does here."""
    coding = (
        "-c:v",
        "libx265",
        "-crf",
        str(min(crf + 4, 51)),
        "-x265-params",
        "log-level=error:pools=1:frame-threads=1",
    )
    return (*coding, "-tag:v", "hvc1", "-movflags", "+faststart")


def _av1(crf: int) -> tuple[str, ...]:
    """Qualities go up to 63."""
    coding = ("-c:v", "libsvtav1", "-crf", str(max(1, min(round(1.2 * crf) + 4, 63))), "-preset", "6")
    return (*coding, "-svtav1-params", "lp=1", "-movflags", "+faststart")


def _prores(_crf: int) -> tuple[str, ...]:
    return ("-c:v", "prores_ks", "-profile:v", "hq", "-vendor", "apl0")


def _vp9(crf: int) -> tuple[str, ...]:
    """Qualities go up to 63."""
    return ("-c:v", "libvpx-vp9", "-crf", str(min(round(1.2 * crf) + 6, 63)), "-b:v", "0", "-cpu-used", "4")


def _webp(crf: int) -> tuple[str, ...]:
    return ("-c:v", "libwebp_anim", "-quality", str(100 - round(1.4 * crf)), "-loop", "0")


def _gif(_crf: int) -> tuple[str, ...]:
    return ("-c:v", "gif", "-loop", "0")


CODECS = {
    "h264": Codec(".mp4", "mp4", "yuv420p", _h264),
    "h265": Codec(".h265.mp4", "mp4", "yuv420p10le", _h265),
    "av1": Codec(".av1.mp4", "mp4", "yuv420p10le", _av1),
    "prores": Codec(".mov", "mov", "yuv422p10le", _prores, alpha="yuva444p10le", alpha_options=("-profile:v", "4444")),
    "vp9": Codec(".webm", "webm", "yuv420p", _vp9, alpha="yuva420p", alpha_options=("-auto-alt-ref", "0")),
    "webp": Codec(".webp", "webp", "bgra", _webp, filters="null", alpha="bgra"),
    "gif": Codec(".gif", "gif", "pal8", _gif, filters=PALETTE),
}
