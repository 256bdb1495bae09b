"""What Snakemake remembers of a result: the one place that knows where it keeps it."""

from __future__ import annotations

import base64
import json
from pathlib import Path

_LONGEST_NAME = 254


def metadata_file(output: str, kind: str = "metadata", workdir: Path | None = None) -> Path:
    """Snakemake's file about an output; `kind` is `metadata`, or `incomplete` while its job runs."""
    key = base64.urlsafe_b64encode(output.encode()).decode()
    pieces = [key[i : i + _LONGEST_NAME] for i in range(0, len(key), _LONGEST_NAME)]
    return (workdir or Path()).joinpath(".snakemake", kind, *(f"@{piece}" for piece in pieces[:-1]), pieces[-1])


def params(output: str, workdir: Path | None = None) -> list[str] | None:
    """The values of the params that an output was made with, as Snakemake wrote them; None without a record."""
    try:
        record = json.loads(metadata_file(output, workdir=workdir).read_text(encoding="utf-8"))
        return [str(value) for value in record["params"]]
    except (OSError, ValueError, KeyError, TypeError):
        return None


def is_incomplete(output: str, workdir: Path | None = None) -> bool:
    """Whether the job that makes an output was started and never ended."""
    return metadata_file(output, "incomplete", workdir).exists()
