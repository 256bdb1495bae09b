"""The machine: processors, memory, disks, text."""

from __future__ import annotations

import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from tidemill.doctor.finding import Finding, ok, warning, wrong

LEAST_MEMORY = 2e9
ENOUGH_MEMORY = 4e9
LEAST_DISK = 2e8
ENOUGH_DISK = 5e9
"""[bytes]. A job takes 1.5 GB; a film of two seconds with 100,000 particles, some 2 GB."""


def system() -> Finding:
    """Operating system and processors."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    text = f"{platform.system()} {platform.machine()}, {cores} cores"
    if platform.system() == "Linux" and platform.machine() in ("x86_64", "AMD64"):
        return ok("machine", text)
    return warning("machine", f"{text}: only Linux on x86-64 was tried", "see what fails below")


def memory() -> Finding:
    """Memory that is free [bytes], as far as the limits of a container are known."""
    free = _free_memory()
    if free is None:
        return warning("memory", "cannot be read on this system", "a job takes 1.5 GB and 3 kB a particle")
    text = f"{free / 1e9:.1f} GB free"
    if free < LEAST_MEMORY:
        return wrong("memory", f"{text}; a job takes 1.5 GB", "end other programs, or take another machine")
    if free < ENOUGH_MEMORY:
        return warning("memory", f"{text}: one job at a time", "-- --resources mem_mb=2000 lets Snakemake wait for it")
    return ok("memory", text)


def _free_memory() -> float | None:
    try:
        lines = dict(line.split(":", 1) for line in Path("/proc/meminfo").read_text().splitlines())
        free = 1024.0 * int(lines["MemAvailable"].split()[0])
    except (OSError, KeyError, ValueError):
        return None
    try:
        limit, used = (Path("/sys/fs/cgroup", name).read_text() for name in ("memory.max", "memory.current"))
        return min(free, float(limit) - float(used))
    except (OSError, ValueError):
        return free


def disks() -> Iterator[Finding]:
    """The folders that are written to: that of the films, that of temporary files, that of compiled kernels."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    temporary = None
    try:
        temporary = Path(tempfile.gettempdir())
    except OSError as error:
        yield wrong("temporary files", f"none: {error.strerror}", "free some space, or let TMPDIR name another folder")
    yield _disk("this folder", Path.cwd(), "make films in another folder")
    if temporary is not None:
        yield _disk("temporary files", temporary, "let TMPDIR name another folder")
    yield _disk("compiled kernels", cache, "let XDG_CACHE_HOME name another folder")


def _disk(subject: str, folder: Path, elsewhere: str) -> Finding:
    there = next(path for path in (folder, *folder.parents) if path.exists())
    try:
        with tempfile.TemporaryFile(dir=there) as file:
            file.write(bytes(1 << 16))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return wrong(subject, f"{folder} cannot be written to: {error.strerror}", f"free some space, or {elsewhere}")
    free = shutil.disk_usage(there).free
    text = f"{folder}, {free / 1e9:.1f} GB free"
    if free < LEAST_DISK:
        return wrong(subject, text, f"free some space, or {elsewhere}")
    if free < ENOUGH_DISK:
        return warning(subject, f"{text}: enough for a short film", f"free some space, or {elsewhere}")
    return ok(subject, text)


def text() -> Finding:
    """Whether names with accents can be files."""
    found = sys.getfilesystemencoding()
    if found.replace("-", "").lower() == "utf8":
        return ok("names of files", found)
    return warning("names of files", f"{found}: names with accents fail", "export LANG=C.UTF-8")
