"""IISPH by another name."""

from sim.fluid.pressure.iisph import Iisph


class Mine(Iisph):
    pass
