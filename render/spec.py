"""Typed settings of the render stage: the scene file's `render:` section.

Lengths are in metres and y is up, as in the simulation. A direction is given by its azimuth
(0 deg is +z, the front; 90 deg is +x, the right) and its elevation above the horizon.
"""

from __future__ import annotations

import itertools
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le, Len, Lt
from pydantic import BeforeValidator, Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from common.registry import added
from render.color import Color, srgb
from scene.diagnostics.suggestions import suggestion
from scene.settings import Name, Settings
from scene.units import Angle, Dimensionless, Duration, Length, Position, PositiveLength, Unit

Fraction = Annotated[Dimensionless, Ge(0), Le(1)]
Elevation = Annotated[Angle, Ge(-89), Le(89)]
RefractiveIndex = Annotated[Dimensionless, Ge(1), Le(4)]
Pixels = Annotated[int, Ge(16), Le(16384)]
Irradiance = Annotated[float, Ge(0), Le(1e6), Unit("W/m^2")]
Power = Annotated[float, Ge(0), Le(1e9), Unit("W")]


class Water(Settings):
    """A clear liquid that tints the light on its way through."""

    type: Literal["water"] = "water"
    color: Color = srgb("#48abc9")
    """What is left of white light after `clarity` metres."""
    clarity: PositiveLength | None = None
    """Way through the liquid after which white light has the `color` [m]; without it, 0.4 of
    the diagonal of the box of the action, so that a glass and a harbour both look like water."""
    ior: RefractiveIndex = 1.333
    """Index of refraction."""
    roughness: Fraction = 0.0
    """0 is a mirror-smooth surface."""


PRINCIPLED_COLORS = ("Base Color", "Specular Tint", "Coat Tint", "Sheen Tint", "Emission Color")
PRINCIPLED_NUMBERS = (
    *("Metallic", "Roughness", "IOR", "Alpha", "Diffuse Roughness"),
    *("Subsurface Weight", "Subsurface Scale", "Subsurface IOR", "Subsurface Anisotropy"),
    *("Specular IOR Level", "Anisotropic", "Anisotropic Rotation", "Transmission Weight"),
    *("Coat Weight", "Coat Roughness", "Coat IOR", "Sheen Weight", "Sheen Roughness"),
    *("Emission Strength", "Thin Film Thickness", "Thin Film IOR"),
)


class PrincipledLook(Settings):
    """A look that Blender's Principled BSDF makes."""

    principled: dict[str, Dimensionless | Color] = {}
    """Inputs of Blender's Principled BSDF by their names in Blender, in place of what the look gives them, as
    `{Coat Weight: 1, Emission Color: "#ff8800", Emission Strength: 3}`."""

    @field_validator("principled")
    @classmethod
    def _inputs_that_it_has(cls, values: dict[str, Any]) -> dict[str, Any]:
        for name, value in values.items():
            if name not in PRINCIPLED_COLORS + PRINCIPLED_NUMBERS:
                close = suggestion(name, PRINCIPLED_COLORS + PRINCIPLED_NUMBERS)
                raise ValueError(f"the Principled BSDF has no input '{name}' that can be set: {close}")
            if isinstance(value, tuple) is not (name in PRINCIPLED_COLORS):
                kind, example = ("colour", "'#ff8800'") if name in PRINCIPLED_COLORS else ("number", "0.5")
                raise ValueError(f"{name} must be a {kind}: write one, as {example}")
        return values


class Plastic(PrincipledLook):
    """A coloured body under a clear, slightly glossy coat."""

    type: Literal["plastic"]
    color: Color | None = None
    """Without it, the colours that a body's mesh file gives to its vertices, or `#e4572e` where it gives none."""
    roughness: Fraction = 0.3
    """0 is a mirror-smooth surface."""


class Metal(PrincipledLook):
    """Bare metal."""

    type: Literal["metal"]
    color: Color = srgb("#c9ccd1")
    """Colour of the reflection."""
    roughness: Fraction = 0.25
    """0 is a mirror, 0.25 brushed, 0.5 cast."""


class Stone(PrincipledLook):
    """Rough stone with grains and stains."""

    type: Literal["stone"]
    color: Color = srgb("#8d8a84")
    roughness: Fraction = 0.75
    """0 is polished."""
    grain: PositiveLength | None = None
    """Size of the stains [m]; the grains are a tenth of it. Without it, a fifth of the body's diagonal."""


