"""Settings of cloth."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from common.registry import added, names
from scene.extra import Added, of_packages
from scene.settings import Name, Settings
from scene.units import (
    AngularVelocity,
    AreaDensity,
    Density,
    Dimensionless,
    Direction,
    Duration,
    Position,
    PositiveDuration,
    PositiveLength,
    PositiveSpeed,
    Unit,
    Velocity,
)
from sim.cloth import INTEGRATORS
from sim.geometry.spec import ClothShape, Placement, Rotation

if TYPE_CHECKING:
    from sim.cloth.fabrics import Fabric

Stiffness = Annotated[float, Gt(0), Le(1e12), Unit("N/m")]
ShearStiffness = Annotated[float, Ge(0), Le(1e12), Unit("N/m")]
BendStiffness = Annotated[float, Ge(0), Le(1e9), Unit("N*m")]
Ratio = Annotated[Dimensionless, Ge(0), Le(1)]
Coefficient = Annotated[Dimensionless, Ge(0), Le(100)]
Friction = Annotated[Dimensionless, Ge(0), Le(10)]
Poisson = Annotated[Dimensionless, Ge(-10), Le(10)]
Delay = Annotated[Duration, Le(10)]
Side = Literal["corners", "left", "right", "front", "back"]
FabricName = Literal[
    "blanket", "cotton_knit", "denim", "jersey", "ponte", "swimwear", "tablecloth", "trousers", "windbreaker"
]
MASS_PER_AREA = 0.2
"""Where nothing is said of it [kg/m^2]."""


class PinKeyframe(Settings):
    """Pose of pinned points at one time; they move to the next in a straight line and at a constant rate of
    rotation, the shorter way round."""

    at: Duration
    """Simulated time [s]."""
    offset: Position = (0.0, 0.0, 0.0)
    """Displacement from where the points were placed [m]."""
    rotation: tuple[Rotation, ...] = ()
    """Rotations about the centre of the points, applied in the order given."""


class Pin(Settings):
    """Mass points that are held or moved."""

    at: Side | tuple[Position, ...]
    """A side or the corners of a sheet; or positions, each of which pins the nearest mass point as placed."""
    keyframes: tuple[PinKeyframe, ...] = ()
    """Path of the points, sorted by time; they are at rest before the first and after the last."""
    velocity: Velocity = (0.0, 0.0, 0.0)
    """Without keyframes, constant velocity of the centre of the points [m/s]."""
    angular_velocity: AngularVelocity = (0.0, 0.0, 0.0)
    """Likewise, about that centre [rad/s]."""

    @model_validator(mode="after")
    def _is_led_one_way(self) -> Self:
        if self.keyframes and (any(self.velocity) or any(self.angular_velocity)):
            raise ValueError("keyframes exclude velocity and angular_velocity: give one of the two")
        for earlier, later in itertools.pairwise(self.keyframes):
            if later.at <= earlier.at:
                raise ValueError(f"the keyframe at {later.at:g} s follows the one at {earlier.at:g} s: sort by time")
        return self


class FabricSettings(Settings):
    """What cloth of finite elements resists by, along and across its threads.

    What is left out comes from the fabric named in `type`, or else from the sheet's stretch_stiffness,
    shear_stiffness and bend_stiffness, the same in all directions.
    """

    type: FabricName | None = None
    """One that was measured by Wang et al. 2011: jeans are `denim`, a T-shirt is `jersey`, underwear `cotton_knit`, a
    polyester jacket `windbreaker`, a jersey jacket `ponte`."""
    warp_stiffness: Stiffness | None = None
    """Force per width and strain [N/m] of a strip along the warp that may contract."""
    weft_stiffness: Stiffness | None = None
    """The same along the weft."""
    poisson_ratio: Poisson | None = None
    """How far the weft contracts over how far the warp is stretched, in a strip along the warp."""
    shear_stiffness: Stiffness | None = None
    """Force per width and angle between warp and weft [N/m]."""
    warp_bending: BendStiffness | None = None
    """Moment per width and curvature of a strip along the warp [N m]."""
    weft_bending: BendStiffness | None = None
    """The same along the weft."""
    bias_bending: BendStiffness | None = None
    """The same at 45 degrees to both [N m]; by default their mean, and at least half of that."""
    damping_time: Delay = 0.0001
    """Stress by the rate of strain over that by strain [s]: a swing of f [Hz] has the damping ratio pi f times it."""
    bend_damping_time: Delay = 0.001
    """The same for bending."""
    warp: Direction = (1.0, 0.0, 0.0)
    """Direction of the warp in the sheet's own axes, as it is before `rotation`; of a mesh, laid on each triangle."""

    @model_validator(mode="after")
    def _has_a_warp(self) -> Self:
        if sum(component * component for component in self.warp) < 1e-12:
            raise ValueError("warp must not be zero: give a direction, as [1, 0, 0]")
        return self


