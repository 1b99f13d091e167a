"""What a solver's own log says of a step, read by PyFoam."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from coupling.foam.pyfoam import FoamLogAnalyzer, RegExpLineAnalyzer

_NUMBER = r"([-+.\deE]+)"
_LINES = {
    "continuity": f".*continuity errors : sum local = {_NUMBER}",
    "pressure": f".*Solving for p, .*Final residual = {_NUMBER}, No Iterations {_NUMBER}",
}


@dataclass(frozen=True, kw_only=True)
class SolverLog:
    """Of the step's last pressure solution: the local ``continuity`` error (a fraction of the
    cells' volumes), the linear solver's ``residual`` and its ``iterations``."""

    continuity: float
    residual: float
    iterations: int


def read_log(log: Path) -> SolverLog | None:
    """The last figures of a solver's output; None where it has none."""
    analyzer = FoamLogAnalyzer()
    for name, line in _LINES.items():
        lines = RegExpLineAnalyzer(name, line, doTimelines=True, doFiles=False, accumulation="last")
        analyzer.addAnalyzer(name, lines)
    with log.open("rb") as stream:
        analyzer.analyze(stream)
    continuity = list(analyzer.getAnalyzer("continuity").getCurrentData().values())
    pressure = list(analyzer.getAnalyzer("pressure").getCurrentData().values())
    if len(continuity) != 1 or len(pressure) != 2:
        return None
    return SolverLog(
        continuity=abs(float(continuity[0])),
        residual=float(pressure[0]),
        iterations=int(pressure[1]),
    )
