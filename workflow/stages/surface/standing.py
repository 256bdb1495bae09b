"""What of a scene stands still from its beginning to its end."""

from __future__ import annotations

from scene.events import apply
from sim.bodies.planes import PlaneWall, walls_of
from sim.bodies.wall import Wall
from sim.spec import SimulationSpec


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
