"""The step of a diaphragm under a hydrostatic load alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.ports import (
    AnyArray,
    Array,
    HydrostaticLoad,
    IterativeStructure,
    LiquidSample,
    StepReport,
)
from coupling.step.stopwatch import Stopwatch


class DryStep:
    """Steps ``cloth`` under a load that needs no flow; see ``TimeStep``."""

    solver: str | None = None
    halvable = True

    def __init__(self, cloth: IterativeStructure) -> None:
        self.cloth = cloth
        self._watch = Stopwatch("structure")

    def start(self) -> None:
        """Nothing is left to do: the diaphragm has settled."""

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step of ``dt`` [s]; whether the diaphragm converged. Raises ArithmeticError."""
        with self._watch.timed("structure"):
            self.cloth.begin_step(dt, load)
            self.cloth.solve(np.zeros_like(self.cloth.reference), alone=True)
        return self.cloth.converged

    def accept(self) -> None:
        """Commit the last attempt."""
        self.cloth.accept_step()

    def report(self) -> StepReport:
        """One iteration that leaves nothing."""
        return StepReport(iterations=1, residual=0.0, converged=True, samples=())

    def seconds(self) -> dict[str, float]:
        """Wall time since this was last asked, by part."""
        return self._watch.taken()

    def metrics(self, sample: LiquidSample | None) -> dict[str, float]:
        """None: no flow is measured."""
        del sample
        return {}

    def to_nodes(self, values: Array) -> Array:
        """There are no faces whose values could go to the nodes."""
        raise NotImplementedError

    def write_fields(self) -> None:
        """There are none."""

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """Nothing beside the diaphragm."""
        return {}

    def restore(self, saved: Mapping[str, Mapping[str, AnyArray]]) -> None:
        """The reverse of ``save``."""

    def close(self) -> int | None:
        """No solver runs."""
        return None
