"""A coupling scheme, and what a scene says of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Protocol

from coupling.ports.arrays import Array


class SchemeSettings(Protocol):
    """What a scene says of its coupling scheme."""

    @property
    def relaxation(self) -> float:
        """The first relaxation of a step, in (0, 1]."""

    @property
    def reuse(self) -> int:
        """Number of former steps whose columns are used."""


class Scheme(Protocol):
    """A coupling scheme finds x with S(F(x)) = x; it knows interface vectors only.

    ``takes_inertia``: whether the structure carries the liquid's inertia in its own step, a Robin
    condition; ``typical_iterations`` of a step in violent sway, for the cost foreseen.
    """

    takes_inertia: ClassVar[bool]
    typical_iterations: ClassVar[float]

    @classmethod
    def of(cls, settings: SchemeSettings) -> Scheme:
        """The scheme with a scene's ``settings``."""

    def begin_step(self) -> None:
        """Forget what holds within one step only."""

    def update(self, x: Array, residual: Array) -> Array:
        """The next x (k,) from x (k,) and the residual S(F(x)) - x (k,)."""

    def accept_step(self, x: Array, residual: Array) -> None:
        """Keep what later steps may reuse; the step ends at x (k,) with this residual (k,)."""

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
