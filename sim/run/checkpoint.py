"""The state of a run between two frames: everything needed to go on, byte for byte."""

from __future__ import annotations

import json
import zipfile
import zlib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from common.files import whole
from scene.settings import Refused
from sim.run.probes.means import Gathered
from sim.run.state_head import Head
from sim.spec import SimulationSpec

if TYPE_CHECKING:
    from sim.cloth.fabric.state import ClothState
    from sim.fluid.births import Births
    from sim.fluid.model import FluidState
    from sim.rigid.body import RigidState

FORMAT = 6
UNREADABLE = (
    *(OSError, ValueError, KeyError, TypeError, EOFError, NotImplementedError, RuntimeError, SyntaxError),
    *(zipfile.BadZipFile, zlib.error, RecursionError, MemoryError),
)
"""What archives and arrays that are broken raise."""


@dataclass
class Clock:
    """Where a run stands in time."""

    frame: int = 0
    time: float = 0.0
    step: int = 0
    last_step: float = 0.0
    """The step [s] that was wanted last, before a frame cut it."""
    step_scale: float = 1.0
    """Factor on the step, below 1 while the run recovers from a fault."""


@dataclass
class Checkpoint:
    """A clock, the counts so far, the next times of the probes, what emitters have sent, particles and
    their births, bodies, cloth."""

    clock: Clock
    counts: dict[str, int]
    probe_times: dict[str, float]
    probe_means: dict[str, Gathered]
    emission: dict[str, Any]
    origin: np.ndarray
    fluid: FluidState | None
    births: Births | None = None
    rigid: RigidState | None = None
    cloth: ClothState | None = None
    one_thread: bool = False
    """Whether the run takes one thread, which decides how its numbers are rounded."""

    @property
    def bytes(self) -> int:
        """Size of the arrays, which is that of the file but for its head."""
        return sum(values.nbytes for values in self._arrays().values())

    def _arrays(self) -> dict[str, np.ndarray]:
        """What the materials hold, by the name that it has in the file."""
        materials = {"fluid": self.fluid, "births": self.births, "rigid": self.rigid, "cloth": self.cloth}
        return {
            f"{material}.{name}": values
            for material, state in materials.items()
            for name, values in (vars(state).items() if state is not None else ())
            if isinstance(values, np.ndarray)
        }

    def save(self, path: Path, spec: SimulationSpec) -> None:
        """Write all to a file that is whole or not there, with the settings of `spec` that a state cannot change."""
        meta = {
            "format": FORMAT,
            "clock": asdict(self.clock),
            "counts": self.counts,
            "probe_times": self.probe_times,
            "probe_means": {name: asdict(values) for name, values in self.probe_means.items()},
            "emission": self.emission,
            "layout": _layout(spec),
            "one_thread": self.one_thread,
        }
        if self.births is not None:
            meta["sources"] = self.births.names
        if self.rigid is not None:
            meta["dynamic_bodies"] = self.rigid.names
        if self.cloth is not None:
            meta["sheets"] = list(self.cloth.sheets.items())
        arrays: dict[str, Any] = {"meta": np.array(json.dumps(meta, sort_keys=True)), "origin": self.origin}
        arrays |= self._arrays()
        with whole(path) as stream:
            np.savez(stream, **arrays)

    @classmethod
    def load(cls, path: Path, spec: SimulationSpec) -> Checkpoint:
        """Raises Refused for a file that is no state, or one of a scene with other particles."""
        head, arrays = _read(path)
        if head.layout != _layout(spec):
            raise Refused(
                f"{path} was made with {head.layout}, the scene has {_layout(spec)}",
                remedy="resume with the settings it was made with, or start at frame 0",
            )
        _refuse_counts(path, head)
        fluid = births = rigid = cloth = None
        if spec.fluid is not None:
            from sim.fluid.births import Births
            from sim.fluid.model import FluidState

            fluid = FluidState(**_material(path, arrays, "fluid", FluidState()))
            _refuse_lengths(path, {len(values) for values in vars(fluid).values()})
            births = Births(head.sources, **_material(path, arrays, "births", Births()))
            _refuse_lengths(path, {len(births.first), len(births.time), len(births.source)})
            fault = births.fault(fluid.tag)
            if fault:
                raise _damaged(path, fault)
        if head.dynamic_bodies is not None:
            from sim.rigid.body import RigidState

            rigid = RigidState(head.dynamic_bodies, **_material(path, arrays, "rigid", RigidState()))
            bodies = (rigid.position, rigid.rotation, rigid.velocity, rigid.momentum, rigid.late)
            by_fluid = (rigid.fluid_force, rigid.fluid_torque, rigid.fluid_hold)
            _refuse_lengths(path, {len(rigid.names), *map(len, (*bodies, *by_fluid))})
        if head.sheets is not None:
            from sim.cloth.fabric.state import ClothState

            cloth = ClothState(dict(head.sheets), **_material(path, arrays, "cloth", ClothState()))
            points = {sum(cloth.sheets.values()), *map(len, (cloth.position, cloth.velocity, cloth.fluid_force))}
            _refuse_lengths(path, points)
            _refuse_lengths(path, {len(cloth.past_position), len(cloth.past_velocity)})
            touches = (cloth.touch_key, cloth.touch_weight, cloth.touch_normal, cloth.touch_force)
            _refuse_lengths(path, set(map(len, touches)))
        clock, emission = Clock(**head.clock.model_dump()), head.emission.model_dump(exclude_unset=True)
        origin = arrays.get("origin")
        if origin is None or origin.shape != (3,) or origin.dtype != np.float64 or not np.isfinite(origin).all():
            raise _damaged(path, "origin is missing or of another kind")
        means = {name: Gathered(**values.model_dump()) for name, values in head.probe_means.items()}
        told = clock, head.counts, head.probe_times, means, emission
        return cls(*told, origin, fluid, births, rigid, cloth, head.one_thread)


