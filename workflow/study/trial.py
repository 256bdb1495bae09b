"""Simulate one trial of a study, and keep its tables and how it ended: a failure is an outcome like another.

trial.json has `status` (done, refused, stopped, or too long), `cost`: wall seconds of its steps over the simulated
seconds, without compiling and output, and `message`, where it failed.

exit codes: 0 the trial ended, well or not; 1 it could not be carried out
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workflow.stage import FAILED, write_json

KEPT = ("steps.csv", "probes.csv", "bodies.csv", "summary.json", "failure.json")
STATUS = {0: "done", 2: "refused", 3: "stopped"}
SIMULATE = "sim.segment"
PATIENCE = 60.0
"""Seconds for a simulation that has to end to write down how far it came."""


def run(spec: str, folder: str, frames: str, out: Path, *, threads: int, limit: float) -> dict[str, Any]:
    """Simulate and return what trial.json holds; raises OSError, and RuntimeError where the simulation crashed."""
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix="run-") as scratch:
        settings = Path(scratch, "spec.json")
        settings.write_text(spec, encoding="utf-8")
        command = [sys.executable, "-m", SIMULATE, "--spec", f"@{settings}", "--folder", folder]
        command += ["--frames", frames, "--out", scratch, "--threads", str(threads)]
        code, message = _bounded(command, limit)
        for name in KEPT:
            if Path(scratch, name).exists():
                shutil.copyfile(Path(scratch, name), out / name)
    if code not in (*STATUS, None):
        raise RuntimeError(f"the simulation ended with exit code {code}\n{message}")
    status = "too long" if code is None else STATUS[code]
    found: dict[str, Any] = {"status": status, **_figures(out / "summary.json")}
    return found if status == "done" else {**found, "message": message.strip()[-2000:]}


def _bounded(command: Sequence[str], limit: float) -> tuple[int | None, str]:
    """Exit code, None where the time was up, and what was said on the error stream."""
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            _, said = process.communicate(timeout=limit)
            return process.returncode, said
        except subprocess.TimeoutExpired:
            process.terminate()
        try:
            _, said = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            _, said = process.communicate()
        return None, said


def _figures(summary: Path) -> dict[str, Any]:
    """What a simulation took; nothing of one that was refused."""
    if not summary.exists():
        return {}
    data = json.loads(summary.read_text(encoding="utf-8"))
    stepping, simulated = data["wall_s"].get("stepping", 0.0), data["simulated_s"]
    return {
        "cost": stepping / simulated if simulated > 0 else None,
        "stepping_s": stepping,
        "simulated_s": simulated,
        "steps": data["counts"]["steps"],
        "particles": data["counts"]["particles"],
        "versions": data["versions"],
        "device": data["device"],
    }


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.study.trial", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spec", required=True, metavar="JSON", help="settings of the simulation")
    parser.add_argument("--folder", required=True, help="folder that relative asset paths start from")
    parser.add_argument("--frames", required=True, metavar="A:B", help="frames to simulate")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for the tables and trial.json")
    parser.add_argument("--threads", type=int, default=1, help="CPU threads (default: 1)")
    parser.add_argument("--limit", type=float, default=600.0, help="wall seconds until it is given up (default: 600)")
    given = parser.parse_args(argv)
    try:
        found = run(given.spec, given.folder, given.frames, given.out, threads=given.threads, limit=given.limit)
        write_json(given.out / "trial.json", found)
    except (OSError, RuntimeError) as error:
        print(f"trial: {error}", file=sys.stderr)
        return FAILED
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