class ClothSheet(Placement):
    """One piece of cloth: masses with springs between them, or a shell of finite elements (`cloth.model`)."""

    shape: ClothShape
    spacing: PositiveLength | None = None
    """Distance of neighbouring mass points of a sheet [m], rounded so that it divides both sides; by default a
    fortieth of the longer side. A mesh has its own points."""
    mass_per_area: AreaDensity | None = None
    """[kg/m^2]; by default 0.2, or that of the `type` of its fabric."""
    fabric: FabricName | FabricSettings = FabricSettings()
    """With `model: fem`: the name of a fabric, or what it resists by in each direction."""
    stretch_stiffness: Stiffness = 1000.0
    """Force per width and strain [N/m] of a strip pulled along its threads, at any resolution."""
    shear_stiffness: ShearStiffness | None = None
    """Force per width and angle [N/m] of a sheet; by default half of `stretch_stiffness`. A mesh of equal triangles
    has 3/8."""
    bend_stiffness: BendStiffness = 1e-4
    """Moment per width and curvature [N m]."""
    bend_model: Literal["dihedral", "springs"] = "dihedral"
    """Angles between triangles; or springs to the next-but-one points, which have no resistance while the cloth is
    flat."""
    damping: Ratio = 0.02
    """Damping ratio of each spring with the two masses at its ends: 1 is critical."""
    bend_damping: Ratio = 0.02
    """The same for bending."""
    rest_scale: Annotated[Dimensionless, Ge(0), Le(100)] = 1.0
    """Rest lengths over the lengths as placed: above 1 the cloth starts loose, below 1 taut."""
    thickness: PositiveLength = 0.002
    """Distance of its mid-surface from that of another cloth that lies on it; half of it from solids [m]. Points
    closer than twice that at rest may approach to half of their rest distance, so that cloth finer than it is thick
    can bend."""
    friction: Friction = 0.3
    """Coefficient of Coulomb friction while sliding; a contact uses the geometric mean of both surfaces."""
    static_friction: Friction | None = None
    """The coefficient at rest, at least that while sliding, which is the default."""
    pins: tuple[Side | Pin, ...] = ()
    """Mass points that are held or moved; an event may release them by setting other pins."""
    velocity: Velocity = (0.0, 0.0, 0.0)

    @property
    def density(self) -> float:
        """Mass per area [kg/m^2]."""
        if self.mass_per_area is not None:
            return self.mass_per_area
        return self.resistance.mass_per_area if self.woven.type else MASS_PER_AREA

    @property
    def woven(self) -> FabricSettings:
        """Its fabric, which a name may stand for."""
        return FabricSettings(type=self.fabric) if isinstance(self.fabric, str) else self.fabric

    @property
    def resistance(self) -> Fabric:
        """What it resists by as a shell."""
        from sim.cloth.fabrics import resistance

        return resistance(self)

    @property
    def bends(self) -> bool:
        """Whether a shell of it resists bending."""
        return max(self.resistance.warp_bending, self.resistance.weft_bending) > 0

    @property
    def friction_coefficients(self) -> tuple[float, float]:
        """Coefficients of friction while sliding and at rest."""
        return self.friction, self.friction if self.static_friction is None else self.static_friction

    @model_validator(mode="after")
    def _fits_its_shape(self) -> Self:
        if self.static_friction is not None and self.static_friction < self.friction:
            raise ValueError("static_friction must be at least friction: raise it, or lower friction")
        if self.shape.type == "mesh":
            for name in ("spacing", "shear_stiffness"):
                if getattr(self, name) is not None:
                    raise ValueError(f"{name} is for sheets: a mesh brings points and triangles of its own; remove it")
            sides = [pin if isinstance(pin, str) else pin.at for pin in self.pins]
            if any(isinstance(side, str) for side in sides):
                raise ValueError("a mesh has no sides or corners: give places to pin, as `at: [[x, y, z]]`")
        return self


