"""A run at every step: what is not over nodes or triangles, whatever is written out."""

from __future__ import annotations

from dataclasses import dataclass

from coupling.ports import Array, Ints


@dataclass(frozen=True, kw_only=True)
class StepSeries:
    """Signals of a run at the ends of its S - 1 steps and at the start (SI, tank frame).

    ``time`` (S,); ``tank_acceleration``, ``tank_displacement``, ``tank_rotation``, ``tank_rate``,
    ``liquid_cg``, ``force``, ``moment`` (S, 3), in the axes that ``StepSample`` says;
    ``volume``, ``datum_pressure``, ``iterations``, ``residual`` (S,); ``metrics`` by name, (S,)
    each. Units as those of ``Results``.
    """

    time: Array
    tank_acceleration: Array
    tank_displacement: Array
    tank_rotation: Array
    tank_rate: Array
    volume: Array
    datum_pressure: Array
    liquid_cg: Array
    force: Array
    moment: Array
    iterations: Ints
    residual: Array
    metrics: dict[str, Array]
