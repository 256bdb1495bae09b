"""What imports what: every import statement of the sources, wherever it stands."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("common", "scene", "sim", "render", "workflow", "live")


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
def imports(module: str) -> frozenset[str]:
    """Names of all that a module imports, of the project or not: modules, and of packages what is taken from them."""
    return frozenset(_imported(ast.parse(modules()[module].read_text())))


def _imported(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            members = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from (member if member in modules() else node.module for member in members)


def graph() -> dict[str, set[str]]:
    """The modules of the project that each imports."""
    return {module: {name for name in imports(module) if name in modules()} - {module} for module in modules()}
