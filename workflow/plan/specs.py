"""The settings of a stage on their way to its command: by file, since Linux lets one argument have 128 KiB and no more.

A file is named by what is in it: equal settings are one file, and another name says that settings have changed.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from common.files import write_whole

FOLDER = "results/specs"


def spec_file(spec: str) -> str:
    """The name of the file for settings given in canonical JSON; relative to the working directory."""
    return f"{FOLDER}/{hashlib.sha256(spec.encode()).hexdigest()[:32]}.json"


def write_spec(spec: str) -> str:
    """Write that file, unless it is there; one setting a line, for `diff`. Returns its name; raises OSError."""
    path = Path(spec_file(spec))
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        text = json.dumps(json.loads(spec), indent=1) + "\n"
        write_whole(path, lambda partial: partial.write_text(text, encoding="utf-8"))
    return str(path)
