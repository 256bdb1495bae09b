"""Frames in, film out: read back by ffmpeg, byte-identical when made again."""

from __future__ import annotations

import json
import subprocess
from fractions import Fraction
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image, ImageSequence

from scene.settings import Refused
from workflow.film import main, run
from workflow.stages.film.contact_sheet import chosen, contact_sheet
from workflow.stages.film.spec import ALPHA, ContactSheet, FilmJobSpec, FilmSpec


@pytest.fixture(autouse=True)
def in_a_project(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def blocks(folder: Path, *lengths: int, size: tuple[int, int] = (65, 49)) -> list[Path]:
    """Folders of frames whose colours change with time."""
    made, frame = [], 0
    for index, length in enumerate(lengths):
        block = folder / f"block{index}"
        block.mkdir(parents=True)
        for _ in range(length):
            Image.new("RGB", size, (20 * frame % 256, 100, 200)).save(block / f"{frame:05d}.png")
            frame += 1
        (block / "summary.json").write_text(
            json.dumps({"status": "done", "versions": {"blender": "4"}, "wall_s": {"render": 2.0, "total": 3.0}})
        )
        made.append(block)
    return made


def segments(folder: Path) -> list[Path]:
    made = []
    for index in range(2):
        segment = folder / f"segment{index}"
        segment.mkdir(parents=True)
        columns = "step,time,dt,wall_s,n_fluid,kinetic_energy" + (",contacts" if index else "")
        rows = [f"{5 * index + i},{0.1 * (5 * index + i)},0.1,0.5,10,{i}" + (",1" if index else "") for i in range(5)]
        (segment / "steps.csv").write_text("\n".join([columns, *rows]) + "\n")
        summary = {
            "status": "done",
            "counts": {"steps": 5, "particles": 10 + index, "retries": index},
            "simulated_s": 0.5,
            "wall_s": {"compile": 1.0, "total": 4.0},
        }
        (segment / "summary.json").write_text(json.dumps(summary))
        made.append(segment)
    return made


def spec(last_frame: int, **film) -> FilmJobSpec:
    return FilmJobSpec(name="tiny/pond", fps=8, last_frame=last_frame, film=FilmSpec(**film))


def read_back(video: Path) -> tuple[dict, int]:
    """What ffmpeg says of a film, and its number of frames."""
    reader = imageio_ffmpeg.read_frames(str(video))
    meta = next(reader)
    reader.close()
    return meta, imageio_ffmpeg.count_frames_and_secs(str(video))[0]


BARS = [(30, 200, 30), (200, 30, 30), (30, 30, 200), (235, 235, 16), (16, 235, 235), (128, 128, 128), (255, 255, 255)]
TAGGED = {
    "h264": "pond.mp4",
    "h265": "pond.h265.mp4",
    "av1": "pond.av1.mp4",
    "vp9": "pond.webm",
    "prores": "pond.mov",
}
BAR = 32


def bars(folder: Path, height: int) -> Path:
    """One frame of bars in these colours [px]."""
    folder.mkdir()
    picture = np.repeat(np.array(BARS, np.uint8)[None], height, axis=0).repeat(BAR, axis=1)
    Image.fromarray(picture).save(folder / "00000.png")
    return folder


def planes(video: Path, height: int) -> np.ndarray:
    """Y', Cb and Cr of the first frame as the file has them, of eight bits, shape [height, width, 3]."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-i", video, "-frames:v", "1"]
    command += ["-vf", "format=yuv444p", "-f", "rawvideo", "-"]
    raw = subprocess.run(list(map(str, command)), capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(3, height, -1).transpose(1, 2, 0)


def shown(planes: np.ndarray) -> np.ndarray:
    """R'G'B' as a player finds them by ITU-R BT.709-6, sec. 3.2 to 3.5, from 0 to 255."""
    luma, blue, red = (planes[..., 0] - 16.0) / 219, (planes[..., 1] - 128.0) / 224, (planes[..., 2] - 128.0) / 224
    r, b = luma + 1.5748 * red, luma + 1.8556 * blue
    g = (luma - 0.2126 * r - 0.0722 * b) / 0.7152
    return 255 * np.clip(np.stack([r, g, b], axis=-1), 0, 1)


@pytest.mark.parametrize("height", [48, 720])
@pytest.mark.parametrize("codec", TAGGED)
def test_colours_are_those_of_the_pictures(tmp_path, codec, height):
    """Rounding to eight bits of Y'CbCr moves R'G'B' by 2 at most; 1 more for what the encoder leaves out."""
    run(spec(0, also=[codec] if codec != "h264" else []), [bars(tmp_path / "block", height)], tmp_path / "out")
    video = tmp_path / "out" / TAGGED[codec]
    found = shown(planes(video, height))[height // 2, BAR // 2 :: BAR]
    assert np.abs(found - BARS).max() <= 3
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-i", video]
    told = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False).stderr
    assert "(tv, bt709/bt709/iec61966-2-1" in told


@pytest.mark.parametrize(("codec", "file", "error"), [("webp", "pond.webp", 6), ("gif", "pond.gif", 1)])
def test_films_for_pages_have_all_frames_and_colours(tmp_path, codec, file, error):
    """WebP has half the colours of BT.601, as its format says; a GIF has any 256 colours."""
    run(spec(6, also=[codec]), blocks(tmp_path, 5, 2), tmp_path / "out")
    with Image.open(tmp_path / "out" / file) as film:
        assert (film.format, film.size) == (codec.upper(), (65, 49))
        assert len(list(ImageSequence.Iterator(film))) == 7
        for frame in range(7):
            film.seek(frame)
            middle = film.convert("RGB").getpixel((32, 24))
            assert np.abs(np.subtract(middle, (20 * frame, 100, 200))).max() <= error
            assert film.info["duration"] in (120, 125, 130)


ALPHA_FILES = {"prores": "pond.mov", "vp9": "pond.webm", "webp": "pond.webp"}


def clear_frames(folder: Path) -> Path:
    """Two frames: nothing on the left, half of a colour in the middle, all of it on the right."""
    folder.mkdir()
    picture = np.zeros((48, 96, 4), np.uint8)
    picture[..., :3] = 200, 60, 40
    picture[:, 32:64, 3], picture[:, 64:, 3] = 128, 255
    for frame in range(2):
        Image.fromarray(picture).save(folder / f"{frame:05d}.png")
    return folder


def read_alpha(video: Path) -> np.ndarray:
    """The first frame of a film, shape [48, 96, 4]."""
    if video.suffix == ".webp":
        with Image.open(video) as film:
            return np.asarray(film.convert("RGBA"))
    decoder = ["-c:v", "libvpx-vp9"] if video.suffix == ".webm" else []
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", *decoder, "-i", str(video), "-frames:v", "1"]
    raw = subprocess.run([*command, "-pix_fmt", "rgba", "-f", "rawvideo", "-"], capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(48, 96, 4)


def transparent(**film) -> FilmJobSpec:
    return FilmJobSpec(name="tiny/pond", fps=8, last_frame=1, transparent=True, film=FilmSpec(**film))


@pytest.mark.parametrize("codec", ALPHA)
def test_alpha_is_kept(tmp_path, codec):
    run(transparent(also=[codec]), [clear_frames(tmp_path / "block")], tmp_path / "out")
    found = read_alpha(tmp_path / "out" / ALPHA_FILES[codec]).astype(int)
    assert np.abs(found[24, [16, 48, 80], 3] - (0, 128, 255)).max() <= 3
    assert np.abs(found[24, 80, :3] - (200, 60, 40)).max() <= 6


def test_the_mp4_shows_what_is_clear_on_the_paper_of_the_contact_sheet(tmp_path):
    run(transparent(), [clear_frames(tmp_path / "block")], tmp_path / "out")
    found = shown(planes(tmp_path / "out" / "pond.mp4", 48))[24, [16, 48, 80]]
    paper, colour = np.array([0xF6, 0xF5, 0xF2]), np.array([200, 60, 40])
    assert np.abs(found - [paper, (paper + colour) / 2, colour]).max() <= 4
    assert all((tmp_path / "out" / "frames" / f"0000{k}.png").exists() for k in (0, 1))


@pytest.mark.parametrize("codec", ["h265", "av1", "gif"])
def test_formats_without_alpha_are_refused(tmp_path, codec):
    with pytest.raises(Refused, match=f"'{codec}' cannot keep the transparent background.*prores, vp9 or webp"):
        run(transparent(also=["webp", codec]), [clear_frames(tmp_path / "block")], tmp_path / "out")


def test_vp9_without_transparency(tmp_path):
    run(spec(6, also=["vp9"]), blocks(tmp_path, 7), tmp_path / "out")
    meta, count = read_back(tmp_path / "out" / "pond.webm")
    assert (meta["codec"], count, "yuv420p" in meta["pix_fmt"]) == ("vp9", 7, True)


def test_formats_are_the_same_bytes_again(tmp_path):
    frames = blocks(tmp_path, 3)
    for name in ("one", "two"):
        run(spec(2, also=["h265", "av1", "vp9", "prores", "webp", "gif"]), frames, tmp_path / name)
    made = sorted(path.name for path in (tmp_path / "one").glob("pond.*"))
    assert made == ["pond.av1.mp4", "pond.gif", "pond.h265.mp4", "pond.mov", "pond.mp4", "pond.webm", "pond.webp"]
    assert all((tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes() for name in made)


@pytest.mark.parametrize("size", [(64, 48), (65, 49), (65, 48), (2, 3)])
def test_frames_rate_and_size(tmp_path, size):
    run(spec(6), blocks(tmp_path, 5, 2, size=size), tmp_path / "out")
    meta, count = read_back(tmp_path / "out" / "pond.mp4")
    assert count == 7
    assert meta["fps"] == pytest.approx(8)
    assert meta["source_size"] == tuple(edge + edge % 2 for edge in size)
    assert meta["codec"] == "h264"
    assert "yuv420p" in meta["pix_fmt"]
    assert len(list((tmp_path / "out" / "frames").glob("*.png"))) == 7


@pytest.mark.parametrize("fps", [2, 23.976, 120])
def test_playback_rate(tmp_path, fps):
    run(spec(6, playback_fps=fps), blocks(tmp_path, 7), tmp_path / "out")
    meta, count = read_back(tmp_path / "out" / "pond.mp4")
    assert count == 7
    assert meta["fps"] == pytest.approx(fps, abs=0.01)


@pytest.mark.parametrize(
    ("fps", "ratio"),
    [
        (24, (24, 1)),
        ("24000/1001", (24000, 1001)),
        ("30000/1001", (30000, 1001)),
        (23.976, (2997, 125)),
        (12.5, (25, 2)),
    ],
)
@pytest.mark.parametrize("codec", ["h264", "h265", "prores"])
def test_frames_are_as_far_apart_as_the_ratio_says(tmp_path, fps, ratio, codec):
    """In units of the file's own clock: no drift, however long the film is."""
    run(spec(6, playback_fps=fps, also=[codec] if codec != "h264" else []), blocks(tmp_path, 7), tmp_path / "out")
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-i", str(tmp_path / "out" / TAGGED[codec])]
    told = subprocess.run([*command, "-c", "copy", "-f", "framecrc", "-"], capture_output=True, text=True, check=True)
    lines = told.stdout.splitlines()
    tick = Fraction(next(line for line in lines if line.startswith("#tb 0: ")).removeprefix("#tb 0: "))
    times = sorted(int(line.split(",")[2]) * tick for line in lines if not line.startswith("#"))
    assert [time - times[0] for time in times] == [frame * Fraction(ratio[1], ratio[0]) for frame in range(7)]
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["playback_ratio"] == str(Fraction(*ratio))


def test_the_same_frames_give_the_same_bytes(tmp_path):
    frames, simulation = blocks(tmp_path, 4), segments(tmp_path)
    for name in ("first", "second"):
        run(spec(3), frames, tmp_path / name, simulation=simulation)
    for name in ("pond.mp4", "contact.png", "plots.png", "steps.csv"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes(), name


def test_a_frame_more_than_the_film_has_is_left_out(tmp_path):
    run(spec(2), blocks(tmp_path, 5), tmp_path / "out")
    assert read_back(tmp_path / "out" / "pond.mp4")[1] == 3


def test_a_missing_frame_is_refused(tmp_path):
    made = blocks(tmp_path, 3, 2)
    (made[1] / "00004.png").unlink()
    with pytest.raises(Refused, match=r"1 of 5 frames are missing, first 00004\.png"):
        run(spec(4), made, tmp_path / "out")


def test_pictures_that_do_not_fit_together_are_refused(tmp_path):
    made = blocks(tmp_path, 3)
    Image.new("RGB", (10, 10)).save(made[0] / "00001.png")
    with pytest.raises(Refused, match="differ in size"):
        run(spec(2), made, tmp_path / "out")
    (made[0] / "00001.png").write_bytes(b"no picture")
    with pytest.raises(Refused, match="not a picture"):
        run(spec(2), made, tmp_path / "out")


def test_summary_and_tables(tmp_path):
    run(spec(4), blocks(tmp_path, 3, 2), tmp_path / "out", simulation=segments(tmp_path))
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "done"
    assert (summary["name"], summary["frames"], summary["size"]) == ("tiny/pond", 5, [65, 49])
    assert summary["counts"] == {"steps": 10, "particles": 11, "retries": 1}
    assert summary["simulated_s"] == pytest.approx(1.0)
    assert summary["wall_s"]["simulate"] == {"compile": 2.0, "total": 8.0}
    assert summary["wall_s"]["render"] == {"render": 4.0, "total": 6.0}
    assert summary["particle_steps_per_s"] == pytest.approx(10 / 0.5)
    assert summary["versions"]["blender"] == "4"
    lines = (tmp_path / "out" / "steps.csv").read_text().splitlines()
    assert len(lines) == 11
    assert lines[0].endswith("kinetic_energy,contacts")
    assert lines[1].endswith(",0,")
    assert (tmp_path / "out" / "plots.png").stat().st_size > 5000
    assert not (tmp_path / "out" / "probes.csv").exists()


def test_a_stage_that_did_not_end_well_shows_in_the_status(tmp_path):
    made = blocks(tmp_path, 2)
    (made[0] / "summary.json").write_text('{"status": "stopped"}')
    run(spec(1), made, tmp_path / "out")
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["status"] == "stopped"


def test_the_copy_stays_in_the_project(tmp_path):
    run(spec(1, copy_to="gallery/a.mp4"), blocks(tmp_path, 2), tmp_path / "out")
    assert (tmp_path / "gallery" / "a.mp4").read_bytes() == (tmp_path / "out" / "pond.mp4").read_bytes()
    (tmp_path / "elsewhere").symlink_to("/tmp")
    for path in ("../a.mp4", "/tmp/a.mp4", "elsewhere/a.mp4", "renders/a.mp4", "results/x/a.mp4", ".git/a.mp4"):
        with pytest.raises(Refused, match="copy_to"):
            FilmSpec(copy_to=path).copy_path(tmp_path)


def test_exit_codes(tmp_path, capsys):
    made = blocks(tmp_path, 2)
    given = ["--frames-from", str(made[0]), "--out", str(tmp_path / "out"), "--spec"]
    assert main([*given, '{"name": "a", "fps": 8, "last_frame": 1}']) == 0
    assert main([*given, '{"name": "a", "fps": 8, "last_frame": 2}']) == 2
    assert main([*given, '{"name": "a", "fps": "fast"}']) == 2
    assert "film: " in capsys.readouterr().err


@pytest.mark.parametrize(("frames", "wanted"), [(1, 12), (2, 12), (12, 12), (49, 12), (600, 7), (5, 1)])
def test_frames_of_the_contact_sheet(frames, wanted):
    found = chosen(frames, wanted)
    assert len(found) == len(set(found)) == min(frames, wanted)
    assert found == sorted(found)
    assert found[0] == 0
    assert wanted == 1 or found[-1] == frames - 1


@pytest.mark.parametrize(("frames", "columns", "width"), [(1, 4, 1920), (12, 4, 1920), (5, 2, 300), (400, 40, 1000)])
def test_size_of_the_contact_sheet(tmp_path, frames, columns, width):
    pictures = sorted(blocks(tmp_path, frames)[0].glob("*.png"))
    look = ContactSheet(frames=frames, columns=columns, width=width)
    sheet = contact_sheet(pictures, fps=8, title="a pond", spec=look)
    assert sheet.width == width
    colours = sheet.getcolors(maxcolors=1 << 24)
    assert len(colours) > 2
