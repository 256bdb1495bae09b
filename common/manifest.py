"""The list of files that makes a folder of results complete: written last, checked before use."""

from __future__ import annotations

import json
import os
import re
import zlib
from collections.abc import Container, Iterator
from dataclasses import dataclass, field
from pathlib import Path

NAME = "manifest.json"
_IGNORED = {NAME, ".snakemake_timestamp"}
_FRAME = re.compile(r"(?:^|_)(\d{5,})\.\w+$")
_PIECE = 1 << 20
"""Read at once [bytes]."""


@dataclass(frozen=True)
class Manifest:
    """Sizes [bytes], CRC-32 and times of change [ns] of the files by relative path, and the digest of the plan that
    made them."""

    plan: str
    files: dict[str, int]
    sums: dict[str, int] = field(default_factory=dict)
    changed: dict[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, folder: Path, plan: str) -> Manifest:
        """Of the files that are in the folder now."""
        found = sorted(_files(folder))
        return cls(
            plan,
            {name: state.st_size for name, state in found},
            {name: _sum(folder / name) for name, _ in found},
            {name: state.st_mtime_ns for name, state in found},
        )

    @classmethod
    def read(cls, folder: Path) -> Manifest | None:
        """The manifest of a folder; None where there is none that can be read."""
        try:
            data = json.loads((folder / NAME).read_text(encoding="utf-8"))
            tables = (data["files"], data.get("sums", {}), data.get("changed", {}))
            return cls(str(data["plan"]), *({str(name): int(number) for name, number in t.items()} for t in tables))
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None

    def write(self, folder: Path) -> None:
        """Write it into the folder, which makes that complete."""
        text = json.dumps(vars(self), indent=0)
        (folder / NAME).write_text(text + "\n", encoding="utf-8")

    def damage(self, folder: Path) -> str:
        """What is missing, has another size, or was written to since and has another content; empty where all is as it
        was made. Further files do not matter."""
        try:
            present = dict(_files(folder))
            for name, size in self.files.items():
                if name not in present:
                    return f"{name} is missing"
                if present[name].st_size != size:
                    return f"{name} has {present[name].st_size} bytes instead of {size}"
                if self.changed.get(name) != present[name].st_mtime_ns and self._differs(folder, name):
                    return f"{name} has another content"
        except OSError as error:
            return f"{error.filename} cannot be read"
        return ""

    def _differs(self, folder: Path, name: str) -> bool:
        return name in self.sums and _sum(folder / name) != self.sums[name]


def damage(folder: Path) -> str:
    """What is wrong with a folder of results; empty where it is complete."""
    manifest = Manifest.read(folder)
    return f"{NAME} is missing or damaged" if manifest is None else manifest.damage(folder)


def spoiled(folder: Path, kinds: tuple[str, ...], frames: Container[int] | None = None) -> Path | None:
    """The first file that begins like one of `kinds` and does not have the content that it was made with, by whatever
    that came; of files with a number only those of `frames`. None for a folder without a manifest, and where a file is
    not there: who reads it says so.
    """
    manifest = Manifest.read(folder)
    if manifest is None:
        return None
    for name in manifest.sums:
        number = _FRAME.search(name)
        wanted = name.startswith(kinds) and (number is None or frames is None or int(number[1]) in frames)
        if wanted and (folder / name).exists() and manifest._differs(folder, name):
            return folder / name
    return None


def _sum(path: Path) -> int:
    total = 0
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            total = zlib.crc32(piece, total)
    return total


def _files(folder: Path, prefix: str = "") -> Iterator[tuple[str, os.stat_result]]:
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                yield from _files(Path(entry.path), f"{prefix}{entry.name}/")
            elif entry.is_file() and f"{prefix}{entry.name}" not in _IGNORED:
                yield f"{prefix}{entry.name}", entry.stat()
