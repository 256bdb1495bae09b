"""What is known of particles besides where they are and how fast, for the attributes of the surface."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from common.attributes import SHARE, columns_of
from common.ply import columns
from common.simulation_files import SOURCES, BadTable, Sources, read_sources
from scene.settings import Refused, given
from workflow.stages import stage
from workflow.stages.surface.spec import ReconstructSpec


@dataclass(frozen=True)
class Known:
    """Reads what the surface is asked for from the files of a simulation."""

    spec: ReconstructSpec
    sources: Sources | None
    """When particles came, and from where; None where nothing asked for needs that."""

    @classmethod
    def of(cls, spec: ReconstructSpec, simulation: Path) -> Known:
        """Raises Refused where a simulation does not say where its particles came from, and the surface is to."""
        asked = [name for name in ("age", "source") if name in spec.surface.attributes]
        if not asked:
            return cls(spec, None)
        stage.refuse_spoiled([simulation], SOURCES)
        try:
            found = read_sources(simulation)
        except FileNotFoundError:
            remedy = f"simulate anew, or leave {' and '.join(asked)} out of surface.attributes"
            message = f"{simulation / SOURCES} is missing, which tells when particles came"
            raise Refused(message, remedy=remedy) from None
        except BadTable as error:
            raise Refused(str(error), remedy="delete it, and simulate again") from None
        more = [] if spec.sources is None else sorted(set(found.names) - set(spec.sources))
        if more:
            raise Refused(
                f"particles of the simulation come from {', '.join(more)}, too", remedy="name all of them in sources"
            )
        return cls(spec, found)

    @property
    def names(self) -> list[str]:
        """The columns of the surface, in the order in which it is asked for them."""
        return list(columns_of(self.spec.surface.attributes, self._sources))

    @property
    def _sources(self) -> tuple[str, ...]:
        if self.spec.sources is not None or self.sources is None:
            return self.spec.sources or ()
        return self.sources.names

    def columns(self, particles: np.ndarray, frame: int) -> dict[str, np.ndarray]:
        """Of the particles of a frame, shape [n] each: density [kg/m^3]; age [s]; and 1 where they are of a source.

        Raises BadPly for particles without them, and Refused where they are not those of the simulation.
        """
        found = {}
        if "density" in self.spec.surface.attributes:
            found["density"] = columns(particles, ("density",))[:, 0]
        if self.sources is None:
            return found
        columns(particles[:0], ("id",))
        try:
            rows = np.array(self.sources.rows(particles["id"].tolist()), np.int64)
        except BadTable as error:
            raise Refused(str(error), remedy="simulate again") from None
        if "age" in self.spec.surface.attributes:
            # A layer that leaves at the time of a frame may have a rounding's less.
            found["age"] = np.maximum(frame / given(self.spec.fps) - np.array(self.sources.time)[rows], 0.0)
        number = np.array(self.sources.index, np.int64)[rows]
        own = {name: index for index, name in enumerate(self.sources.names)}
        return found | {f"{SHARE}{name}": (number == own.get(name, -1)).astype(float) for name in self._sources}
