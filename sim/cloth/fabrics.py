"""Fabrics by name, with values that were measured.

Wang, O'Brien & Ramamoorthi 2011, "Data-driven elastic models for cloth": samples of ten fabrics, of which one has no
positive definite stiffness while it is not yet stretched, and is left out. Ours are their values without stretch and
without curvature: K11, K12, K22 and K33 per width, K33 by the strain e_uv, which is half of the angle, and the bending
stiffness of strips at 0, 45 and 90 degrees. Warp is their direction v: the stiffer one of the jeans.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

FabricName = Literal[
    "blanket", "cotton_knit", "denim", "jersey", "ponte", "swimwear", "tablecloth", "trousers", "windbreaker"
]


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
