"""The laws of the house: which chapters may import which."""

from __future__ import annotations

import ast
import re

import networkx
import pytest

from sim.device.compiler_choice import COMPILERS
from tests.support.imports import PACKAGES, ROOT, graph, imports, modules

MOST = 15
"""Files of a folder, beside its `__init__`."""


def below(module: str, *chapters: str) -> bool:
    return any(module == chapter or module.startswith(f"{chapter}.") for chapter in chapters)


def is_spec(module: str) -> bool:
    return module.rpartition(".")[2] == "spec"


def is_entry(module: str) -> bool:
    """Commands stand above all chapters."""
    return module.rpartition(".")[2] == "__main__"


BASE = ("scene.settings", "scene.units", "scene.notation", "scene.spec_option", "scene.diagnostics.suggestions")
MATERIALS = ("sim.fluid", "sim.cloth", "sim.rigid", "sim.foam")
ABOVE = ("sim.run", "sim.checks")
LAWS = {
    "common knows nothing": ("common", (*PACKAGES[1:],), ()),
    "what settings are made of knows nothing": (BASE, ("sim", "render", "workflow", "live"), ()),
    "the scene file knows the settings of the stages, not the stages": ("scene", PACKAGES[2:], is_spec),
    "the simulation knows no other stage": ("sim", ("render", "workflow", "live"), ()),
    "pictures know no simulation": ("render", ("sim", "workflow", "live"), ()),
    "nothing needs to be installed": (PACKAGES[:-1], ("tidemill",), ()),
    "the workflow does not play": ("workflow", ("live",), ()),
    "the device knows no physics": ("sim.device", ("sim",), ("sim.device",)),
    "neighbours are of anything": ("sim.neighbors", ("sim",), ("sim.device", "sim.neighbors")),
    "shapes are of anything": ("sim.geometry", ("sim",), ("sim.device", "sim.neighbors", "sim.geometry")),
    "solids know no material": ("sim.bodies", (*MATERIALS, "sim.coupling", *ABOVE), is_spec),
    "the fluid knows no other material": ("sim.fluid", (*MATERIALS, "sim.coupling", *ABOVE), ("sim.fluid",)),
    "cloth knows no other material": ("sim.cloth", (*MATERIALS, "sim.coupling", *ABOVE), ("sim.cloth",)),
    "rigid bodies know no other material": ("sim.rigid", (*MATERIALS, "sim.coupling", *ABOVE), ("sim.rigid",)),
    "foam follows the fluid": ("sim.foam", (*MATERIALS, "sim.coupling", *ABOVE), ("sim.foam", "sim.fluid.kernel")),
    "couplings are part of a run": ("sim.coupling", ABOVE, ()),
    "a run needs no check": ("sim.run", ("sim.checks",), ()),
}
"""Who may not import what, and what of that nevertheless."""


@pytest.mark.parametrize("law", LAWS)
def test_law(law):
    who, what, but = LAWS[law]
    who = (who,) if isinstance(who, str) else who
    allowed = but if callable(but) else lambda module: below(module, *but)
    broken = [
        (module, name)
        for module, names in graph().items()
        if below(module, *who) and not is_entry(module)
        for name in names
        if below(name, *what) and not allowed(name)
    ]
    assert not broken


@pytest.mark.parametrize(
    ("package", "foreign"),
    [
        ("common", {"taichi", "bpy", "snakemake", "pysplashsurf"}),
        ("scene", {"taichi", "bpy", "snakemake", "pysplashsurf", "numpy"}),
        ("sim", {"bpy", "snakemake", "pysplashsurf", "viser"}),
        ("render", {"taichi", "snakemake", "pysplashsurf", "viser"}),
        ("workflow", {"taichi", "bpy", "viser"}),
        ("live", {"taichi", "bpy", "snakemake", "pysplashsurf"}),
        ("tidemill", {"taichi", "bpy", "snakemake", "pysplashsurf", "viser"}),
    ],
)
def test_packages_from_elsewhere(package, foreign):
    found = {name.partition(".")[0] for module in modules() if below(module, package) for name in imports(module)}
    assert "pathlib" in found
    assert not found & foreign


def test_all_take_the_compiler_from_one_place():
    """Of tests, too; strings count where they are imported."""
    paths = {path for folder in (*PACKAGES, "tests") for path in (ROOT / folder).rglob("*.py")}
    named = re.compile(rf"^\s*(?:from|import) +(?:{'|'.join(COMPILERS)})\b", re.MULTILINE)
    found = {path.relative_to(ROOT).as_posix() for path in paths if named.search(path.read_text())}
    assert found == {"sim/device/compiler.py"}


def test_nothing_imports_itself_in_a_circle():
    """Of what is imported when a module runs, in functions, too; annotations may name each other."""
    edges = [(module, name) for module, names in graph(types=False).items() for name in names]
    circles = [found for found in networkx.strongly_connected_components(networkx.DiGraph(edges)) if len(found) > 1]
    assert not circles


def test_only_commands_import_a_command():
    commands = [module for module in modules() if is_entry(module) or module.count(".") == 1]
    others = {module: names for module, names in graph().items() if module not in commands}
    assert not [(module, name) for module, names in others.items() for name in names if is_entry(name)]


@pytest.mark.parametrize("package", PACKAGES)
def test_chapters_are_short_and_say_what_is_in_them(package):
    folders = [path.parent for path in (ROOT / package).rglob("__init__.py")]
    assert {path.parent for path in (ROOT / package).rglob("*.py")} == set(folders)
    for folder in folders:
        assert len(list(folder.glob("*.py"))) - 1 <= MOST, folder
        assert (folder / "__init__.py").read_text().lstrip().startswith('"""'), f"{folder} does not say what it is"


def test_static_choices_are_statements():
    """Taichi compiles both sides of `a if ti.static(c) else b`, and runs what they call."""
    found = []
    for path in (ROOT / "sim").rglob("*.py"):
        choices = [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.IfExp)]
        found += [(path, node.lineno) for node in choices if "ti.static" in ast.unparse(node.test)]
    assert not found