class Matte(Settings):
    """Chalk, paper, clay: no gloss at all."""

    type: Literal["matte"]
    color: Color = srgb("#d9d5cc")


class ClothLook(PrincipledLook):
    """Woven cloth: soft, with a sheen at grazing angles, letting some light through."""

    type: Literal["cloth"]
    color: Color = srgb("#b23a48")
    roughness: Fraction = 0.8
    """Of the sheen; 0.3 is satin, 1 felt."""
    sheen: Fraction = 0.3
    """Strength of the sheen."""
    translucency: Fraction = 0.15
    """Share of the light that comes through to the other side."""


class Glass(Settings):
    """Clear glass."""

    type: Literal["glass"]
    color: Color = srgb("#fcfefd")
    """Colour of what is seen through one surface."""
    ior: RefractiveIndex = 1.5
    """Index of refraction."""
    roughness: Fraction = 0.0
    """0 is clear, 0.3 frosted."""


LOOKS = (Water, Plastic, Metal, Stone, Matte, ClothLook, Glass, *added("looks").values())

if TYPE_CHECKING:
    Look = Any
else:
    Look = Annotated[reduce(or_, LOOKS), Field(discriminator="type")]


def _water_unless_told(value: Any) -> Any:
    return {"type": "water", **value} if isinstance(value, dict) else value


def _changed(settings: Settings, *names: str) -> list[str]:
    """Which of the settings differ from their defaults: what a canonical dump sets is not what a user wrote."""
    return [name for name in names if getattr(settings, name) != type(settings).model_fields[name].default]


class DepthOfField(Settings):
    """What is nearer or farther than the focus is blurred."""

    f_stop: Annotated[Dimensionless, Gt(0), Le(1000)] = 2.8
    """Focal length over aperture: the smaller, the more blur. The lens is that of a full-frame camera."""
    focus: Position | None = None
    """The point in focus [m]; without it, what the camera looks at."""


class CameraKeyframe(Settings):
    """Where the camera is at one time."""

    at: Duration
    """Simulated time [s]."""
    position: Position
    """Where it stands [m]."""
    target: Position
    """What it looks at [m]."""
    field_of_view: Annotated[Angle, Gt(1), Lt(170)] | None = None
    """Across the longer side of the picture; without it, that of the camera."""

    @model_validator(mode="after")
    def _faces_a_direction(self) -> Self:
        if self.position == self.target:
            raise ValueError("position and target must differ: move one of them")
        return self


class Camera(Settings):
    """Placed by `position` and `target`, or moved by `keyframes`; without them it frames the box of the action by
    itself."""

    position: Position | None = None
    """Where the camera stands [m]."""
    target: Position | None = None
    """What it looks at [m]."""
    keyframes: Annotated[tuple[CameraKeyframe, ...], Len(0, 1000)] = ()
    """A camera that moves: smoothly through these places, softly from the first and to the last."""
    azimuth: Angle = 24.0
    """Automatic framing: from which side it looks; 0 deg is from the front (+z), 90 deg from the right (+x)."""
    elevation: Elevation = 17.0
    """Automatic framing: how high above the horizon it stands."""
    margin: Annotated[Dimensionless, Ge(0), Le(0.8)] = 0.1
    """Automatic framing: share of the picture's half width and half height that stays free."""
    field_of_view: Annotated[Angle, Gt(1), Lt(170)] = 32.0
    """Across the longer side of the picture."""
    focal_length: PositiveLength | None = None
    """Instead of the field of view: that of a full-frame camera (36 mm across the longer side), as `50 mm`."""
    depth_of_field: DepthOfField | None = None
    """Without it everything is in focus."""

    @model_validator(mode="after")
    def _placed_or_automatic(self) -> Self:
        if (self.position is None) != (self.target is None):
            raise ValueError("position and target belong together: give both, or neither for automatic framing")
        if len(self.keyframes) == 1:
            raise ValueError("one keyframe is no move: give two or more, or position and target")
        if any(early.at >= late.at for early, late in itertools.pairwise(self.keyframes)):
            raise ValueError("the times of the keyframes must grow: sort them, no two at the same")
        if self.keyframes and self.position is not None:
            raise ValueError("keyframes and position exclude each other: remove one of them")
        if self.position is not None or self.keyframes:
            if self.position is not None and self.position == self.target:
                raise ValueError("position and target must differ: move one of them")
            idle = _changed(self, "azimuth", "elevation", "margin")
            if idle:
                raise ValueError(
                    f"{', '.join(idle)} of the automatic framing and a camera that is placed exclude each other: "
                    "remove one of them"
                )
        if self.focal_length is not None and _changed(self, "field_of_view"):
            raise ValueError("field_of_view and focal_length exclude each other: remove one of them")
        return self


