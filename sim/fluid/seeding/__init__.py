"""Where particles begin: as many as the volume of a fluid body holds, at rest beside what it touches.

`sim.fluid.model`, `sim.run` and `sim.coupling` import it.
"""
