"""One time step of diaphragm and liquid together, whatever couples them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from coupling.ports.arrays import AnyArray, Array
from coupling.ports.flow import LiquidSample
from coupling.ports.structure import HydrostaticLoad


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """What the steps took that were accepted since the last report, as one step.

    ``iterations`` of all parts and tries; ``residual``: relative, the largest of the parts;
    ``converged``: whether each part's coupling did; ``samples``: a moving liquid's at the end of
    each part, none of a liquid without a flow. ``volume_error``: relative, the largest of the
    parts, as the flow's mesh has it; None where the diaphragm alone bounds the liquid.
    """

    iterations: int
    residual: float
    converged: bool
    samples: tuple[LiquidSample, ...]
    volume_error: float | None = None

    @property
    def sample(self) -> LiquidSample | None:
        """That of the end, with the work of all parts; None without a flow."""
        if not self.samples:
            return None
        work = sum(sample.pressure_work for sample in self.samples)
        return replace(self.samples[-1], pressure_work=work)


AT_REST = StepReport(iterations=0, residual=0.0, converged=True, samples=())  # before any step


class TimeStep(Protocol):
    """One time step of the diaphragm with its liquid, able to be tried again with a shorter one.

    ``solver``: name of the flow solver, None where none runs; ``halvable``: whether a step can be
    taken in parts.
    """

    solver: str | None

    @property
    def halvable(self) -> bool:
        """Whether a step that does not converge can be taken again as two of half its length."""

    def start(self) -> None:
        """Put the liquid at rest below the settled diaphragm."""

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]; whether it is good enough.

        Raises ArithmeticError or ``StepFailed``; both sides then stand where it began.
        """

    def accept(self) -> None:
        """Commit the last attempt."""

    def report(self) -> StepReport:
        """What was accepted since this was last asked."""

    def seconds(self) -> dict[str, float]:
        """Wall time spent since this was last asked, by part: structure, fluid, mapping."""

    def metrics(self, sample: LiquidSample | None) -> dict[str, float]:
        """Scalars of the committed state for the results; ``sample`` is None before any step."""

    def to_nodes(self, values: Array) -> Array:
        """``values`` (F, k) on a sample's faces, at the diaphragm's nodes (n, k)."""

    def write_fields(self) -> None:
        """Leave the flow's fields as committed in files, where the scene asks for them."""

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """Everything ``restore`` needs, beside the diaphragm, by name of the checkpoint's group."""

    def restore(self, saved: Mapping[str, Mapping[str, AnyArray]]) -> None:
        """The reverse of ``save``, in place of ``start``; the diaphragm has been restored."""

    def close(self) -> int | None:
        """End the flow's solver; bytes of the fields that it leaves, None where it leaves none."""
