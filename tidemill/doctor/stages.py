"""The programs behind the stages, each tried on something small."""

from __future__ import annotations

import json
import shutil
import tempfile
from importlib.util import find_spec
from pathlib import Path

from render import program
from sim.device.compiler_choice import chosen
from tidemill.doctor.finding import Finding, ok, warning, wrong
from tidemill.doctor.trial import Trial, attempt

KERNEL = """
import {compiler} as ti
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
        return wrong("simulation", f"Taichi cannot compile: {trial.reason}", REINSTALL + chosen().package)
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
        file.write_text(KERNEL.format(compiler=chosen().module, arch=arch))
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
    name = program.chosen()
    if name is None and find_spec("bpy") is None:
        installed = shutil.which("blender") or "PATH"
        return wrong(
            "pictures",
            "there is no Blender: its package exists for Python 3.11 and 3.13",
            f"install one of these, or name an installed Blender: export {program.VARIABLE}={installed}",
        )
    blender = f"{program.VARIABLE}={name}" if name else "package bpy"
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "summary.json").write_text(json.dumps(EXTENT))
        pictures = Path(folder, "pictures")
        words = ["-m", "render", "--spec", json.dumps(PICTURE), "--simulation", folder, "--frames", "0:0"]
        trial = attempt([*words, "--out", pictures])
        if trial.reason:
            return wrong("pictures", f"Blender ({blender}) does not render: {trial.reason}", _mend(name))
        if not (pictures / "00000.png").is_file():
            return wrong("pictures", f"Blender ({blender}) ended well and left no picture", _mend(name))
        found = json.loads((pictures / "summary.json").read_text())["versions"]["blender"]
    return ok("pictures", f"Blender {found} ({blender}) renders one, in {trial.seconds:.1f} s")


def _mend(name: str | None) -> str:
    if name is None:
        return f"mend what is wrong above first, or {REINSTALL}bpy"
    return f"let {program.VARIABLE} name a Blender that runs, or unset it"
