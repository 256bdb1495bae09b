"""The list of files that makes a folder of results complete: written last, checked before use."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

NAME = "manifest.json"
_IGNORED = {NAME, ".snakemake_timestamp"}


@dataclass(frozen=True)
class Manifest:
    """Sizes [bytes] of the files by relative path, and the digest of the plan that made them."""

    plan: str
    files: dict[str, int]

    @classmethod
    def of(cls, folder: Path, plan: str) -> Manifest:
        return cls(plan, dict(sorted(_sizes(folder))))

    @classmethod
    def read(cls, folder: Path) -> Manifest | None:
        """The manifest of a folder; None where there is none that can be read."""
        try:
            data = json.loads((folder / NAME).read_text(encoding="utf-8"))
            return cls(str(data["plan"]), {str(name): int(size) for name, size in data["files"].items()})
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None

    def write(self, folder: Path) -> None:
        text = json.dumps({"plan": self.plan, "files": self.files}, indent=0)
        (folder / NAME).write_text(text + "\n", encoding="utf-8")

    def damage(self, folder: Path) -> str:
        """What is missing or has another size; empty where all is there. Further files do not matter."""
        try:
            present = dict(_sizes(folder))
        except OSError as error:
            return f"{error.filename} can not be read"
        for name, size in self.files.items():
            if name not in present:
                return f"{name} is missing"
            if present[name] != size:
                return f"{name} has {present[name]} bytes instead of {size}"
        return ""


def damage(folder: Path) -> str:
    """What is wrong with a folder of results; empty where it is complete."""
    manifest = Manifest.read(folder)
    return f"{NAME} is missing or damaged" if manifest is None else manifest.damage(folder)


def _sizes(folder: Path, prefix: str = "") -> Iterator[tuple[str, int]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                yield from _sizes(Path(entry.path), f"{prefix}{entry.name}/")
            elif entry.is_file() and f"{prefix}{entry.name}" not in _IGNORED:
                yield f"{prefix}{entry.name}", entry.stat().st_size
