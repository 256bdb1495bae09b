"""The rigid bodies of a scene in MuJoCo: balls, boxes and a plane, placed as ours are.

MuJoCo's contacts are springs with dampers. They are set as stiff as its step allows (a time constant of two steps),
and damped twice as much as is critical: a critically damped contact throws back with exp(-2) = 0.14 of the speed, this
one with less than 0.06, and more damping lets bodies sink in.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

if TYPE_CHECKING:
    from sim.rigid.model import RigidModel

OPTIONS = 'gravity="{gravity}" integrator="implicitfast" cone="elliptic" impratio="10" tolerance="1e-10"'
"""A round cone of friction, ten times as stiff across as along the normal: else bodies at rest creep."""
DAMPING = 2.0


def text(numbers: Any) -> str:
    return " ".join(repr(float(x)) for x in np.atleast_1d(numbers))


def document(bodies: dict[str, Any], part: RigidModel, floor_friction: float, timestep: float) -> str:
    """The scene in MuJoCo's own language; of `part` come masses, places, turns and velocities.

    MuJoCo takes the greater friction of two surfaces, but here always the plane's where there is one.
    """
    lines = []
    for k, body in enumerate(bodies.values()):
        shape = body["shape"]
        if shape["type"] == "plane":
            normal, friction = text(shape["normal"]), text([floor_friction, 0, 0])
            lines.append(f'<geom type="plane" size="0 0 1" zaxis="{normal}" friction="{friction}" priority="1"/>')
            continue
        size = text(np.array(shape["size"]) / 2 if shape["type"] == "box" else shape["radius"])
        geometry = f'type="{shape["type"]}" size="{size}" mass="{text(part.mass[k])}"'
        surface = f'friction="{text([body["friction"], 0, 0])}"'
        at = f'pos="{text(part.position[k])}" quat="{text(part.rotation[k])}"'
        lines.append(f"<body {at}><freejoint/><geom {geometry} {surface}/></body>")
    contact = f'condim="3" solref="{2 * timestep} {DAMPING}" solimp="0.95 0.99 0.001"'
    return (
        f'<mujoco><option timestep="{timestep}" {OPTIONS.format(gravity=text(part.gravity))}/>'
        f"<default><geom {contact}/></default><worldbody>{''.join(lines)}</worldbody></mujoco>"
    )


class MuJoCo:
    """Bodies that are at rest at first; planes have to be the last of `bodies`."""

    def __init__(self, bodies: dict[str, Any], part: RigidModel, floor_friction: float, timestep: float = 1e-3):
        self.model = mujoco.MjModel.from_xml_string(document(bodies, part, floor_friction, timestep))
        self.data = mujoco.MjData(self.model)

    def advance(self, _left: float) -> float:
        """One step; returns how long it is [s]."""
        mujoco.mj_step(self.model, self.data)
        return self.model.opt.timestep

    @property
    def places(self) -> np.ndarray:
        """Of the centres of mass [m]."""
        return self.data.qpos.reshape(-1, 7)[:, :3].copy()

    @property
    def turns(self) -> np.ndarray:
        """Quaternions w, x, y, z."""
        return self.data.qpos.reshape(-1, 7)[:, 3:].copy()

    @property
    def velocities(self) -> np.ndarray:
        return self.data.qvel.reshape(-1, 6)[:, :3].copy()

    @property
    def kinetic_energy(self) -> float:
        mujoco.mj_energyVel(self.model, self.data)
        return float(self.data.energy[1])

    @property
    def overlap(self) -> float:
        """The deepest of the contacts [m]."""
        return max(0.0, -float(self.data.contact.dist.min())) if self.data.ncon else 0.0
