"""Which source files a stage depends on, found without importing any, and their digest.

A name such as "sim.fluid.pressure.dfsph" in a string counts as an import, because registries load the
modules that they name. Folders of materials that a scene does not use do not count.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGES = ("common", "scene", "sim", "render", "workflow")
MATERIALS = frozenset({"fluid", "rigid", "cloth"})
_NAME_IN_STRING = re.compile(rf"""["']((?:{"|".join(PACKAGES)})(?:\.[A-Za-z_]\w*)+)(?::[^"']*)?["']""")
_IMPORT = re.compile(r"^[ \t]*import[ \t]+([\w.]+)", re.MULTILINE)
_FROM = re.compile(r"^[ \t]*from[ \t]+(\.*)([\w.]*)[ \t]+import[ \t]+(\([^)]*\)|.+)", re.MULTILINE)
_COMMENT = re.compile(r"#.*")
_DECLARATION = re.compile(r"^MATERIALS = \(([^)]*)\)", re.MULTILINE)
_NAME = re.compile(r"\w+")
_NAME_AND_ALIAS = re.compile(r"(\w+)(?:\s+as\s+\w+)?")


def closure(
    entry: str, root: Path, materials: frozenset[str] = MATERIALS, packages: tuple[str, ...] = PACKAGES
) -> list[Path]:
    """Source files below `root` that the module `entry` imports, directly or not, itself included; sorted.

    `packages`: those that count; names in strings are of ours alone. Raises FileNotFoundError where there is no such
    module.
    """
    start = _find(entry, root)
    if start is None:
        raise FileNotFoundError(f"there is no module {entry} in {root}")
    if (command := start.with_name("__main__.py")).is_file() and start.name == "__init__.py":
        start = command
    found: set[Path] = set()
    known: set[str] = set()
    waiting = [start, *_packages(entry, root)]
    while waiting:
        file = waiting.pop()
        if file in found:
            continue
        found.add(file)
        for module in _imports(file, root, packages, file.stat().st_mtime_ns):
            if module not in known and _counts(module, root, materials):
                known.add(module)
                target = _find(module, root)
                waiting += [*_packages(module, root), *([target] if target else [])]
    return sorted(found)


def digest(entry: str, root: Path, materials: frozenset[str] = MATERIALS) -> str:
    """Digest of names and contents of the closure."""
    total = hashlib.sha256()
    for file in closure(entry, root, materials):
        content = hashlib.sha256(file.read_bytes()).hexdigest()
        total.update(f"{file.relative_to(root).as_posix()} {content}\n".encode())
    return total.hexdigest()


def _counts(module: str, root: Path, materials: frozenset[str]) -> bool:
    """False for what is loaded only with a material that the scene does not use."""
    parts = module.split(".")
    for end in range(len(parts), 0, -1):
        file = _find(".".join(parts[:end]), root)
        needed = _declared(file, file.stat().st_mtime_ns) if file else None
        if needed is not None:
            return needed <= materials
    return True


@functools.lru_cache(maxsize=4096)
def _declared(file: Path, _changed: int) -> frozenset[str] | None:
    """The materials that a file declares to need; None where it declares nothing."""
    found = _DECLARATION.search(file.read_text())
    return frozenset(_NAME.findall(found[1])) if found else None


@functools.lru_cache(maxsize=4096)
def _imports(file: Path, root: Path, packages: tuple[str, ...], _changed: int) -> tuple[str, ...]:
    text = file.read_text()
    package = file.parent.relative_to(root).parts
    named = _NAME_IN_STRING.findall(text) if packages == PACKAGES else ()
    return tuple(dict.fromkeys([*_imported(text, package, packages), *named]))


def _imported(text: str, package: tuple[str, ...], packages: tuple[str, ...]) -> Iterator[str]:
    """Names that a source imports, by its lines: parsing all of them takes longer than planning a film."""
    text = _COMMENT.sub("", text)
    yield from (module for module in _IMPORT.findall(text) if module.partition(".")[0] in packages)
    for dots, name, members in _FROM.findall(text):
        base = package[: len(package) - len(dots) + 1] if dots else ()
        module = ".".join([*base, *([name] if name else [])])
        if module.partition(".")[0] in packages:
            yield module
            yield from (f"{module}.{member}" for member in _NAME_AND_ALIAS.findall(members))


def _find(module: str, root: Path) -> Path | None:
    base = root.joinpath(*module.split("."))
    for file in (base.with_suffix(".py"), base / "__init__.py"):
        if file.is_file():
            return file
    return None


def _packages(module: str, root: Path) -> list[Path]:
    """The `__init__.py` of every package that importing the module runs."""
    parts = module.split(".")
    folders = [root.joinpath(*parts[:end]) for end in range(1, len(parts) + 1)]
    return [folder / "__init__.py" for folder in folders if (folder / "__init__.py").is_file()]
