"""What is fixed in a coupled step, and what its iterations find."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar

from coupling.interface.mapping import StepMap
from coupling.ports import Array, HydrostaticLoad, InterfaceMotion, LiquidInertia

Value = TypeVar("Value")


@dataclass(frozen=True, kw_only=True)
class StepRequest:
    """A step from ``time`` [s] of ``dt`` [s] under ``load``; ``before``: the map as committed."""

    time: float
    dt: float
    load: HydrostaticLoad
    before: Mapping[str, Array]


@dataclass(frozen=True, kw_only=True)
class InterfaceStep:
    """What is fixed while a step iterates on one map.

    ``start`` (p, 3) [m]: the interface at the step's start; ``shift`` (p, 3) [m]: closes the volume
    of the mapped structure where the step is expected to end; ``motion`` of the interface that
    does. ``inertia``: the liquid's, where the scheme takes it in.
    """

    map: StepMap
    start: Array
    shift: Array
    motion: InterfaceMotion
    inertia: LiquidInertia | None

    def to_flow(self, nodes: Array) -> Array:
        """The interface (p, 3) [m] of nodes (n, 3) [m]."""
        return self.map.to_flow(nodes) + self.shift


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The structure's: ``nodes`` (n, 3) [m], and the interface (p, 3) [m], its volume closed.

    ``closure`` (p, 3) [m]: by how much closing it has moved the mapped nodes.
    """

    nodes: Array
    points: Array
    closure: Array


@dataclass(frozen=True, kw_only=True)
class Iterate:
    """An interface x = ``points`` (p, 3) [m] and its ``image`` S(F(x)) (p, 3) [m].

    ``pressure`` F(x) (F,) [Pa].
    """

    points: Array
    pressure: Array
    image: Array

    @property
    def residual(self) -> Array:
        """S(F(x)) - x (p, 3) [m]."""
        return self.image - self.points


def known(value: Value | None) -> Value:
    """The ``value`` of a step that has begun. Raises RuntimeError where it has not."""
    if value is None:
        raise RuntimeError("coupled step: begin_step comes first.")
    return value
