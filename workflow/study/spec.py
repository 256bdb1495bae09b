"""Typed settings of a study."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Le, MinLen
from pydantic import Field, model_validator

from sim.settings import Name, Settings
from sim.units import Duration, PositiveDuration
from workflow.scene import Quality

Formula = str | float
"""A number, or arithmetic with the names that it is given."""
Overrides = dict[str, Any]
"""Values by dotted path, as `fluid.solver: dfsph`."""


class Quantity(Settings):
    """One number, or one curve over time, of what a simulation wrote."""

    name: str
    """What it is, for the axis of the plot, as `height of the crest`."""
    table: Literal["probes", "bodies", "steps"] = "probes"
    """Which table holds it."""
    of: Name | None = None
    """The probe or the body; steps have none."""
    column: str
    """A column of the table; of probes what they measure, as `water_height` or `force_y`."""
    take: Literal["curve", "last", "mean", "maximum", "minimum", "period", "change"] = "last"
    """`curve`: every value over time; `period`: of a decaying oscillation [s]; `change`: the largest difference to the
    first value."""
    after: Duration = 0.0
    """Values before are left out [s]."""
    until: PositiveDuration | None = None
    """Values later are left out [s]."""

    @model_validator(mode="after")
    def _named(self) -> Self:
        if (self.of is None) != (self.table == "steps"):
            raise ValueError("of names the probe or the body, and is for no table but these two")
        if self.until is not None and self.until <= self.after:
            raise ValueError("until has to be later than after")
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


Reference = Annotated[ByFormula | ByTable | ByTrial, Field(discriminator="type")]


class Study(Settings):
    """A study: `snakemake --cores all studies/NAME` for the file `scenes/studies/NAME.yaml`."""

    description: str
    """What is asked, in a sentence."""
    scene: str
    """The scene's file, relative to the study's."""
    quality: Quality | None = None
    """Its preset; without it the scene's own."""
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
    limit: Annotated[PositiveDuration, Le(1e6)] = 600.0
    """Wall time after which a trial is given up [s]."""
    color: str | None = None
    """Path of the setting that colours tell; without it the first that varies."""
    shape: str | None = None
    """Path of the setting that the shapes of points tell; without it the second that varies."""

    @model_validator(mode="after")
    def _legend_is_varied(self) -> Self:
        for field in ("color", "shape"):
            path = getattr(self, field)
            if path is not None and path not in self.paths():
                raise ValueError(f"{field} names a setting that no grid varies: one of {', '.join(self.paths())}")
        return self

    def paths(self) -> list[str]:
        """All settings that a grid varies, in order."""
        return list(dict.fromkeys(path for grid in self.grids for path in grid))