class Air(Settings):
    """Air around the cloth, which exerts drag on it."""

    density: Density = 1.2
    wind: Velocity = (0.0, 0.0, 0.0)
    drag: Coefficient = 1.3
    """Drag coefficient of flow across the cloth: force over density/2 * area * speed^2."""
    skin_friction: Coefficient = 0.02
    """Likewise of flow along it, both faces together."""


class ImplicitEuler(Settings):
    """Newton's method and conjugate gradients."""

    velocity_error: PositiveSpeed = 0.01
    """Newton's method ends once no velocity changes by more than this [m/s], and forces are balanced."""
    force_error: Annotated[Dimensionless, Gt(0), Le(50)] = 1e-2
    """Forces are balanced when their residual is, on average, this share of those that accelerate the cloth in the
    step, or of its weight. With 10, most steps take one or two linear solves."""
    max_newton: Annotated[int, Ge(1), Le(1000)] = 20
    linear_error: Annotated[Dimensionless, Gt(0), Le(0.5)] = 0.03
    """Of each linear system: residual over the initial one."""
    max_iterations: Annotated[int, Ge(1), Le(100_000)] = 1000
    """Of conjugate gradients in each Newton step."""


class SymplecticEuler(Settings):
    """Explicit steps, as many as stability requires."""

    share: Annotated[Dimensionless, Gt(0), Le(1)] = 0.69
    """Length of a step over the longest stable one."""


class XPBD(Settings):
    """Small steps of extended position-based dynamics."""

    substeps: Annotated[int, Ge(1), Le(10_000)] = 10
    """In each step."""
    iterations: Annotated[int, Ge(1), Le(1000)] = 1
    """Sweeps over all springs in each of them."""


class Cloth(Settings):
    """The cloth of the scene."""

    sheets: Annotated[dict[Name, ClothSheet], Field(min_length=1)]
    model: Literal["springs", "fem"] = "springs"
    """Masses and springs; or a shell of finite elements, whose stiffness does not depend on the mesh, with fabrics that
    differ along and across their threads."""
    integrator: Literal[(*INTEGRATORS, *names("integrators", *INTEGRATORS))] = "implicit_euler"
    max_step: Annotated[PositiveDuration, Le(0.1)] = 0.005
    """Longest time step of a scene with cloth [s]."""
    air: Air | None = None
    """Without air, the cloth is in a vacuum."""
    implicit_euler: ImplicitEuler = ImplicitEuler()
    symplectic_euler: SymplecticEuler = SymplecticEuler()
    xpbd: XPBD = XPBD()
    extra: Annotated[dict[Name, Added], of_packages("integrators")] = {}
    """Settings of integrators that installed packages add, by their names."""

    @model_validator(mode="after")
    def _suits_its_model(self) -> Self:
        if self.model == "fem":
            from sim.cloth.fabrics import refuse_unfit

            for name, sheet in self.sheets.items():
                refuse_unfit(f"sheets.{name}", sheet)
        woven = [name for name, sheet in self.sheets.items() if sheet.woven != FabricSettings()]
        if woven and self.model == "springs":
            raise ValueError(f"sheets.{woven[0]}.fabric is for finite elements: give cloth `model: fem`, or remove it")
        return self

    @property
    def integrator_settings(self) -> Any:
        """Those of the chosen integrator."""
        if self.integrator in type(self).model_fields:
            return getattr(self, self.integrator)
        return self.extra.get(self.integrator) or added("integrators")[self.integrator]()
