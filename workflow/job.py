"""Runs the command of one job so that its folder of results is there in full or not at all.

    python -m workflow.job --output DIR --failed DIR --log FILE --plan TEXT -- COMMAND ... @OUT ...

The command writes into the folder @OUT, beside DIR or on a disk of the machine (--scratch); when it
ends with 0 a manifest is added, all is written through to the disk, and the folder takes the name
DIR. Otherwise what there is moves to the folder of --failed, and the command's exit code is passed
on. One job at a time makes a result, and the command does not outlive the job, nor the job the
workflow that started it. What was refused or stopped for its settings is not tried again.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
from collections.abc import Sequence
from pathlib import Path

from common.command import end_with
from workflow.running import process
from workflow.running.process import Interrupted, Log
from workflow.running.result_folder import explain, only_one, partial_folder, publish, set_aside, sweep, workplace
from workflow.running.verdict import MEANINGS, judge, verdict

PLACEHOLDER = "@OUT"


def run(
    command: Sequence[str],
    *,
    output: Path,
    failed: Path,
    log: Log,
    plan: str,
    attempt: int = 1,
    scratch: Path | None = None,
) -> int:
    """Run a command as described above; returns the exit code."""
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        with only_one(output, log):
            sweep(output)
            earlier = verdict(failed, plan) if attempt > 1 else None
            if earlier is not None:
                log.say(f"{output}: the command {MEANINGS[earlier]} before: it is not tried again")
                return earlier
            partial = partial_folder(output)
            partial.mkdir()
            try:
                with workplace(partial, scratch) as folder:
                    code = process.run([part.replace(PLACEHOLDER, str(folder)) for part in command], log)
                if code == 0:
                    publish(partial, output, plan)
                    shutil.rmtree(failed, ignore_errors=True)
                else:
                    set_aside(partial, failed, code, log)
                judge(failed, plan, code)
                return code
            finally:
                shutil.rmtree(partial, ignore_errors=True)
    except Interrupted as interrupted:
        log.say(f"{output}: stopped by {interrupted}; nothing of it is kept")
        return 128 + interrupted.signum
    except OSError as error:
        log.say(explain(error, output))
        return 1


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m workflow.job",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--output", type=Path, required=True, help="folder that the job makes")
    parser.add_argument("--failed", type=Path, required=True, help="where what is left of a failed job goes")
    parser.add_argument("--log", type=Path, required=True, help="file for all that the command prints")
    parser.add_argument("--plan", required=True, help="what the result was made for: kept in its manifest")
    parser.add_argument("--attempt", type=int, default=1, metavar="N", help="which attempt in one call of snakemake")
    parser.add_argument(
        "--scratch",
        default="",
        metavar="DIR",
        help="write into this folder first, or into the one that this variable of the machine names, as TMPDIR",
    )
    parser.add_argument("command", nargs=argparse.REMAINDER, help="-- and the command, with @OUT for its folder")
    arguments = parser.parse_args(argv)
    command = arguments.command[1:] if arguments.command[:1] == ["--"] else arguments.command
    if not command:
        parser.error("there is no command after --")
    process.at_death_of_parent(signal.SIGTERM)()
    for signum in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(signum, process.interrupt)
    return run(
        command,
        output=arguments.output,
        failed=arguments.failed,
        log=Log(arguments.log),
        plan=arguments.plan,
        attempt=arguments.attempt,
        scratch=_scratch(arguments.scratch),
    )


def _scratch(text: str) -> Path | None:
    """A folder, or what a variable of the node names; none where it is not set there."""
    path = text if text.startswith("/") else os.environ.get(text, "")
    return Path(path) if path else None


if __name__ == "__main__":
    end_with(main, goes_on=True)
