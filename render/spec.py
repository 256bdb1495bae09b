"""Typed settings of the render stage: the scene file's `render:` section.

Lengths are in metres and y is up, as in the simulation. A direction is given by its azimuth
(0 deg is +z, the front; 90 deg is +x, the right) and its elevation above the horizon.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BeforeValidator, Field, field_validator, model_validator

from render.camera_settings import Camera, camera_is_there, changed
from render.color import Color, srgb
from render.looks.spec import FoamLook, Look, Matte, Water
from render.sets import Set, with_set
from render.texturing.spec import Fraction, Picture, Place, images_of
from scene.settings import Name, Settings
from scene.units import Angle, Dimensionless, Length, Position, PositiveDuration, PositiveLength, Unit

Pixels = Annotated[int, Ge(16), Le(16384)]
Irradiance = Annotated[float, Ge(0), Le(1e6), Unit("W/m^2")]
Power = Annotated[float, Ge(0), Le(1e9), Unit("W")]


def _water_unless_told(value: Any) -> Any:
    return {"type": "water", **value} if isinstance(value, dict) else value


def _foam_unless_told(value: Any) -> Any:
    return {"type": "foam", **value} if isinstance(value, dict) else value


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
    file: Picture | None = None
    """Instead of `light`: an HDR panorama (.hdr, .exr; equirectangular), relative to the scene file."""
    strength: Annotated[Dimensionless, Ge(0), Le(1e6)] = 0.4
    """Factor on the panorama's brightness; 0 switches it off."""
    rotation: Angle = 0.0
    """Turn of the panorama about the vertical."""

    @model_validator(mode="after")
    def _one_panorama(self) -> Self:
        if self.file is not None and changed(self, "light"):
            raise ValueError("light and file exclude each other: remove one of them")
        return self


class Lights(Settings):
    """What lights the scene."""

    sun: Sun = Sun()
    areas: tuple[AreaLight, ...] = ()
    softboxes: Irradiance = 0.0
    """Three large lamps around the action, sized with it: irradiance by the key light, left of the camera, of a surface
    that faces it [W/m^2]. The fill light, right of it, has a third of that, the rim light, behind
    the action, two thirds; 0 leaves them out."""
    environment: Environment = Environment()

    @model_validator(mode="after")
    def _not_dark(self) -> Self:
        lamps = (self.sun.strength, self.softboxes, *(area.power for area in self.areas))
        if not any((*lamps, self.environment.strength)):
            raise ValueError("no light is left: keep the sun, the environment, the softboxes or an area light")
        return self


class EnvironmentBackground(Settings):
    """The panorama of the environment itself."""

    type: Literal["environment"]
    blur: Annotated[Angle, Ge(0), Le(60)] = 0.0
    """As of a lens that is focused on the action: apparent diameter of what a point becomes."""


class PlainBackground(Settings):
    """One colour."""

    type: Literal["plain"]
    color: Color = srgb("#cfdbe3")


class GradientBackground(Settings):
    """From one colour at the horizon to another overhead."""

    type: Literal["gradient"]
    horizon: Color = srgb("#e0d9cd")
    zenith: Color = srgb("#a9bfcc")


class TransparentBackground(Settings):
    """Nothing: pictures have an alpha channel, in which the ground leaves only shadows. Clear things let it through."""

    type: Literal["transparent"]


Background = Annotated[
    EnvironmentBackground | PlainBackground | GradientBackground | TransparentBackground, Field(discriminator="type")
]


class Ground(Settings):
    """A plane that ends at the horizon, where it fades into the background."""

    enabled: bool = True
    height: Length | None = None
    """[m]; without it, that of the level plane among the bodies, or of the lowest point of the action."""
    material: Look = Matte(type="matte", color=srgb("#dcd6cc"))
    """An image on it is as wide as the diagonal of the box of the action, unless it has a `texture_size`, and lies with
    its top to the back."""

    @field_validator("material")
    @classmethod
    def _images_lie_flat(cls, look: Any) -> Any:
        if look.type == "imported" or getattr(look, "projection", None) in {"uv", "sphere"}:
            raise ValueError(
                "images lie flat on the ground, whose materials no file brings: give another type, or projection box"
            )
        return look


class Walls(Settings):
    """How containers are drawn that `materials` names."""

    thickness: PositiveLength | None = None
    """Outwards from the inner surface [m]; without it, a hundredth of the diagonal of the box of the action."""
    overlap: PositiveLength | None = None
    """How far the wall reaches into the water, so that no film of air shows between them [m];
    without it, a quarter of the thickness."""


