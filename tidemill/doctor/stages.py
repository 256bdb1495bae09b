"""The programs behind the stages, each tried on something small."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

from tidemill.doctor.finding import Finding, ok, warning, wrong
from tidemill.doctor.trial import Trial, attempt

KERNEL = """
import taichi as ti
ti.init(arch=ti.{arch}, log_level=ti.ERROR, offline_cache=False)
if ti.lang.impl.current_cfg().arch != ti.{arch}:
    raise SystemExit("there is none")
x = ti.field(ti.f32, 8)
@ti.kernel
def fill():
    for i in x:
        x[i] = 2.0 * i
fill()
assert x[7] == 14.0
"""
ENCODER = "import imageio_ffmpeg as f; print(f.get_ffmpeg_version())"
FONT = "from matplotlib import font_manager as f; print(f.findfont(f.FontProperties(), fallback_to_default=False))"
REINSTALL = "reinstall its package: pip install --force-reinstall --no-deps "
EXTENT = {"extent": {"min": [-0.5, 0, -0.5], "max": [0.5, 1, 0.5]}}
PICTURE = {"resolution": [64, 36], "samples": 1}


def simulation() -> Finding:
    """Taichi, on the processors."""
    trial = _kernel("cpu")
    if trial.reason:
        return wrong("simulation", f"Taichi cannot compile: {trial.reason}", REINSTALL + "taichi")
    return ok("simulation", f"Taichi compiles and runs a kernel, in {trial.seconds:.1f} s")


def gpu() -> Finding:
    """Taichi, on a GPU; most machines have none that counts."""
    trial = _kernel("cuda")
    if trial.reason:
        return ok("GPU", "no CUDA: simulations run on the processors")
    return ok("GPU", "CUDA: simulations run there unless --arch cpu is given")


def _kernel(arch: str) -> Trial:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "kernel.py")
        file.write_text(KERNEL.format(arch=arch))
        return attempt([file])


def encoder() -> Finding:
    """The program that encodes films."""
    trial = attempt(["-c", ENCODER])
    if trial.reason:
        return wrong("encoder", f"ffmpeg does not run: {trial.reason}", REINSTALL + "imageio-ffmpeg")
    return ok("encoder", f"ffmpeg {trial.printed.strip()}")


def fonts() -> Finding:
    """Those of plots."""
    trial = attempt(["-c", FONT])
    if trial.reason:
        return warning("fonts", f"plots have no font: {trial.reason}", "on Debian and Ubuntu: fonts-dejavu-core")
    return ok("fonts", Path(trial.printed.strip().splitlines()[-1]).stem)


def picture() -> Finding:
    """The stage that renders, on an empty scene: one picture of 64 by 36."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "summary.json").write_text(json.dumps(EXTENT))
        words: list[str | Path] = [
            "-m",
            "render",
            "--spec",
            json.dumps(PICTURE),
            "--simulation",
            folder,
            "--frames",
            "0:0",
        ]
        trial = attempt([*words, "--out", folder / "pictures"])
        if not trial.reason and not (folder / "pictures" / "00000.png").is_file():
            return wrong("pictures", "Blender ended well and left no picture", REINSTALL + "bpy")
    if trial.reason:
        return wrong("pictures", f"Blender does not render: {trial.reason}", "mend what is wrong above first")
    return ok("pictures", f"Blender renders one, in {trial.seconds:.1f} s")
