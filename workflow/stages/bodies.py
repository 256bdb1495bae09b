"""Rigid bodies as a simulation's files have them: `body_NAME.ply` and the rows of `bodies.csv`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from common.simulation_files import BadTable, BodyState, BodyTable
from scene.settings import Refused

if TYPE_CHECKING:
    from sim.foam.bodies import Body, Motion, Passing


class Bodies:
    """Those of some folders of one simulation; raises Refused where a table or a mesh cannot be read."""

    def __init__(self, folders: Sequence[Path]):
        self._meshes = {path.stem.removeprefix("body_"): path for one in folders for path in one.glob("body_*.ply")}
        self._solids: dict[str, Body] = {}
        self._motions: dict[int, dict[str, Motion]] = {}
        for folder in folders:
            self._read(folder)

    def passing(self, frame: int) -> list[Passing]:
        """The bodies on their way to a frame from the one before, by their names; what only one of them has is left
        out, as are half-spaces, which have no mesh."""
        from sim.foam.bodies import Passing

        before, after = self._motions.get(frame - 1, {}), self._motions.get(frame, {})
        there = sorted(before.keys() & after.keys() & self._meshes.keys())
        return [Passing(self._solid(name), before[name], after[name]) for name in there]

    def _solid(self, name: str) -> Body:
        import trimesh

        from sim.foam.bodies import Body

        if name not in self._solids:
            path = self._meshes[name]
            try:
                mesh = trimesh.load_mesh(path, process=False)
            except (OSError, ValueError, KeyError, IndexError) as error:
                raise Refused(f"{path} is not a mesh: {error!r}", remedy="delete it, and simulate it again") from None
            self._solids[name] = Body(mesh)
        return self._solids[name]

    def _read(self, folder: Path) -> None:
        table = BodyTable(folder)
        if not table.path.exists():
            return
        try:
            for frame in table.times():
                moving = {name: _motion(body) for name, body in table.bodies(frame).items()}
                self._motions.setdefault(frame, {}).update(moving)
        except (OSError, BadTable) as error:
            raise Refused(str(error), remedy="delete it, and simulate it again") from None
        except ValueError as error:
            raise Refused(
                f"{table.path} has a rotation that is none: {error}", remedy="delete it, and simulate it again"
            ) from None


def _motion(body: BodyState) -> Motion:
    import numpy as np
    from scipy.spatial.transform import Rotation

    from sim.foam.bodies import Motion

    w, x, y, z = body.rotation
    return Motion(
        np.array(body.position),
        Rotation.from_quat((x, y, z, w)),
        np.array(body.velocity),
        np.array(body.angular_velocity),
    )
