"""Rigid bodies and vessels as a simulation's files have them: `body_NAME.ply` with the rows of `bodies.csv`, and
`container_NAME.ply`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from common.simulation_files import BadTable, BodyState, BodyTable
from scene.settings import Refused

if TYPE_CHECKING:
    from sim.bodies.filmed import Body
    from sim.foam.bodies import Motion, Passing
    from workflow.stages.surface.solids import Solid


class Bodies:
    """Those of some folders of one simulation; raises Refused where a table or a mesh cannot be read."""

    def __init__(self, folders: Sequence[Path]):
        self._meshes = {path.stem.removeprefix("body_"): path for one in folders for path in one.glob("body_*.ply")}
        self._vessels = {
            path.stem.removeprefix("container_"): path for one in folders for path in one.glob("container_*.ply")
        }
        self._read_already: dict[Path, Body] = {}
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

    def solids(self, frame: int, vessels: Sequence[str] = ()) -> list[Solid]:
        """The bodies of a frame, by their names, and the vessels, which stay where they are; without half-spaces, which
        have no mesh."""
        return [*self.named_solids(frame, vessels).values()]

    def named_solids(self, frame: int, vessels: Sequence[str] = ()) -> dict[str, Solid]:
        """Likewise, by the names of their files without the ending."""
        from workflow.stages.surface.solids import Solid

        there = self._motions.get(frame, {})
        found = {}
        for name in sorted(there.keys() & self._meshes.keys()):
            motion = there[name]
            found[f"body_{name}"] = Solid(self._solid(name), motion.position, motion.rotation.as_matrix())
        return found | {f"container_{name}": Solid(self._vessel(name), np.zeros(3), np.eye(3)) for name in vessels}

    def _solid(self, name: str) -> Body:
        return self._mesh(self._meshes[name])

    def _vessel(self, name: str) -> Body:
        if name not in self._vessels:
            raise Refused(f"there is no container_{name}.ply", remedy="simulate the frames again")
        return self._mesh(self._vessels[name], closed=False)

    def _mesh(self, path: Path, *, closed: bool = True) -> Body:
        import trimesh

        from sim.bodies.filmed import Body

        if path not in self._read_already:
            try:
                mesh = trimesh.load_mesh(path, process=False, fix_texture=False)
            except (OSError, ValueError, KeyError, IndexError) as error:
                raise Refused(f"{path} is not a mesh: {error!r}", remedy="delete it, and simulate it again") from None
            self._read_already[path] = Body(mesh, closed=closed)
        return self._read_already[path]

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


def _named(kind: str, folders: Sequence[Path]) -> dict[str, Path]:
    return {path.stem.removeprefix(kind): path for folder in folders for path in folder.glob(f"{kind}*.ply")}


def _motion(body: BodyState) -> Motion:
    from scipy.spatial.transform import Rotation

    from sim.foam.bodies import Motion

    w, x, y, z = body.rotation
    return Motion(
        np.array(body.position),
        Rotation.from_quat((x, y, z, w)),
        np.array(body.velocity),
        np.array(body.angular_velocity),
    )
