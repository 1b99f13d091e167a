"""Which times of a case stay in its folder: a checkpoint's, and those that a user asked for."""

from __future__ import annotations

from contextlib import suppress

from coupling.foam.case import Case
from coupling.ports import RunFailed


class KeptTimes:
    """The times [s] of ``case`` whose files outlast the next step."""

    def __init__(self, case: Case) -> None:
        self._case = case
        self._kept: set[float] = {0.0}
        self._shown: set[float] = set()  # times whose fields somebody asked for

    def leave(self, time: float) -> None:
        """Remove what nobody needs of ``time`` [s], which the case goes on from."""
        if time not in self._kept | self._shown:
            self._case.remove(time)
        elif time not in self._kept:
            self._case.thin(time)

    def keep(self, time: float) -> None:
        """Keep everything of ``time`` [s]: a checkpoint goes on from there."""
        self._kept.add(time)

    def show(self, time: float) -> None:
        """Write the fields at ``time`` [s] and keep them."""
        self._case.flush(time)
        self._shown.add(time)

    def return_to(self, time: float) -> None:
        """Remove all later than ``time`` [s], from which a checkpoint goes on."""
        self._case.rewind(time)
        self._kept = {*self._case.times, time}

    def close(self, time: float) -> None:
        """Write the fields at ``time`` [s], where the solver still can, and end it."""
        with suppress(RunFailed):  # then the solver has failed, and the run ended by that
            self._case.flush(time)
        self._case.close()
