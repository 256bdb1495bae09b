"""Friction and restitution of pairs of bodies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.rigid.body import Body
from sim.rigid.spec import ContactPair


class Surfaces:
    """What surfaces are to one another: geometric means of friction, the greater restitution, and exceptions."""

    def __init__(self, bodies: Sequence[Body], exceptions: Sequence[ContactPair]):
        self._kinetic = np.array([body.kinetic_friction for body in bodies])
        self._static = np.array([body.static_friction for body in bodies])
        self._restitution = np.array([body.restitution for body in bodies])
        self._exceptions: dict[tuple[int, int], ContactPair] = {}
        for exception in exceptions:
            one, other = ([k for k, body in enumerate(bodies) if body.name == name] for name in exception.between)
            for a in one:
                for b in other:
                    self._exceptions[min(a, b), max(a, b)] = exception

    def of(self, pairs: np.ndarray) -> np.ndarray:
        """Friction while sliding and at rest, and restitution of pairs, shape [pairs, 2]; shape [pairs, 3]."""
        a, b = pairs.T
        kinetic = np.sqrt(self._kinetic[a] * self._kinetic[b])
        static = np.sqrt(self._static[a] * self._static[b])
        table = np.column_stack((kinetic, static, np.maximum(self._restitution[a], self._restitution[b])))
        for k, pair in enumerate(map(tuple, pairs) if self._exceptions else ()):
            if pair in self._exceptions:
                given = self._exceptions[pair]
                static = given.friction if given.static_friction is None else given.static_friction
                for column, value in enumerate((given.friction, static, given.restitution)):
                    table[k, column] = table[k, column] if value is None else value
        return table
