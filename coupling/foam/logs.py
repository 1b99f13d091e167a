"""What a solver's own log says of a step, read by PyFoam."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from PyFoam.LogAnalysis.FoamLogAnalyzer import FoamLogAnalyzer
from PyFoam.LogAnalysis.RegExpLineAnalyzer import RegExpLineAnalyzer

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


def read_log(log: Path, time: float) -> SolverLog | None:
    """The last figures of the step to ``time`` [s]; None where the log has none."""
    analyzer = FoamLogAnalyzer()
    for name, line in _LINES.items():
        analyzer.addAnalyzer(name, RegExpLineAnalyzer(name, line, doFiles=False))
    with log.open("rb") as stream:
        analyzer.analyze(stream)
    continuity = analyzer.getAnalyzer("continuity").getData(time)
    pressure = analyzer.getAnalyzer("pressure").getData(time)
    if not continuity or not pressure:
        return None
    return SolverLog(
        continuity=abs(float(continuity[0])),
        residual=float(pressure[0]),
        iterations=int(pressure[1]),
    )
