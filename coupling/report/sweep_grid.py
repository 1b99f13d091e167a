"""The rows of a sweep as arrays over its axes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from coupling.fluids import ASSUMED
from coupling.ports import Array

FREQUENCY = "motion.frequency"
_LABELS = {
    FREQUENCY: "frequency (Hz)",
    "motion.amplitude": "amplitude (m)",
    "liquid.fill_fraction": "fill fraction",
    "tank.radius": "radius (m)",
    "diaphragm.thickness": "thickness (m)",
}


def label(key: str) -> str:
    """An axis' name with its unit, where it is a usual one."""
    return _LABELS.get(key, key)


@dataclass(frozen=True, kw_only=True)
class Grid:
    """A sweep's rows by point: arrays of the axes' shape, NaN where nothing is known.

    ``content``: what ``sweep.json`` holds.
    """

    content: Mapping[str, Any]

    @property
    def keys(self) -> list[str]:
        """Dotted keys of the axes."""
        return [axis["key"] for axis in self.content["axes"]]

    @property
    def rows(self) -> Sequence[Mapping[str, Any]]:
        """Rows of the points that are done."""
        rows: Sequence[Mapping[str, Any]] = self.content["rows"]
        return rows

    @property
    def lesser(self) -> list[str]:
        """The models that are held against the reference; hydrostatics first."""
        best = self.content["reference"]
        names = [name for name in self.content["models"] if best is not None and name != best]
        return sorted(names, key=lambda name: name != ASSUMED)

    @property
    def numeric(self) -> bool:
        """Whether every axis is one of numbers."""
        return all(
            isinstance(value, int | float) and not isinstance(value, bool)
            for axis in self.content["axes"]
            for value in axis["values"]
        )

    def axis(self, index: int) -> Array:
        """The values of a numeric axis."""
        return np.asarray(self.content["axes"][index]["values"], dtype=float)

    def logarithmic(self, index: int) -> bool:
        """Whether an axis is spaced geometrically."""
        return bool(self.content["axes"][index]["logarithmic"])

    def coordinates(self, index: int) -> Array:
        """A numeric axis' values at every point, known also where nothing has run."""
        axes = [self.axis(other) for other in range(len(self.keys))]
        return np.meshgrid(*axes, indexing="ij")[index]

    def error(self, model: str, name: str) -> Array:
        """Return the errors ``name`` of ``model`` against the reference, by point.

        NaN where the reference of a point is not that of the sweep.
        """
        best = self.content["reference"]
        return self._filled(
            lambda row: (
                row["models"][model]["error"].get(name) if row["reference"] == best else None
            )
        )

    def wanted(self, model: str, name: str) -> Array:
        """Return a figure of ``model`` that was wanted, by point."""
        return self._filled(lambda row: row["models"][model]["wanted"].get(name))

    def number(self, name: str) -> Array:
        """Return a dimensionless number of the scene, such as ``frequency_ratio``, by point."""
        return self._filled(lambda row: row["numbers"].get(name))

    def failed(self) -> NDArray[np.bool_]:
        """Return at which points a model failed."""
        return np.isfinite(self._filled(lambda row: 1.0 if row["failure"] else None))

    def _filled(self, pick: Callable[[Mapping[str, Any]], float | None]) -> Array:
        places = [
            {_told_apart(value): place for place, value in enumerate(axis["values"])}
            for axis in self.content["axes"]
        ]
        filled = np.full([len(place) for place in places], np.nan)
        for row in self.rows:
            at = tuple(
                place[_told_apart(row["values"][key])]
                for key, place in zip(self.keys, places, strict=True)
            )
            value = pick(row)
            filled[at] = np.nan if value is None else value
        return filled


def _told_apart(value: Any) -> tuple[str, str]:
    """What tells two values of an axis apart, true and 1 among them."""
    return type(value).__name__, str(value)