def state_name(frame: int) -> str:
    """File name of the state after a frame."""
    return f"state_{frame:05d}.npz"


def frame_of(path: Path) -> int:
    """The frame after which a state was saved; raises Refused for a file that is no state."""
    return _read(path)[0].clock.frame


def _read(path: Path) -> tuple[Head, dict[str, np.ndarray]]:
    """The contents of a state file; raises Refused for anything else."""
    try:
        with zipfile.ZipFile(path) as archive:
            # States are not compressed: what unpacks to more than its file would fill the memory.
            if sum(item.file_size for item in archive.infolist()) > path.stat().st_size:
                raise _damaged(path, "it holds more than its size")
            broken = archive.testzip()
        if broken:
            raise _damaged(path, f"{broken} is broken")
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        meta = json.loads(str(arrays["meta"]))
        found = meta["format"]
        head = Head.model_validate(meta) if found == FORMAT else None
    except FileNotFoundError:
        raise Refused(f"{path}: no such state", remedy="give a state_*.npz that a run has written") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise _damaged(path, f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from None
    except UNREADABLE as error:
        raise _damaged(path, str(error)) from None
    if head is None:
        raise Refused(f"{path} has format {found}, this version reads {FORMAT}", remedy="run anew")
    return head, arrays


def _material(path: Path, arrays: dict[str, np.ndarray], material: str, like: Any) -> dict[str, np.ndarray]:
    """All arrays of a material, of the kinds of those of `like`; raises Refused."""
    kinds = {name: kind for name, kind in vars(like).items() if isinstance(kind, np.ndarray)}
    return {name: _array(path, arrays, f"{material}.{name}", kind) for name, kind in kinds.items()}


def _refuse_counts(path: Path, head: Head) -> None:
    from sim.run.reporting.counts import Counts

    unknown = set(head.counts) - set(vars(Counts()))
    if unknown:
        raise _damaged(path, f"it counts {', '.join(sorted(unknown))}")


def _refuse_lengths(path: Path, lengths: set[int]) -> None:
    if len(lengths) > 1:
        raise _damaged(path, "its arrays differ in length")


def _array(path: Path, arrays: dict[str, np.ndarray], name: str, like: np.ndarray) -> np.ndarray:
    """One array of a material, of the kind of `like`; raises Refused where it is not."""
    values = arrays.get(name)
    if values is None or values.dtype != like.dtype or values.ndim != like.ndim or values.shape[1:] != like.shape[1:]:
        raise _damaged(path, f"{name} is missing or of another kind")
    if not np.isfinite(values).all():
        raise _damaged(path, f"{name} has values that are not finite")
    return values


def _damaged(path: Path, reason: str) -> Refused:
    remedy = "give an undamaged state_*.npz, or delete it and simulate the frames before it again"
    return Refused(f"{path} is not a state of a run ({reason})", remedy=remedy)


def _layout(spec: SimulationSpec) -> dict[str, Any]:
    """Settings that a state cannot change."""
    layout: dict[str, Any] = {"fps": spec.fps}
    if spec.precision != "single":
        layout["precision"] = spec.precision
    if spec.fluid is not None:
        layout |= {"particle_radius": spec.fluid.particle_radius, "support_ratio": spec.fluid.support_ratio}
    return layout
