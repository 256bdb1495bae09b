"""The command `tidemill doctor`."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import version

from tidemill import DISTRIBUTION
from tidemill.doctor import machine, packages, stages
from tidemill.doctor.finding import Finding, State, wrong

FAILED = 1
CHECKS: dict[str, Callable[[], Finding | Iterator[Finding]]] = {
    "Python": packages.python,
    "machine": machine.system,
    "memory": machine.memory,
    "disks": machine.disks,
    "names of files": machine.text,
    "packages": packages.packages,
    "simulation": stages.simulation,
    "GPU": stages.gpu,
    "encoder": stages.encoder,
    "fonts": stages.fonts,
    "pictures": stages.picture,
}
COLORS = {State.OK: "32", State.WARNING: "33", State.WRONG: "31"}


def main(arguments: Sequence[str], called: str) -> int:
    """Look at everything and say how it is; 0 where films can be made, 1 where they cannot."""
    parser = argparse.ArgumentParser(
        prog=called,
        description="Look at Python, packages, system libraries, processors, memory, disks and the programs behind "
        "the stages, and say what to do where something is wrong.",
        epilog="exit codes: 0 films can be made, 1 something is wrong",
    )
    parser.add_argument("--json", action="store_true", help="print it for a report of a fault")
    options = parser.parse_args(arguments)
    found = []
    for finding in look():
        found.append(finding)
        if not options.json:
            _say(finding)
    wrongs = [finding for finding in found if finding.state is State.WRONG]
    if options.json:
        rows = [vars(finding) | {"state": finding.state.value} for finding in found]
        print(json.dumps({"version": version("tidemill"), "folder": str(DISTRIBUTION), "findings": rows}, indent=1))
    elif wrongs:
        print(f"\n{len(wrongs)} wrong: {', '.join(finding.subject for finding in wrongs)}")
    else:
        print("\nfilms can be made: tidemill new film")
    return FAILED if wrongs else 0


def look() -> Iterator[Finding]:
    """All findings. A check that fails itself is one, too."""
    for subject, check in CHECKS.items():
        try:
            found = check()
            yield from [found] if isinstance(found, Finding) else found
        except OSError as error:
            yield wrong(subject, f"cannot be tried: {error.strerror}", "mend what is wrong above first")
        except Exception as error:
            yield wrong(subject, f"cannot be looked at: {error}", "install Tidemill anew")


def _say(finding: Finding) -> None:
    state = f"{finding.state.value:<7}"
    if sys.stdout.isatty():
        state = f"\033[{COLORS[finding.state]}m{state}\033[0m"
    print(f"{state}  {finding.subject:<16}  {finding.text}", flush=True)
    if finding.fix:
        print(f"{'':<27}fix: {finding.fix}", flush=True)