def _camera_is_there(value: Any) -> Any:
    if value is None:
        raise PydanticCustomError(
            "camera_missing",
            "camera missing: leave the key out for automatic framing, or give position and target",
        )
    return value


class Sun(Settings):
    """A far light: parallel rays."""

    azimuth: Angle = -48.0
    """Where it stands; 0 deg is the front (+z), 90 deg the right (+x)."""
    elevation: Annotated[Angle, Gt(0), Le(90)] = 42.0
    """How high above the horizon it stands."""
    strength: Irradiance = 4.5
    """Irradiance of a surface that faces it [W/m^2]; 0 switches it off."""
    color: Color = srgb("#fff1df")
    angle: Annotated[Angle, Ge(0), Le(90)] = 2.0
    """Apparent diameter: the larger, the softer the shadows; the sun of the sky has 0.5 deg."""


class AreaLight(Settings):
    """A square lamp."""

    position: Position
    """Its centre [m]."""
    target: Position = (0.0, 0.0, 0.0)
    """The point it faces [m]."""
    size: PositiveLength = 1.0
    """Edge length [m]: the larger, the softer the shadows."""
    power: Power = 100.0
    """Radiant power [W]."""
    color: Color = (1.0, 1.0, 1.0)

    @model_validator(mode="after")
    def _faces_a_direction(self) -> Self:
        if self.position == self.target:
            raise ValueError("position and target must differ: move one of them")
        return self


class Environment(Settings):
    """Light from all around, from a panorama."""

    light: Literal["city", "courtyard", "forest", "interior", "night", "studio", "sunrise", "sunset"] = "forest"
    """A panorama that Blender brings."""
    file: Annotated[str, Field(min_length=1)] | None = None
    """Instead of `light`: an HDR panorama (.hdr, .exr; equirectangular), relative to the scene file."""
    strength: Annotated[Dimensionless, Ge(0), Le(1e6)] = 0.4
    """Factor on the panorama's brightness; 0 switches it off."""
    rotation: Angle = 0.0
    """Turn of the panorama about the vertical."""

    @model_validator(mode="after")
    def _one_panorama(self) -> Self:
        if self.file is not None and _changed(self, "light"):
            raise ValueError("light and file exclude each other: remove one of them")
        return self


class Lights(Settings):
    """What lights the scene."""

    sun: Sun = Sun()
    areas: tuple[AreaLight, ...] = ()
    environment: Environment = Environment()

    @model_validator(mode="after")
    def _not_dark(self) -> Self:
        lit = (self.sun.strength, self.environment.strength, *(area.power for area in self.areas))
        if not any(lit):
            raise ValueError("no light is left: keep the sun, the environment or an area light")
        return self


class EnvironmentBackground(Settings):
    """The panorama of the environment itself."""

    type: Literal["environment"]


class PlainBackground(Settings):
    """One colour."""

    type: Literal["plain"]
    color: Color = srgb("#cfdbe3")


class GradientBackground(Settings):
    """From one colour at the horizon to another overhead."""

    type: Literal["gradient"]
    horizon: Color = srgb("#e0d9cd")
    zenith: Color = srgb("#a9bfcc")


Background = Annotated[EnvironmentBackground | PlainBackground | GradientBackground, Field(discriminator="type")]


class Ground(Settings):
    """A plane that ends at the horizon, where it fades into the background."""

    enabled: bool = True
    height: Length | None = None
    """[m]; without it, that of the level plane among the bodies, or of the lowest point of the action."""
    material: Look = Matte(type="matte", color=srgb("#dcd6cc"))


