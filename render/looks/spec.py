"""Typed settings of looks: what water, bodies, sheets, containers, foam and the ground are made of."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from annotated_types import Ge, Gt, Le
from pydantic import Field, field_validator, model_validator
from pydantic_core import core_schema

from common.attributes import UNITS, Number
from common.registry import added
from render.color import Color, srgb
from render.texturing.spec import Fraction, Imported, Rough, Textured
from scene.diagnostics.suggestions import suggestion
from scene.settings import Name, Settings, type_names
from scene.units import Dimensionless, Length, PositiveLength, Unit

SizeOrNone = Annotated[Length, Ge(0)]
RefractiveIndex = Annotated[Dimensionless, Ge(1), Le(4)]


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


class FoamLook(Settings):
    """Foam as it is: what floats is a soft layer on the water, bubbles are air in it, spray is drops. Any other look
    makes balls of all three."""

    type: Literal["foam"] = "foam"
    color: Color = srgb("#f3f7f9")
    """Of the layer and the drops."""
    cover: Annotated[Dimensionless, Gt(0), Le(1000)] = 6.0
    """Area of water that a floating particle hides, over its cross-section: it stands for many smaller ones. Where they
    overlap, they hide less."""
    cell: PositiveLength | None = None
    """Size of the patches into which the layer breaks [m]; without it, four thousandths of the diagonal of the box of
    the action."""


PRINCIPLED_COLORS = ("Base Color", "Specular Tint", "Coat Tint", "Sheen Tint", "Emission Color")
PRINCIPLED_NUMBERS = (
    *("Metallic", "Roughness", "IOR", "Alpha", "Diffuse Roughness"),
    *("Subsurface Weight", "Subsurface Scale", "Subsurface IOR", "Subsurface Anisotropy"),
    *("Specular IOR Level", "Anisotropic", "Anisotropic Rotation", "Transmission Weight"),
    *("Coat Weight", "Coat Roughness", "Coat IOR", "Sheen Weight", "Sheen Roughness"),
    *("Emission Strength", "Thin Film Thickness", "Thin Film IOR"),
)


class VariedLook(Settings):
    """A look whose colour differs from body to body."""

    variation: Fraction = 0.0
    """How much `color` differs between bodies and sheets that have this look, by their names: 0.1 turns its hue by up
    to 9 degrees and makes it up to 10 % darker or brighter."""


class Principled(Settings):
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


class PrincipledLook(Principled, VariedLook):
    """One of them whose colour differs from body to body."""


class Rounded(Settings):
    """A look of bodies that may have edges."""

    rounding: SizeOrNone = 0.0
    """Radius of a body's edges [m], on which light then catches, or as much as its faces have room for; 0 leaves them
    sharp. Edges are where faces meet at more than 35 degrees."""


class Plastic(Rough, Rounded, PrincipledLook):
    """A coloured body under a clear, slightly glossy coat."""

    type: Literal["plastic"]
    color: Color | None = None
    """Without it, the colours that a body's mesh file gives to its vertices, or `#e4572e` where it gives none."""
    roughness: Fraction = 0.3
    """0 is a mirror-smooth surface."""


class Metal(Rough, Rounded, PrincipledLook):
    """Bare metal."""

    type: Literal["metal"]
    color: Color = srgb("#c9ccd1")
    """Colour of the reflection."""
    roughness: Fraction = 0.25
    """0 is a mirror, 0.25 brushed, 0.5 cast."""


class Stone(Rough, Rounded, PrincipledLook):
    """Rough stone with grains and stains."""

    type: Literal["stone"]
    color: Color = srgb("#8d8a84")
    roughness: Fraction = 0.75
    """0 is polished."""
    grain: PositiveLength | None = None
    """Size of the stains [m]; the grains are a tenth of it. Without it, a fifth of the body's diagonal."""


class Matte(Textured, Rounded, VariedLook):
    """Chalk, paper, clay: no gloss at all."""

    type: Literal["matte"]
    color: Color = srgb("#d9d5cc")


