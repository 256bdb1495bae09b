"""Typed settings of a study."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Le, MinLen
from pydantic import Field, model_validator

from scene.presets import Quality
from scene.settings import Name, Settings
from scene.units import Duration, PositiveDuration

Formula = str | float
"""A number, or arithmetic with the names that it is given."""
Overrides = dict[str, Any]
"""Values by dotted path, as `fluid.solver: dfsph`."""


class Quantity(Settings):
    """One number, or one curve over time, of what a simulation wrote."""

    name: str
    """What it is, for the axis of the plot, as `height of the crest`."""
    table: Literal["probes", "bodies", "steps", "surface", "picture"] = "probes"
    """Which table of the simulation holds it; or the surface, or the picture."""
    of: Name | None = None
    """The probe or the body; others have none."""
    column: str = "value"
    """A column of the table; of probes what they measure, as `water_height` or `force_y`. Of a surface `volume`,
    `area`, or `distance`: the RMS over its vertices of a formula. Of a picture nothing: it is compared whole."""
    distance: Formula | None = None
    """How far the point x, y, z [m] is from where the surface should be [m]."""
    take: Literal["curve", "last", "mean", "maximum", "minimum", "period", "change"] = "last"
    """`curve`: every value over time; `period`: of a decaying oscillation [s]; `change`: the largest difference to the
    first value."""
    after: Duration = 0.0
    """Values before are left out [s]."""
    until: PositiveDuration | None = None
    """Values later are left out [s]."""

    @model_validator(mode="after")
    def _named(self) -> Self:
        if (self.of is not None) != (self.table in {"probes", "bodies"}):
            raise ValueError(
                "of names the probe or the body of these two tables: add it for them, and leave it out for others"
            )
        if (self.distance is not None) != (self.table == "surface" and self.column == "distance"):
            raise ValueError("distance is the formula of a surface's column distance: give both or neither")
        if self.table == "surface" and self.column not in {"volume", "area", "distance"}:
            raise ValueError("the column of a surface must be one of three: write volume, area or distance")
        if self.until is not None and self.until <= self.after:
            raise ValueError("until must be later than after: raise it, or leave it out")
        return self


class ByFormula(Settings):
    """A closed form. `t` in it is the time [s] of a curve."""

    type: Literal["formula"]
    value: Formula
    where: dict[Name, Formula] = {}
    """Names in the formula, each a number or a formula with the names before it."""
    source: str
    """Author, year and equation."""


class ByTable(Settings):
    """A measured curve: a CSV file with times in its first and values in its second column; lines that begin with
    no number are skipped."""

    type: Literal["table"]
    file: str
    """Relative to the study's file."""
    time_unit: Formula = 1.0
    """One of the file's times [s]."""
    value_unit: Formula = 1.0
    """One of the file's values, in the unit of the quantity."""
    where: dict[Name, Formula] = {}
    """Names in the two formulas."""
    source: str


class ByTrial(Settings):
    """The simulation itself with the most accurate settings."""

    type: Literal["trial"]
    set: Annotated[Overrides, MinLen(1)]


TABLES = {"simulate": ("probes", "bodies", "steps"), "reconstruct": ("surface",), "render": ("picture",)}
"""What can be measured of each stage."""

Reference = Annotated[ByFormula | ByTable | ByTrial, Field(discriminator="type")]


class Study(Settings):
    """A study: `snakemake --cores all studies/NAME` for the file `scenes/studies/NAME.yaml`."""

    description: str
    """What is asked, in a sentence."""
    scene: str
    """The scene's file, relative to the study's."""
    quality: Quality | None = None
    """Its preset; without it the scene's own."""
    stage: Literal["simulate", "reconstruct", "render"] = "simulate"
    """What is tried: a simulation of the whole scene, or one frame's surface or picture."""
    frame: Annotated[int, Ge(0)] | None = None
    """Which frame, of surfaces and pictures; without it the last."""
    set: Overrides = {}
    """Settings of all trials."""
    grids: Annotated[tuple[Annotated[dict[str, Annotated[tuple[Any, ...], MinLen(1)]], MinLen(1)], ...], MinLen(1)]
    """Values to try by dotted path; every combination within a grid becomes a trial."""
    quantity: Quantity
    reference: Reference
    scale: Formula | None = None
    """What the error is divided by; without it the reference, of a curve the largest value of it."""
    repeats: Annotated[int, Ge(1), Le(100)] = 3
    """How often each trial is simulated, for the scatter of its time."""
    threads: Annotated[int, Ge(1), Le(1024)] = 1
    """Of one trial."""
    speaks_for: Literal["fluid", "rigid", "cloth"] | None = None
    """Simulations of this material have about its errors with its settings: `--config error=5%` goes by it."""
    limit: Annotated[PositiveDuration, Le(1e6)] = 600.0
    """Wall time after which a trial is given up [s]."""
    color: str | None = None
    """Path of the setting that colours tell; without it the first that varies."""
    shape: str | None = None
    """Path of the setting that the shapes of points tell; without it the second that varies."""

    @model_validator(mode="after")
    def _fits_its_stage(self) -> Self:
        if self.quantity.table not in TABLES[self.stage]:
            raise ValueError(
                f"the stage {self.stage} leaves no table {self.quantity.table}: "
                f"take one of {', '.join(TABLES[self.stage])}"
            )
        if self.stage == "simulate" and self.frame is not None:
            raise ValueError("frame is for surfaces and pictures, and a simulation runs to its end: leave it out")
        if self.quantity.table == "picture" and not isinstance(self.reference, ByTrial):
            raise ValueError("the reference of a picture must be a trial: write `type: trial`")
        wanted = {"reconstruct": "surface.", "render": "render."}.get(self.stage)
        others = self.reference.set if isinstance(self.reference, ByTrial) else ()
        for path in (*self.paths(), *self.set, *others):
            if wanted is None and path.partition(".")[0] in {"surface", "render", "film"}:
                raise ValueError(f"{path} changes nothing in a simulation: remove it from grids and set")
            if wanted is not None and not path.startswith(wanted):
                raise ValueError(
                    f"{path} is none of {wanted}*, which this stage is about: remove it from grids and set"
                )
        return self

    @model_validator(mode="after")
    def _legend_is_varied(self) -> Self:
        for field in ("color", "shape"):
            path = getattr(self, field)
            if path is not None and path not in self.paths():
                raise ValueError(f"{field} names a setting that no grid varies: one of {', '.join(self.paths())}")
        return self

    def files(self) -> list[tuple[tuple[str, ...], str]]:
        """Files that the study names: path of keys, and the file as written."""
        table = [(("reference", "file"), self.reference.file)] if isinstance(self.reference, ByTable) else []
        return [(("scene",), self.scene), *table]

    def paths(self) -> list[str]:
        """All settings that a grid varies, in order."""
        return list(dict.fromkeys(path for grid in self.grids for path in grid))
