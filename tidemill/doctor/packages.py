"""Packages of this Python: whether they are there, as new as is needed, and can be imported."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, metadata, requires, version
from importlib.util import find_spec
from pathlib import Path

from render.libraries import DEBIAN_PACKAGES
from tidemill.doctor.finding import Finding, ok, warning, wrong
from tidemill.doctor.trial import attempt

OURS = "tidemill"
MODULES = {"pillow": "PIL", "pyyaml": "yaml", "lxml": "lxml.etree", "scipy": "scipy.spatial"}
"""What packages are imported as, where that is not their name."""
LIBRARIES = DEBIAN_PACKAGES | {"libgomp": "libgomp1"}
"""Libraries of the system that wheels need, without their versions, and the packages of Debian that have them."""


def python() -> Finding:
    """Whether this Python is one that the packages exist for."""
    from packaging.specifiers import SpecifierSet

    found = ".".join(map(str, sys.version_info[:3]))
    needed = metadata(OURS)["Requires-Python"] or ""
    if found in SpecifierSet(needed):
        return ok("Python", f"{found}, {sys.executable}")
    return wrong("Python", f"{found}, but {needed} is needed", "install such a Python, and Tidemill in it")


def packages() -> Iterator[Finding]:
    """One finding for all that is right, and one for each package that is not."""
    from packaging.requirements import Requirement

    needed = [Requirement(text) for text in requires(OURS) or ()]
    needed = [one for one in needed if one.marker is None or one.marker.evaluate({"extra": ""})]
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        found = list(threads.map(lambda one: _package(one.name, str(one.specifier)), needed))
    wrongs = [finding for finding in found if finding is not None]
    yield from wrongs
    if len(wrongs) < len(needed):
        yield ok("packages", f"{len(needed) - len(wrongs)} of {len(needed)} are as needed and can be imported")


def _package(name: str, needed: str) -> Finding | None:
    """What is wrong with a package; None where nothing is."""
    from packaging.specifiers import SpecifierSet

    install = f"{sys.executable} -m pip install '{name}{needed}'"
    try:
        found = version(name)
    except PackageNotFoundError:
        return wrong(name, "is not installed", install)
    module = MODULES.get(name.lower(), name.replace("-", "_"))
    trial = attempt(["-c", f"import {module}"])
    if trial.reason:
        return wrong(name, f"{found} cannot be imported: {trial.reason}", _remedy(module, trial.reason, install))
    if found not in SpecifierSet(needed, prereleases=True):
        return warning(name, f"{found} was not tried; {needed} was", install)
    return None


def _remedy(module: str, reason: str, install: str) -> str:
    lacking = _lacking(module) or {f"{name}.so" for name in LIBRARIES if f"{name}.so" in reason}
    if not lacking:
        return f"{install} --force-reinstall --no-deps"
    found = {name: LIBRARIES.get(name.partition(".so")[0]) for name in lacking}
    known = sorted(package for package in found.values() if package)
    others = sorted(name for name, package in found.items() if not package)
    words = [f"on Debian and Ubuntu: sudo apt-get install {' '.join(known)}"] if known else []
    words += [f"install what has {', '.join(others)}"] if others else []
    return "; ".join(words)


def _lacking(module: str) -> set[str]:
    """Libraries that a package's own ones link to and that the system does not have."""
    try:
        found = find_spec(module.partition(".")[0])
    except (ImportError, ValueError):
        return set()
    if found is None or found.origin is None or shutil.which("ldd") is None:
        return set()
    folder = Path(found.origin).parent if found.submodule_search_locations else Path(found.origin)
    files = sorted(folder.glob("*.so*")) if folder.is_dir() else [folder]
    lines = [line for file in files for line in _links(file)]
    return {line.split()[0] for line in lines if line.endswith("not found")}


def _links(file: Path) -> list[str]:
    done = subprocess.run(["ldd", file], capture_output=True, text=True, check=False)
    return [line.strip() for line in done.stdout.splitlines()]