class ClothLook(PrincipledLook):
    """Woven cloth: soft, with a sheen at grazing angles, letting some light through."""

    type: Literal["cloth"]
    color: Color = srgb("#b23a48")
    back: Color | None = None
    """Colour of the other side, a sheet's own lower one, in place of `color`."""
    roughness: Fraction = 0.8
    """Of the sheen; 0.3 is satin, 1 felt."""
    sheen: Fraction = 0.3
    """Strength of the sheen."""
    translucency: Fraction = 0.15
    """Share of the light that comes through to the other side."""
    thickness: PositiveLength | None = None
    """Of a sheet as drawn [m]; without it, nine tenths of its `thickness` in the simulation."""
    weave: SizeOrNone | None = None
    """Distance of the threads [m], warp and weft, 0 for none; without it, a 250th of a sheet's diagonal. Sheets alone
    show it; on a mesh that is not flat at rest, threads run as they do where one looks along its shortest side."""
    hem: SizeOrNone | None = None
    """Width of the hem along the rim of a sheet [m], 0 for none; without it, a fiftieth of the diagonal."""


class Glass(Rounded, VariedLook):
    """Clear glass."""

    type: Literal["glass"]
    color: Color = srgb("#fcfefd")
    """Colour of what is seen through one surface."""
    ior: RefractiveIndex = 1.5
    """Index of refraction."""
    roughness: Fraction = 0.0
    """0 is clear, 0.3 frosted."""
    thin: bool = False
    """A shell much thinner than it is drawn, as a window pane, a light bulb or a bubble: what is behind it is seen
    unbent, and its edges do not stand out."""


class Wood(Rough, Rounded, PrincipledLook):
    """Sawn wood, with annual rings and fibres."""

    type: Literal["wood"]
    color: Color = srgb("#cfa878")
    """Of the light wood that grows in spring."""
    roughness: Fraction = 0.5
    """0 is polished, 0.5 sanded, 0.8 rough-sawn."""
    grain: PositiveLength | None = None
    """Width of an annual ring [m]; without it, three hundredths of the body's diagonal."""
    along: Literal["x", "y", "z"] = "x"
    """Axis of the trunk, as the body is placed."""
    varnish: Fraction = 0.0
    """Strength of a clear, glossy coat."""


class Rubber(Rough, Rounded, PrincipledLook):
    """Rubber: a soft gloss, not quite even."""

    type: Literal["rubber"]
    color: Color = srgb("#2b2b2e")
    roughness: Fraction = 0.5
    """0.3 is new and wet, 0.5 a ball, 0.8 a worn tyre."""
    grain: PositiveLength | None = None
    """Size of its unevenness [m]; without it, six thousandths of the body's diagonal."""


class Paper(Rounded, PrincipledLook):
    """Paper or cardboard, letting some light through; of sheets and of bodies."""

    type: Literal["paper"]
    color: Color = srgb("#f1ece0")
    roughness: Fraction = 0.85
    """0.3 is coated, 0.85 uncoated."""
    grain: PositiveLength | None = None
    """Size of the clouds in which its fibres lie [m]; without it, two hundredths of the body's or sheet's diagonal."""
    translucency: Fraction = 0.2
    """Share of the light that comes through to the other side; 0 is cardboard, 0.4 tissue."""
    thickness: PositiveLength | None = None
    """Of a sheet as drawn [m]; without it, nine tenths of its `thickness` in the simulation."""


class Ceramic(Rounded, PrincipledLook):
    """Glazed ceramic, plain or with specks."""

    type: Literal["ceramic"]
    color: Color = srgb("#e8e2d6")
    roughness: Fraction = 0.04
    """Of the glaze; 0 is a mirror, 0.3 a matt glaze."""
    specks: Fraction = 0.0
    """Share of places for a dark speck that have one; 0.4 is stoneware."""
    grain: PositiveLength | None = None
    """Distance of these places [m]; without it, twelve thousandths of the body's diagonal."""


