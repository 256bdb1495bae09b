"""How far points of a scene are from one another, and how large the materials are that they make up."""

from __future__ import annotations

from scene.load import Scene
from sim.cloth.spec import ClothSheet
from workflow.plan.memory import fluid_volume

FLUID = "fluid.particle_radius"
SHEETS = "cloth.sheets"


def spacing(scene: Scene) -> float:
    """What tells how fine a scene is simulated [m]: of particles, else of the finest cloth; 1 for neither."""
    simulation = scene.simulation
    if simulation.fluid is not None:
        return simulation.fluid.spacing
    sheets = simulation.cloth.sheets.values() if simulation.cloth is not None else ()
    return min((sheet.spacing for sheet in sheets if sheet.spacing), default=1.0)


def scaled(scene: Scene, factor: float) -> dict[str, float]:
    """Settings [m], by path, with which all spacings are so many times as large."""
    simulation, found = scene.simulation, {}
    if simulation.fluid is not None:
        found[FLUID] = factor * simulation.fluid.particle_radius
    for name, sheet in simulation.cloth.sheets.items() if simulation.cloth is not None else ():
        if sheet.spacing:
            found[f"{SHEETS}.{name}.spacing"] = factor * sheet.spacing
    return found


def is_spacing(path: str) -> bool:
    """Whether the setting at a path tells how far points are from one another."""
    return path == FLUID or (path.startswith(f"{SHEETS}.") and path.endswith(".spacing"))


def fineness_of_spacing(scene: Scene, path: str) -> float:
    """How many spacings go over the size of the fluid, or of the sheet of which `path` tells."""
    if path == FLUID:
        return fluid_size(scene) / spacing(scene)
    name = path.split(".")[2]
    found = _sheet(scene, name).spacing
    if found is None:
        raise ValueError(f"{name} has no spacing of its own")
    return sheet_size(scene, name) / found


def fluid_size(scene: Scene) -> float:
    """Edge of a cube that holds all fluid [m]."""
    return fluid_volume(scene) ** (1 / 3)


def sheet_size(scene: Scene, name: str) -> float:
    """The longer edge of a sheet [m]."""
    size = _sheet(scene, name).shape.size
    if not isinstance(size, tuple):
        raise ValueError(f"{name} is a mesh, whose size is no edge")
    return max(size)


def _sheet(scene: Scene, name: str) -> ClothSheet:
    cloth = scene.simulation.cloth
    if cloth is None:
        raise KeyError(name)
    return cloth.sheets[name]


def resolving(scene: Scene, fluid: float | None = None, cloth: float | None = None) -> dict[str, float]:
    """Settings [m], by path, with which so many spacings go over fluid and sheets; none changes what it is."""
    found = {}
    if fluid is not None:
        found[FLUID] = fluid_size(scene) / fluid / 2
    if cloth is not None and scene.simulation.cloth is not None:
        for name, sheet in scene.simulation.cloth.sheets.items():
            if sheet.spacing:
                found[f"{SHEETS}.{name}.spacing"] = sheet_size(scene, name) / cloth
    return found