class Walls(Settings):
    """How containers are drawn that `materials` names."""

    thickness: PositiveLength | None = None
    """Outwards from the inner surface [m]; without it, a hundredth of the diagonal of the box of the action."""
    overlap: PositiveLength | None = None
    """How far the wall reaches into the water, so that no film of air shows between them [m];
    without it, a quarter of the thickness."""


class RenderSpec(Settings):
    """Everything that the pictures depend on, apart from what is in them."""

    resolution: tuple[Pixels, Pixels] = (640, 360)
    """Width and height of the pictures."""
    samples: Annotated[int, Ge(1), Le(65536)] = 24
    """Light paths a pixel, at most: the more, the less noise."""
    noise_threshold: Fraction = 0.02
    """Pixels with less noise than this get no more samples; 0 gives every pixel all of them."""
    denoise: bool = True
    """Smooth what noise is left (Open Image Denoise)."""
    seed: Annotated[int, Ge(0), Lt(2**31)] = 0
    """Of the noise pattern."""
    animated_seed: bool = False
    """Another noise pattern in each frame: noise that is left then flickers like film grain, instead of hanging before
    the picture like a dirty window."""
    firefly_clamp: Annotated[Dimensionless, Ge(0), Le(1e6)] = 10.0
    """Brightest light of a path after its first bounce: the lower, the fewer single bright pixels, and the dimmer what
    light reaches by mirrors and water; 0 lets all through."""
    passes: tuple[Literal["depth", "normal", "motion", "objects", "materials"], ...] = ()
    """For compositing: written beside each picture as `00042.exr`, OpenEXR with many layers, in linear light and 32
    bits. `depth` [m], `normal`; `motion` between frames [px], only without motion blur; `objects` and `materials` as
    Cryptomatte."""
    bounces: Annotated[int, Ge(2), Le(128)] = 12
    """Surfaces that a light path crosses at most; too few make drops and thin sheets of water black."""
    motion_blur: bool = True
    """Blur what moves while the shutter is open."""
    shutter: Annotated[Dimensionless, Gt(0), Le(2)] = 0.5
    """How long the shutter is open, in frames."""
    device: Literal["auto", "cpu", "gpu"] = "auto"
    """`auto` takes a GPU when there is one, `gpu` refuses to do without."""
    blender: Annotated[str, Field(min_length=1)] | None = None
    """Path of an installed Blender to use instead of the bpy package."""
    view_transform: Literal["AgX", "Filmic", "Standard"] = "AgX"
    """From light to the colours of the screen."""
    contrast: Literal["low", "medium", "high"] = "high"
    """Of AgX and Filmic."""
    exposure: Annotated[Dimensionless, Ge(-20), Le(20)] = 0.0
    """In stops: each one doubles the brightness."""
    camera: Annotated[Camera, BeforeValidator(_camera_is_there)] = Camera()
    lights: Lights = Lights()
    background: Background = GradientBackground(type="gradient")
    """What the camera sees behind the scene."""
    ground: Ground = Ground()
    water: Annotated[Look, BeforeValidator(_water_unless_told)] = Water()
    """Look of the fluid; `type` may be left out for water."""
    foam: Look = Matte(type="matte", color=srgb("#f3f7f9"))
    """Look of foam, spray and bubbles, where the scene has them."""
    walls: Walls = Walls()
    materials: dict[Name, Look] = Field(default_factory=dict)
    """Looks of bodies, sheets and containers by name; a container that is not named is not drawn."""

    @model_validator(mode="after")
    def _passes_can_be_had(self) -> Self:
        if "motion" in self.passes and self.motion_blur:
            raise ValueError("the pass motion needs motion_blur: false")
        return self

    @model_validator(mode="after")
    def _background_exists(self) -> Self:
        if self.background.type == "environment" and self.lights.environment.strength == 0:
            raise ValueError("background: {type: environment} needs lights.environment.strength above 0")
        return self

    def named_bodies(self) -> tuple[str, ...]:
        """The keys of `materials`: each must be the name of a body, sheet or container of the scene."""
        return tuple(self.materials)

    def assets(self) -> tuple[tuple[tuple[str, ...], str], ...]:
        """Files that the pictures depend on: path of keys within `render:`, and the file as written."""
        file = self.lights.environment.file
        return () if file is None else ((("lights", "environment", "file"), file),)