class Lemon(PrincipledLook):
    """The skin of a lemon, or by its colour of an orange or a lime: pits, wax, and light that shines through."""

    type: Literal["lemon"]
    color: Color = srgb("#f6d728")
    roughness: Fraction = 0.4
    grain: PositiveLength | None = None
    """Distance of its pits [m]; without it, 22 thousandths of the body's diagonal."""
    wax: Fraction = 0.3
    """Strength of a glossy film of wax."""
    translucency: Fraction = 0.4
    """Share of the light that wanders about below the skin before it comes out."""


class Planks(Rounded, PrincipledLook):
    """Boards side by side along x, oiled."""

    type: Literal["planks"]
    color: Color = srgb("#a9794c")
    roughness: Fraction = 0.4
    """0 is polished."""
    board: PositiveLength | None = None
    """Width of a board [m]; without it, 0.16 of the body's diagonal, as ground of that of the box of the action."""


class Tiles(Rounded, PrincipledLook):
    """Square tiles with joints."""

    type: Literal["tiles"]
    color: Color = srgb("#e6e8e6")
    joint: Color = srgb("#9aa1a3")
    """Colour of the joints."""
    roughness: Fraction = 0.12
    """Of the tiles: 0 is glazed, 0.8 rough stone."""
    edge: PositiveLength | None = None
    """Of a tile, with its joint [m]; without it, 0.07 of the body's diagonal, as ground of that of the box of the
    action."""
    tone_variation: Fraction = 0.15
    """How much the tiles of one floor or wall differ in brightness."""


class Measured:
    """Annotation of a number that is in the unit of `attribute`, a field before it."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_before_validator_function(self._convert, handler(source))

    @staticmethod
    def _convert(value: Any, info: core_schema.ValidationInfo) -> Any:
        symbol = UNITS.get(info.data.get("attribute", ""))
        return value if symbol is None else Unit(symbol).convert(value)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        return {"type": ["number", "string"]}


class Colormap(Principled):
    """False colours of what the surface of the water says of the fluid; only for `render.water`."""

    type: Literal["colormap"]
    attribute: Number = "speed"
    """One that `surface.attributes` names; `source` is no number, see `palette`."""
    low: Annotated[float, Measured()] = 0.0
    """Value of the first colour; what is lower has it too. As a number in m/s, 1/s, kg/m^3 or s, or as `0.5 m/s`."""
    high: Annotated[float, Measured()]
    """Value of the last colour; what is higher has it too."""
    map: Literal["viridis", "inferno", "coolwarm"] = "viridis"
    """`viridis` and `inferno` grow brighter; `coolwarm` is grey in the middle."""
    roughness: Fraction = 0.4
    """0 is a mirror-smooth surface."""

    @field_validator("attribute", mode="before")
    @classmethod
    def _is_a_number(cls, name: Any) -> Any:
        if name == "source":
            raise ValueError("source is no number: give {type: palette, colors: ...}, with a colour for each source")
        return name

    @model_validator(mode="after")
    def _low_is_lower(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"low = {self.low:g} must be less than high = {self.high:g}: exchange them")
        return self


class Palette(Principled):
    """A colour for each fluid body and emitter, which mix where their fluids do; only for `render.water`, with `source`
    among `surface.attributes`."""

    type: Literal["palette"]
    colors: dict[Name, Color]
    """Of all fluid bodies and emitters, of the start and of events, by their names."""
    roughness: Fraction = 0.2
    """0 is a mirror-smooth surface."""


OF_SHEETS = ("back", "thickness", "weave", "hem")
"""Settings that looks have for sheets alone."""
OF_BODIES = ("rounding",)
"""Likewise, for rigid bodies."""
OWN = (
    *(Water, Plastic, Metal, Stone, Matte, ClothLook, Glass, Wood, Rubber, Paper, Ceramic, Lemon, Planks, Tiles),
    *(Colormap, Palette, Imported),
)
LOOKS = (*OWN, *added("looks", *type_names(*OWN)).values())
"""Those of Tidemill, and what installed packages add."""

if TYPE_CHECKING:
    Look = Any
else:
    Look = Annotated[reduce(or_, LOOKS), Field(discriminator="type")]
