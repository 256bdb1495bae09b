"""What of a scene stands still from its beginning to its end."""

from __future__ import annotations

from scene.events import apply
from sim.bodies.planes import PlaneWall, walls_of
from sim.bodies.wall import Wall
from sim.spec import MeshContainer, SimulationSpec


def standing_walls(spec: SimulationSpec) -> tuple[Wall, ...]:
    """Sides of box containers and half-spaces that no event removes or changes."""

    def place(wall: PlaneWall) -> tuple[float, ...]:
        return (*wall.normal, wall.offset)

    walls, current = walls_of(spec), spec.model_copy(update={"events": ()})
    for index, event in enumerate(spec.events):
        current = apply(current, event, index)
        left = {place(wall) for wall in walls_of(current)}
        walls = [wall for wall in walls if place(wall) in left]
    return tuple(Wall(normal=tuple(wall.normal), offset=wall.offset) for wall in walls)


def standing_vessels(spec: SimulationSpec) -> tuple[str, ...]:
    """Names of containers with a mesh of their own that no event removes or changes."""
    return tuple(name for name in standing_containers(spec) if isinstance(spec.containers[name], MeshContainer))


def standing_containers(spec: SimulationSpec) -> tuple[str, ...]:
    """Names of all containers that no event removes or changes."""
    current = spec.model_copy(update={"events": ()})
    left = dict(current.containers)
    for index, event in enumerate(spec.events):
        current = apply(current, event, index)
        left = {name: one for name, one in left.items() if current.containers.get(name) == one}
    return tuple(sorted(left))
