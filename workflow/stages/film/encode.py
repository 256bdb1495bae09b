"""Pictures become a film, by the ffmpeg that imageio-ffmpeg brings."""

from __future__ import annotations

import subprocess
from pathlib import Path

import imageio_ffmpeg

from scene.units import as_ratio
from workflow.stages.film.codecs import CODECS, Codec


class EncoderFailed(Exception):
    """ffmpeg ended with an error; the text is what it said."""


def encode(frames: Path, film: Path, *, fps: float, crf: int, codec: Codec = CODECS["h264"]) -> None:
    """Make `film` from frames/00000.png, 00001.png, ... shown at `fps` [Hz]; the same frames give the same bytes.

    Raises EncoderFailed.
    """
    reproducible = ["-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact", "-threads", "1"]
    command = [
        *(imageio_ffmpeg.get_ffmpeg_exe(), "-nostdin", "-hide_banner", "-loglevel", "error", "-y"),
        *("-framerate", str(as_ratio(fps) or f"{fps:.12g}"), "-i", "%05d.png"),
        *("-vf", codec.filters),
        *(*codec.options(crf), "-pix_fmt", codec.pixels),
        *reproducible,
        *("-f", codec.container, str(film.resolve())),
    ]
    # From within the folder, since a % in its name would be taken for a pattern, too.
    done = subprocess.run(command, cwd=frames, capture_output=True, text=True, errors="replace")
    if done.returncode:
        raise EncoderFailed(done.stderr.strip() or f"ffmpeg ended with exit code {done.returncode}")
