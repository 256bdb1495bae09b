"""Carry out one trial of a study, and keep what is measured and how it ended: a failure is an outcome like another.

The command of a stage follows --, with @RUN for the folder that it writes. trial.json has `status`
(done, refused, stopped, or too long), `cost`, and `message`, where it failed. The cost of a
simulation is the wall time of its steps over the simulated time, without compiling and output; of
a surface or picture it is the wall time of one.

exit codes: 0 the trial ended, well or not; 1 it could not be carried out
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from common.arguments import positive
from common.command import end_with
from common.files import write_json
from workflow.stages.stage import FAILED

RUN = "@RUN"
STATUS = {0: "done", 2: "refused", 3: "stopped"}
PATIENCE = 60.0
"""Seconds for a command that has to end to write down how far it came."""


@dataclass(frozen=True)
class Kind:
    """What is kept of a stage's files, and what its summary.json says that it took."""

    kept: tuple[str, ...]
    figures: Callable[[Mapping[str, Any]], dict[str, Any]]


def _of_simulation(summary: Mapping[str, Any]) -> dict[str, Any]:
    stepping, simulated = summary["wall_s"].get("stepping", 0.0), summary["simulated_s"]
    return {
        "cost": stepping / simulated if simulated > 0 else None,
        "stepping_s": stepping,
        "simulated_s": simulated,
        "steps": summary["counts"]["steps"],
        "particles": summary["counts"]["particles"],
        "device": summary["device"],
    }


def _of_surface(summary: Mapping[str, Any]) -> dict[str, Any]:
    frames = summary["frames"]
    return {"cost": summary["wall_s"]["splashsurf"] / len(frames), "triangles": frames[-1]["triangles"]}


def _of_picture(summary: Mapping[str, Any]) -> dict[str, Any]:
    seconds = summary["wall_s_per_frame"]
    return {"cost": sum(seconds) / len(seconds), "device": summary["device"]["kind"].lower()}


KINDS = {
    "simulate": Kind(("steps.csv", "probes.csv", "bodies.csv"), _of_simulation),
    "reconstruct": Kind(("surface_*.ply",), _of_surface),
    "render": Kind(("[0-9]*.png",), _of_picture),
}


def run(stage: str, command: Sequence[str], out: Path, *, limit: float) -> dict[str, Any]:
    """Run a stage's command and return what trial.json holds; raises OSError, and RuntimeError where it crashed."""
    kind = KINDS[stage]
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out, prefix="run-") as scratch:
        code, message = _bounded([part.replace(RUN, scratch) for part in command], limit)
        for pattern in (*kind.kept, "summary.json", "failure.json"):
            for path in Path(scratch).glob(pattern):
                shutil.copyfile(path, out / path.name)
    if code not in (*STATUS, None):
        raise RuntimeError(f"the command ended with exit code {code}\n{message}")
    status = "too long" if code is None else STATUS[code]
    found = {"status": status, **_figures(kind, out / "summary.json")}
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


def _figures(kind: Kind, summary: Path) -> dict[str, Any]:
    """Nothing of what was refused."""
    if not summary.exists():
        return {}
    data = json.loads(summary.read_text(encoding="utf-8"))
    return {**kind.figures(data), "versions": data["versions"]}


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.study.trial", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--stage", required=True, choices=list(KINDS), help="what the command does")
    parser.add_argument("--out", required=True, type=Path, metavar="DIR", help="folder for what is kept and trial.json")
    parser.add_argument(
        "--limit", type=positive(float), default=600.0, help="wall seconds until it is given up (default: 600)"
    )
    parser.add_argument("command", nargs=argparse.REMAINDER, help=f"-- and the command, with {RUN} for its folder")
    given = parser.parse_args(argv)
    command = given.command[1:] if given.command[:1] == ["--"] else given.command
    if not command:
        parser.error("there is no command after --")
    try:
        write_json(given.out / "trial.json", run(given.stage, command, given.out, limit=given.limit))
    except (OSError, RuntimeError) as error:
        print(f"trial: {error}", file=sys.stderr)
        return FAILED
    return 0


if __name__ == "__main__":
    end_with(main, goes_on=True)