class Wetness(Settings):
    """What fluid has touched is darker and shines until it is dry."""

    drying_time: PositiveDuration = 10.0
    """In which what is wet dries, once the fluid has gone [s]. In a room it takes many minutes, so that nothing would
    dry within a film; 10 s leave all wet for as long as the fluid splashes, and let it be seen to dry in longer
    shots."""


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
    denoise_quality: Literal["high", "balanced", "fast"] = "high"
    """How well: `balanced` takes half the time and `fast` a sixth, and add some 3 and 10 % to the error of a picture of
    water. Blender before 4.2 knows `high` alone."""
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
    bits. `depth` [m], `normal`; `motion` [px], right and up, only without motion blur: X and Y lead to where it was a
    frame before, Z and W from where it will be a frame later, as Blender has it; `objects` and `materials` as
    Cryptomatte."""
    bounces: Annotated[int, Ge(2), Le(128)] = 24
    """Surfaces that a light path crosses at most, total reflections included. Through water and glass it then goes
    straight on: with few, drops and the edges of panes look like air."""
    caustics: bool = False
    """Light that water and glass focus on what they stand on or hold, from the sun, area lights and softboxes; without
    it, it passes straight through them, dimmed and tinted, as through a window."""
    motion_blur: bool = True
    """Blur what moves while the shutter is open."""
    shutter: Annotated[Dimensionless, Gt(0), Le(2)] = 0.5
    """How long the shutter is open, in frames."""
    device: Literal["auto", "cpu", "gpu"] = "auto"
    """`auto` takes a GPU when there is one, `gpu` refuses to do without."""
    view_transform: Literal["AgX", "Filmic", "Standard"] = "AgX"
    """From light to the colours of the screen."""
    contrast: Literal["low", "medium", "high"] = "high"
    """Of AgX and Filmic."""
    exposure: Annotated[Dimensionless, Ge(-20), Le(20)] = 0.0
    """In stops: each one doubles the brightness."""
    camera: Annotated[Camera, BeforeValidator(camera_is_there)] = Camera()
    set: Set = "none"
    """Surroundings of the action, sized with it: `studio`, a sweep without an edge and soft lamps; `table`, a wood top
    in a room; `tiles`, a tiled floor with walls; `pool`, a tiled basin; `garden`, a terrace in the grass. A set gives
    other defaults for `ground`, `lights` and `background`; what is written there goes above them, key by key."""
    lights: Lights = Lights()
    background: Background = GradientBackground(type="gradient")
    """What the camera sees behind the scene."""
    ground: Ground = Ground()
    water: Annotated[Look, BeforeValidator(_water_unless_told)] = Water()
    """Look of the fluid; `type` may be left out for water."""
    foam: Annotated[FoamLook | Look, Field(discriminator="type"), BeforeValidator(_foam_unless_told)] = FoamLook()
    """Look of foam, spray and bubbles, where the scene has them; `type` may be left out for foam."""
    wetness: Wetness | None = None
    """Bodies, cloth, the ground and containers that `materials` names are wet where fluid has been; none if left out,
    `wetness: {}` for all defaults. Clear things show nothing of it."""
    walls: Walls = Walls()
    materials: dict[Name, Look] = Field(default_factory=dict)
    """Looks of bodies, sheets and containers by name; a container that is not named is not drawn."""

    @model_validator(mode="before")
    @classmethod
    def _open_settings_are_those_of_the_set(cls, data: Any) -> Any:
        return with_set(data)

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

    @field_validator("water", "foam")
    @classmethod
    def _no_image_on_what_flows(cls, look: Any) -> Any:
        if look.type == "imported" or any(images_of(look)):
            raise ValueError("no image lies on what flows: leave it out, and give another type or a color")
        return look

    def looks(self) -> dict[tuple[str, ...], Any]:
        """All looks that are given, by the path of keys within `render:`."""
        found: dict[tuple[str, ...], Any] = {("water",): self.water, ("foam",): self.foam}
        found[("ground", "material")] = self.ground.material
        return found | {("materials", name): look for name, look in self.materials.items()}

    def named_bodies(self) -> tuple[str, ...]:
        """The keys of `materials`: each must be the name of a body, sheet or container of the scene."""
        return tuple(self.materials)

    def assets(self) -> tuple[tuple[Place, str], ...]:
        """Files that the pictures depend on: path of keys within `render:`, and the file as written."""
        return tuple((place, file) for place, file, _ in self.images())

    def images(self) -> Iterator[tuple[Place, str, int | None]]:
        """Likewise, with the number of the image in its file, None where that is the image."""
        panorama = self.lights.environment.file
        if panorama is not None:
            yield ("lights", "environment", "file"), panorama, None
        looks: dict[Place, Any] = {("materials", name): look for name, look in self.materials.items()}
        looks[("ground", "material")] = self.ground.material
        for place, look in looks.items():
            for within, file, index in images_of(look):
                yield (*place, *within), file, index
