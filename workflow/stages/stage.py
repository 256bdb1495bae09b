"""What the commands of the stages share: inputs that are as they were made, and exit codes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Container, Iterable
from pathlib import Path

from common.manifest import spoiled
from scene.settings import Refused

REFUSED = 2
FAILED = 1


def refuse_spoiled(folders: Iterable[Path], *kinds: str, frames: Container[int] | None = None) -> None:
    """Refuse files of earlier stages that are no longer what they were made as; see `common.manifest.spoiled`."""
    for folder in folders:
        path = spoiled(folder, kinds, frames)
        if path is not None:
            raise Refused(
                f"{path} no longer holds what was written to it",
                remedy=f"delete the folder {folder} and run the same command again: what is in it is made anew",
            )


def exit_code(run: Callable[[], None], name: str) -> int:
    """Run a stage: 0 done, 1 failed, 2 refused; says why in one message instead of a traceback."""
    try:
        run()
    except Refused as refused:
        print(f"{name}: {refused}", file=sys.stderr)
        return REFUSED
    except OSError as error:
        print(f"{name}: {error.filename or 'the output'}: {error.strerror or error}", file=sys.stderr)
        return FAILED
    return 0
