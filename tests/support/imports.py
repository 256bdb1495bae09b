"""What imports what: every import statement of the sources, wherever it stands."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("common", "scene", "sim", "render", "workflow", "live", "tidemill")


@cache
def modules() -> dict[str, Path]:
    """The modules of the project by name."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def imports(module: str, *, types: bool = True) -> frozenset[str]:
    """Names of all that a module imports, of the project or not; without `types`, not what only annotations need."""
    return frozenset(_imported(ast.parse(modules()[module].read_text()), types))


def _imported(tree: ast.AST, types: bool) -> Iterator[str]:
    annotations = [node for node in ast.walk(tree) if isinstance(node, ast.If) and _is_for_types(node)]
    skipped = set() if types else {id(part) for node in annotations for part in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            members = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from (member if member in modules() else node.module for member in members)


def _is_for_types(node: ast.If) -> bool:
    return isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


def graph(*, types: bool = True) -> dict[str, set[str]]:
    """The modules of the project that each imports."""
    return {
        module: {name for name in imports(module, types=types) if name in modules()} - {module} for module in modules()
    }
