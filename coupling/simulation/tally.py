"""What a run counts and says as it goes, and when it has to stop."""

from __future__ import annotations

import logging
from time import perf_counter

import numpy as np

from coupling.metrics.strains import spread
from coupling.ports import Array, DiaphragmState, RunFailed, StepReport
from coupling.scene.scene import Scene
from coupling.simulation.mends import better_scheme, said
from coupling.store.run_record import RunStatistics

ROUNDING = 1e-9  # of a number of steps

_log = logging.getLogger(__name__)


class Tally:
    """Counts the ``statistics`` of a run, and logs a warning where a limit is passed.

    ``thickness`` and ``areas`` (m,) [m, m^2] of the diaphragm's triangles, as moulded.
    """

    def __init__(self, scene: Scene, thickness: Array, areas: Array) -> None:
        self.scene, self.thickness, self.areas = scene, thickness, areas
        self.statistics = RunStatistics()
        self._unconverged_at: float | None = None  # time [s] of the last step that did not converge

    def seconds(self, part: str, since: float) -> None:
        """Add the wall time since ``since`` (a ``perf_counter``) to ``part``."""
        self.statistics.wall_by_part[part] += perf_counter() - since

    def stretched(self, dt: float, state: DiaphragmState) -> None:
        """Count strain, tension and stress at the end of a part of a step, of ``dt`` [s]."""
        strain = float(state.strain.max(initial=0.0))
        statistics = self.statistics
        before, now = np.array(statistics.strain_areas), dt * spread(state.strain, self.areas)
        statistics.strain_areas = (before + now if len(before) else now).tolist()
        statistics.strain_tensile_max = max(statistics.strain_tensile_max, strain)
        statistics.tension_max = max(statistics.tension_max, float(state.tension.max()))
        stress = float((state.tension / self.thickness).max())
        statistics.stress_max = max(statistics.stress_max, stress)

    def solved(self, iterations: int, *, converged: bool) -> None:
        """Count the inner iterations of the solve that a part of a step ends with."""
        statistics = self.statistics
        statistics.cloth_solves += 1
        statistics.cloth_iterations_total += iterations
        statistics.cloth_iterations_max = max(statistics.cloth_iterations_max, iterations)
        statistics.cloth_unconverged += not converged

    def structure(self, time: float, state: DiaphragmState, *, converged: bool, steps: int) -> None:
        """Count a step of the diaphragm that ends at ``time`` [s], of ``steps`` parts.

        ``converged``: whether all its parts were. Raises ``RunFailed`` when too many steps were
        not.
        """
        self.statistics.halved_steps += steps > 1
        if not converged:
            self._unconverged(
                time,
                f"t = {time:.6g} s: the diaphragm's solver left {state.change:.1e} m of motion, "
                f"more than cloth.tolerance = {self.scene.cloth.tolerance:g} allows of what the "
                "step moves, or parts of the sheet in each other.",
                f"Raise cloth.iterations, or halve time.step (it is {self.scene.time.step:g} s).",
            )

    def coupling(self, time: float, report: StepReport, *, volume: float, supplied: float) -> None:
        """A step that ends at ``time`` [s] with ``volume`` [m^3] below the diaphragm.

        ``supplied`` [m^3]: what should be there.

        Raises ``RunFailed`` when too many did not converge.
        """
        statistics, error = self.statistics, report.volume_error
        if error is None:
            error = abs(volume / supplied - 1.0)
        statistics.volume_error_max = max(statistics.volume_error_max, error)
        for sample in report.samples:
            statistics.speed_max = max(statistics.speed_max or 0.0, sample.speed_max)
            statistics.dphi_dt_max = max(statistics.dphi_dt_max or 0.0, sample.dphi_dt_max)
        if report.samples:
            statistics.iterations_total += report.iterations
            statistics.iterations_max = max(statistics.iterations_max, report.iterations)
        if not report.converged:
            self._unconverged(
                time,
                f"t = {time:.6g} s: the coupling left a relative residual of "
                f"{report.residual:.1e} after {report.iterations} iterations in all (tolerance "
                f"{self.scene.coupling.tolerance:g}).",
                said(
                    [
                        *better_scheme(self.scene),
                        f"halve time.step (it is {self.scene.time.step:g} s)",
                        f"raise coupling.max_iterations above {self.scene.coupling.max_iterations}",
                    ]
                ),
            )

    def _unconverged(self, time: float, message: str, mend: str) -> None:
        """Count the step that ends at ``time`` [s], once however much of it did not converge.

        Raises ``RunFailed`` when there are too many, or more than a run of so many steps may have.
        """
        _log.warning(message)
        self.statistics.unconverged_steps += time != self._unconverged_at
        self._unconverged_at = time
        count, settings = self.statistics.unconverged_steps, self.scene.coupling
        if count > settings.max_unconverged:
            raise RunFailed(f"{message} {count} steps did not converge. {mend}")
        steps, share = self.scene.time.steps, settings.max_unconverged_share
        if count > share * steps + ROUNDING:
            raise RunFailed(
                f"{message} {count} of {steps} steps did not converge, and no more than "
                f"{share:g} of them may (coupling.max_unconverged_share). {mend} "
                "Or raise that share."
            )
