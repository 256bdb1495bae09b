"""Which source files count for a stage and a scene."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from workflow.plan.sources import PACKAGES, closure, digest

ROOT = Path(__file__).resolve().parents[4]

FILES = {
    "sim/__init__.py": "",
    "sim/segment.py": "from sim import world\nimport numpy\n",
    "sim/world.py": """\
from .units import metre
def load(material):
    if material == "cloth":
        from sim.cloth import solver
    from sim.coupling import fluid_cloth, common
    from sim.coupling.fluid_rigid import film, solids
SOLVERS = {"dfsph": "sim.fluid.dfsph:Dfsph"}
TEXT = "sim.fluid.unknown"
""",
    "sim/units.py": "metre = 1\n",
    "sim/unused.py": "",
    "sim/fluid/__init__.py": 'MATERIALS = ("fluid",)\n',
    "sim/fluid/dfsph.py": "from sim.fluid.kernel import w\n",
    "sim/fluid/kernel.py": "",
    "sim/cloth/__init__.py": 'MATERIALS = ("cloth",)\n',
    "sim/cloth/solver.py": "from sim.cloth_tools import x\n",
    "sim/cloth_tools.py": "",
    "sim/coupling/__init__.py": "",
    "sim/coupling/fluid_rigid/__init__.py": '"""Both."""\nMATERIALS = ("fluid", "rigid")\n',
    "sim/coupling/fluid_rigid/film.py": "",
    "sim/coupling/fluid_rigid/solids.py": 'MATERIALS = ("fluid",)\n',
    "sim/coupling/fluid_cloth.py": 'MATERIALS = ("fluid", "cloth")\n',
    "sim/coupling/common.py": "",
    "render/__init__.py": "",
    "render/__main__.py": "import sim.units\n",
}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def names(root: Path, entry: str, *materials: str) -> set[str]:
    return {path.relative_to(root).as_posix() for path in closure(entry, root, frozenset(materials))}


def test_imports_are_followed_also_relative_in_functions_and_in_strings(tree):
    found = names(tree, "sim.segment", "fluid", "rigid", "cloth")
    assert found == set(FILES) - {"sim/unused.py", "render/__init__.py", "render/__main__.py"}


def parsed_imports(file: Path, root: Path) -> set[Path]:
    """Files of the project that a file imports by Python's own parser, anywhere in it."""
    package = file.parent.relative_to(root).parts
    modules: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = ".".join([*package[: len(package) - node.level + 1], *([node.module] if node.module else [])])
            module = base if node.level else node.module or ""
            modules |= {module, *(f"{module}.{alias.name}" for alias in node.names)}
    paths = [root.joinpath(*module.split(".")) for module in modules if module.partition(".")[0] in PACKAGES]
    files = {path.with_suffix(".py") for path in paths} | {path / "__init__.py" for path in paths}
    return {path for path in files if path.is_file()}


@pytest.mark.parametrize("entry", ["sim.segment", "workflow.reconstruct", "render", "workflow.film"])
def test_no_import_that_the_parser_sees_is_missed(entry):
    found = set(closure(entry, ROOT))
    assert len(found) > 5
    for file in found:
        assert parsed_imports(file, ROOT) <= found, file


def test_imports_over_many_lines_with_comments_and_aliases(tmp_path):
    for name in ("__init__", "a", "b", "c", "not_imported"):
        (tmp_path / "sim").mkdir(exist_ok=True)
        (tmp_path / "sim" / f"{name}.py").touch()
    text = "from sim import (  # comment: not_imported\n    a as z,\n    b,  # and not (not_imported)\n    c,\n)\n"
    (tmp_path / "sim" / "entry.py").write_text(text)
    assert names(tmp_path, "sim.entry") == {f"sim/{name}.py" for name in ("__init__", "a", "b", "c", "entry")}


def test_what_declares_a_material_counts_for_scenes_with_it(tree):
    """A module's own declaration comes before that of its package; what declares nothing counts for all."""
    found = names(tree, "sim.segment", "fluid", "rigid")
    assert not {name for name in found if "cloth" in name}
    film, solids = "sim/coupling/fluid_rigid/film.py", "sim/coupling/fluid_rigid/solids.py"
    assert {film, solids, "sim/coupling/common.py", "sim/fluid/kernel.py"} <= found
    assert {film, solids} & names(tree, "sim.segment", "fluid") == {solids}
    dry = names(tree, "sim.segment", "rigid")
    assert "sim/coupling/common.py" in dry
    assert not {film, solids, "sim/fluid/dfsph.py"} & dry


def test_a_package_starts_at_its_main(tree):
    assert names(tree, "render") == {"render/__init__.py", "render/__main__.py", "sim/__init__.py", "sim/units.py"}


def test_the_digest_changes_with_what_counts_and_nothing_else(tree):
    fluid, cloth = frozenset({"fluid"}), frozenset({"cloth"})
    before = digest("sim.segment", tree, fluid), digest("sim.segment", tree, cloth)
    (tree / "sim/cloth/solver.py").write_text("x = 2\n")
    (tree / "sim/unused.py").write_text("x = 2\n")
    after = digest("sim.segment", tree, fluid), digest("sim.segment", tree, cloth)
    assert after[0] == before[0]
    assert after[1] != before[1]


def test_a_module_that_does_not_exist(tree):
    with pytest.raises(FileNotFoundError, match=r"sim\.nothing"):
        closure("sim.nothing", tree)
