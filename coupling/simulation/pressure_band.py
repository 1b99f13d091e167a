"""p* on the diaphragm in the band up to a few times the frequency of shaking, gathered by step."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.metrics.bernoulli import node_areas
from coupling.metrics.harmonic import BAND, last_whole_periods
from coupling.ports import Array, Ints
from coupling.scene.scene import Scene
from coupling.store.run_record import Sample


class PressureBand:
    """Harmonics 0 to ``BAND`` of p* at the nodes, over the periods that phasors are fitted to.

    Every node's p*, the diaphragm's mean removed, counts with the root of its share of the area
    then, so that squares add up to those of ``dynamic_pressure_rms`` (Parseval). Empty for a motion
    without a frequency, for a run that has no whole period, and for one that was resumed with
    another duration: what its periods held before is not kept step by step.
    """

    def __init__(self, scene: Scene) -> None:
        self.angular = 2.0 * np.pi * (scene.frequency or 0.0)
        self._first = np.inf  # end of the first step [s] that counts
        if scene.frequency is not None:
            ends = scene.time.step * np.arange(scene.time.steps + 1, dtype=np.float64)
            start = scene.motion.ramp / scene.frequency
            chosen, periods = last_whole_periods(ends, scene.frequency, start)
            if periods:
                self._first = ends[chosen][0] - 0.5 * scene.time.step
        self._sums = np.zeros((BAND + 1, 0), dtype=np.complex128)
        self._count, self._hydrostatic = 0, 0.0  # mean squares [Pa^2] of the latter, summed

    def add(self, sample: Sample, triangles: Ints) -> None:
        """Count the end of a step."""
        if sample.time < self._first:
            return
        share = node_areas(sample.position[None], triangles)[0]
        share /= share.sum()
        pressure = sample.dynamic_pressure - share @ sample.dynamic_pressure
        wave = np.exp(-1j * self.angular * sample.time * np.arange(BAND + 1))
        added = wave[:, None] * (np.sqrt(share) * pressure)
        self._sums = self._sums + added if self._sums.size else added
        self._count += 1
        self._hydrostatic += sample.metrics["hydrostatic_pressure_rms"] ** 2

    @property
    def fraction(self) -> float | None:
        """Rms of p* in the band over that of the hydrostatic pressure; None where not known."""
        if self._count == 0 or self._hydrostatic == 0.0:
            return None
        squares = np.sum(np.abs(self._sums / self._count) ** 2, axis=1)
        band = squares[0] + 2.0 * squares[1:].sum()
        return float(np.sqrt(band / (self._hydrostatic / self._count)))

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""
        sums = self._sums
        return {
            "sums": np.stack([sums.real, sums.imag]),
            "counted": np.array([self._count, self._hydrostatic]),
            "first": np.array([self._first]),
        }

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        if float(saved["first"][0]) != self._first:
            self._first = np.inf
            return
        real, imaginary = saved["sums"]
        self._sums = real + 1j * imaginary
        self._count, self._hydrostatic = int(saved["counted"][0]), float(saved["counted"][1])
