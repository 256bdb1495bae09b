"""An acceleration that is the same everywhere."""

from sim.device.arrays import Vec4Array, vec3
from sim.device.compiler import ti
from sim.fluid.forces.force import Force


class Wind(Force):
    def accelerate(self):
        system = self.system
        blow(system.count, vec3(*system.spec.extra["wind"].acceleration), system.particles.acceleration)


@ti.kernel
def blow(count: ti.i32, more: vec3, acceleration: Vec4Array):
    for i in range(count):
        acceleration[i].xyz += more
