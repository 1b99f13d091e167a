"""A case solved by one process that lives as long as the run.

The process holds the fields of the committed time and those of the step that is being solved, so
that nothing is read or written between two calls. Frames and pipes: ``solver/coupler.H``.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh
from coupling.foam.case import Case
from coupling.foam.parts import gathered
from coupling.foam.pipes import ADVANCE, REPEAT, WRITE, Frame, Pipes
from coupling.foam.process import OpenFoam, OpenFoamFailed
from coupling.ports import Array, Cause, StepFailed


def case_of(folder: Path, mesh: LiquidMesh, *, openfoam: OpenFoam, timeout: float) -> Case:
    """A case solved as ``openfoam`` says: by a process that stays alive, or by restarts."""
    kind = Case if openfoam.keep_alive is None else AliveCase
    return kind(folder, mesh, openfoam=openfoam, timeout=timeout)


LOG_LIMIT = 50_000_000  # bytes of the solver's log; beyond, it starts again at a checkpoint


class AliveCase(Case):
    """As ``Case``. The process is started when first needed, from the files at the step's start.

    A step that starts where the last one ended commits that one; one that starts where it started
    takes it again. Any other start ends the process and reads the files there anew. A time is
    written to files only by ``flush``.
    """

    solver = "keep-alive"
    uneven_steps = True

    def __init__(
        self, folder: Path, mesh: LiquidMesh, *, openfoam: OpenFoam, timeout: float
    ) -> None:
        super().__init__(folder, mesh, openfoam=openfoam, timeout=timeout)
        self._pipes: Pipes | None = None
        self._began: str | None = None  # names of the times the last step leads from and to
        self._reached: str | None = None
        self._missed = float("nan")

    @property
    def log(self) -> Path:
        """The process' output; that of a later one follows."""
        return self.folder / f"log.{self._program.name}"

    @property
    def _program(self) -> Path:
        assert self.openfoam.keep_alive is not None
        return self.openfoam.keep_alive

    def advance(
        self, start: float, end: float, points: Array, slide: Array | None = None
    ) -> tuple[Array, Array]:
        """As ``Case.advance``; the fields at ``start`` stay with the process."""
        moment, name = f"t = {end:.6g} s", self.time_name(start)
        if self._pipes is None or name not in (self._began, self._reached):
            self._pipes = self._started(start, end, moment)
        command = REPEAT if name == self._began else ADVANCE
        # To the digits of system/step, so that both solvers use the same numbers.
        times = float(f"{start:.12g}"), float(f"{end - start:.12g}")
        slide, requests = self.slide_of(slide), []
        for part in self.parts:
            own = points[part.points]
            body = np.concatenate([own, slide[part.walls]]).tobytes()
            requests.append((Frame(command, len(own), *times), body))
        self._began, self._reached = None, None  # until there is an answer
        answers = self._pipes.exchange(requests, moment)
        self._began, self._reached = name, self.time_name(end)
        self._missed = answers[0][0].second
        fields = [np.frombuffer(body).reshape(4, -1) for _, body in answers]
        pressure = gathered(self.parts, [field[0] for field in fields])
        velocity = gathered(self.parts, [field[1:].reshape(-1, 3) for field in fields])
        if not (np.isfinite(pressure).all() and np.isfinite(velocity).all()):
            raise StepFailed(f"{moment}: the flow diverged, it is not finite.", cause=Cause.FLOW)
        return pressure, velocity

    def _started(self, start: float, end: float, moment: str) -> Pipes:
        """A process that stands at ``start``."""
        self.close()
        if not all((part.folder / self.time_name(start)).is_dir() for part in self.parts):
            raise OpenFoamFailed(
                f"{moment}: the fields at t = {start:.6g} s ended with the process that held them. "
                "Go on from the last checkpoint: edt resume."
            )
        self._write_step(start, end)
        pipes = Pipes(
            self._program, self.folder, len(self.parts), openfoam=self.openfoam, log=self.log,
            timeout=self.timeout, moment=moment,
        )  # fmt: skip
        self._reached = self.time_name(start)
        return pipes

    @property
    def continuity(self) -> float:
        """What the last fluxes miss of the cells' volumes; NaN before the first."""
        return self._missed

    def flush(self, time: float) -> None:
        """Write the fields at ``time`` [s], the last step's end, which commits it."""
        name = self.time_name(time)
        if self._pipes is not None and name == self._reached:
            self._began = None
            request = (Frame(WRITE, 0, time, 0.0), b"")
            self._pipes.exchange([request] * len(self.parts), f"t = {name} s")
            if self.log.stat().st_size > LOG_LIMIT:
                os.truncate(self.log, 0)

    def close(self) -> None:
        """End the process; the next step starts from the files."""
        if self._pipes is not None:
            self._pipes.close()
        self._pipes = self._began = self._reached = None
