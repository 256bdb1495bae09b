"""Fabrics by name, with values that were measured.

Wang et al. 2011: samples of ten fabrics, of which one has no positive definite stiffness while it is not yet stretched,
and is left out. Ours are their values without stretch and without curvature: K11, K12, K22 and K33 per width, K33 by
the strain e_uv, which is half of the angle, and the bending stiffness of strips at 0, 45 and 90 degrees. Warp is their
direction v: the stiffer one of the jeans.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.cloth.spec import ClothSheet


LARGEST_COUPLING = 0.9
"""nu^2 E_weft / E_warp may not be more: at 1, stretches in both directions would be free."""


@dataclass(frozen=True)
class Fabric:
    """What a fabric resists by: forces per width [N/m], bending moments per width and curvature [N m]."""

    mass_per_area: float
    """[kg/m^2]"""
    warp_stiffness: float
    """Of a strip along the warp that may contract."""
    weft_stiffness: float
    poisson_ratio: float
    """How far the weft contracts over how far the warp is stretched, in a strip along the warp."""
    shear_stiffness: float
    """By the angle between warp and weft."""
    warp_bending: float
    weft_bending: float
    bias_bending: float
    """Of a strip cut at 45 degrees."""


def _measured(mass: float, membrane: tuple[float, float, float, float], bending: tuple[float, float, float]) -> Fabric:
    """membrane: K11, K12, K22 and K33 [N/m]; bending: at 0, 45 and 90 degrees [1e-6 N m]."""
    weft, coupling, warp, shear = membrane
    along, bias, across = (1e-6 * value for value in bending)
    return Fabric(
        mass_per_area=mass,
        warp_stiffness=warp - coupling**2 / weft,
        weft_stiffness=weft - coupling**2 / warp,
        poisson_ratio=coupling / weft,
        shear_stiffness=shear / 2,
        warp_bending=along,
        weft_bending=across,
        bias_bending=bias,
    )


MEASURED: dict[str, Fabric] = {
    "blanket": _measured(0.228, (151.503906, 106.02816, 244.830673, 30.250183), (117.070122, 298.615936, 238.43782)),
    "cotton_knit": _measured(0.276, (42.871021, -0.234556, 65.166023, 83.175644), (46.237591, 83.192772, 80.726685)),
    "denim": _measured(0.324, (205.352005, 10.234077, 1013.88629, 53.387184), (64.196457, 60.943428, 19.824701)),
    "jersey": _measured(0.187, (16.593832, -14.69599, 34.477123, 36.860302), (23.191698, 34.406498, 23.382786)),
    "ponte": _measured(0.284, (31.146198, -12.802702, 44.028667, 31.896357), (36.348366, 45.74408, 20.726685)),
    "swimwear": _measured(0.204, (47.971176, 6.834521, 104.615456, 60.773663), (60.237942, 69.698593, 34.705532)),
    "tablecloth": _measured(0.128, (2002.08618, 0.345588, 2027.48559, 19.189022), (51.713814, 66.360748, 15.221714)),
    "trousers": _measured(0.22, (2016.55456, 9.170511, 2034.97644, 104.759674), (125.409805, 215.412750, 223.861038)),
    "windbreaker": _measured(0.113, (43.067627, 54.373299, 171.424835, 14.3147), (14.293814, 30.011126, 18.363136)),
}
"""Blanket: polyester. Cotton knit: underwear, 95 % cotton, 5 % spandex. Denim: jeans of 11 oz, 99 % cotton, 1 %
spandex. Jersey: a T-shirt, 60 % cotton, 40 % polyester. Ponte: a jacket, 60 % polyester, 40 % rayon. Swimwear: 87 %
nylon, 13 % spandex. Tablecloth: polyester. Trousers: 65 % cotton, 35 % polyester. Windbreaker: a jacket, polyester."""


def resistance(sheet: ClothSheet) -> Fabric:
    """What a sheet resists by: as its fabric says, or the one that it names, or by one stiffness in all directions."""
    given, same = sheet.woven, sheet.stretch_stiffness
    plain = MEASURED.get(given.type or "") or Fabric(
        mass_per_area=sheet.mass_per_area or 0.0,
        warp_stiffness=same,
        weft_stiffness=same,
        poisson_ratio=0.0,
        shear_stiffness=same / 2 if sheet.shear_stiffness is None else sheet.shear_stiffness,
        warp_bending=sheet.bend_stiffness,
        weft_bending=sheet.bend_stiffness,
        bias_bending=sheet.bend_stiffness,
    )
    names = set(vars(plain)) - {"mass_per_area"}
    own = {name: getattr(given, name) for name in names if getattr(given, name) is not None}
    found = replace(plain, **own)
    if {"warp_bending", "weft_bending"} & set(own) and "bias_bending" not in own:
        found = replace(found, bias_bending=(found.warp_bending + found.weft_bending) / 2)
    return found


def refuse_unfit(place: str, sheet: ClothSheet) -> None:
    """Raise ValueError where a sheet can not be a shell; `place`: its name in the settings of cloth."""
    fabric = sheet.resistance
    if sheet.rest_scale == 0:
        raise ValueError(f"{place}.rest_scale = 0 leaves a shell no area: raise it, or use model: springs")
    if fabric.shear_stiffness == 0:
        raise ValueError(f"{place}.shear_stiffness = 0 lets a shell collapse: raise it, or use model: springs")
    most = math.sqrt(LARGEST_COUPLING * fabric.warp_stiffness / fabric.weft_stiffness)
    if not abs(fabric.poisson_ratio) <= most:
        raise ValueError(
            f"{place}.fabric.poisson_ratio = {fabric.poisson_ratio:g} would let the fabric give way by itself: "
            f"give one between -{most:.3g} and {most:.3g}"
        )
    least = (fabric.warp_bending + fabric.weft_bending) / 4
    if not fabric.bias_bending >= least:
        raise ValueError(
            f"{place}.fabric.bias_bending = {fabric.bias_bending:g} is less than warp and weft leave of it: "
            f"give at least {least:g}"
        )
