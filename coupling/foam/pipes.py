"""A solver process that answers requests over pipes, watched while it works."""

from __future__ import annotations

import os
import select
import shutil
import struct
import subprocess
import tempfile
import weakref
from contextlib import suppress
from itertools import chain
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from coupling.foam.process import (
    OpenFoam,
    end_program,
    ended,
    no_answer,
    scratch_folder,
    start_program,
)

ADVANCE, REPEAT, WRITE = 1, 2, 3
_FRAME = struct.Struct("=qqdd")
_GRACE = 5.0  # [s] for a solver to end by itself once there are no more requests


class Frame(NamedTuple):
    """The head of a request or an answer; what the numbers are stands in ``solver/coupler.H``."""

    command: int
    size: int
    first: float
    second: float


class Pipes:
    """``program`` on the case in ``folder``, alive, as ``processes`` processes with two pipes each.

    ``timeout`` [s] is the wall time that its start, and then each answer, may take. Every method
    raises ``OpenFoamFailed`` with the last lines of ``log`` where the program dies or hangs, and
    has then ended it. It ends with this object too.
    """

    def __init__(
        self,
        program: Path,
        folder: Path,
        processes: int,
        *,
        openfoam: OpenFoam,
        log: Path,
        timeout: float,
        moment: str,
    ) -> None:
        self.program, self.log, self.timeout = program, log, timeout
        place = Path(tempfile.mkdtemp(prefix="edt-", dir=scratch_folder()))
        try:
            paths = [
                (place / f"request{rank}", place / f"answer{rank}") for rank in range(processes)
            ]
            for path in chain(*paths):
                os.mkfifo(path)  # named, as mpirun closes all other descriptors
            with log.open("a") as output:
                self._process = start_program(
                    program, folder, "-pipes", str(place), openfoam=openfoam, log=output,
                    moment=moment,
                )  # fmt: skip
            self._ends = [(_opened(request), _opened(answer)) for request, answer in paths]
            self._watch = os.pidfd_open(self._process.pid)
            descriptors = [*chain(*self._ends), self._watch]
            self._finish = weakref.finalize(self, _finish, self._process, descriptors)
            self.exchange([], moment)  # each says that it is ready
        finally:
            shutil.rmtree(place)

    def exchange(
        self, requests: list[tuple[Frame, bytes]], moment: str
    ) -> list[tuple[Frame, bytes]]:
        """Every process' answer to its own request, heads and bodies; without requests, theirs."""
        deadline = monotonic() + self.timeout
        try:
            for (pipe, _), (head, body) in zip(self._ends, requests, strict=False):
                self._send(pipe, _FRAME.pack(*head) + body, deadline, moment)
            return [self._answer(pipe, deadline, moment) for _, pipe in self._ends]
        except BaseException:  # also an interrupt: the answer would come with the next request
            if self._process.poll() is None:
                end_program(self._process)
            self.close()
            raise

    def close(self) -> None:
        """End the process; there is no way back."""
        self._finish()

    def _answer(self, pipe: int, deadline: float, moment: str) -> tuple[Frame, bytes]:
        head = Frame(*_FRAME.unpack(self._receive(pipe, _FRAME.size, deadline, moment)))
        size = 32 * head.size if head.command in (ADVANCE, REPEAT) else 0  # p and U of the cells
        return head, self._receive(pipe, size, deadline, moment)

    def _send(self, pipe: int, data: bytes, deadline: float, moment: str) -> None:
        rest = memoryview(data)
        while rest:
            try:
                rest = rest[os.write(pipe, rest) :]
            except BlockingIOError:
                self._wait(pipe, deadline, moment, write=True)

    def _receive(self, pipe: int, size: int, deadline: float, moment: str) -> bytes:
        data = bytearray(size)
        rest = memoryview(data)
        while rest:
            try:
                rest = rest[os.readv(pipe, [rest]) :]
            except BlockingIOError:
                self._wait(pipe, deadline, moment, write=False)
        return bytes(data)

    def _wait(self, pipe: int, deadline: float, moment: str, *, write: bool) -> None:
        """Return when ``pipe`` is ready; raise where the process has ended or it is too late."""
        left = max(0.0, deadline - monotonic())
        readers, writers = ([], [pipe]) if write else ([pipe], [])
        can_read, can_write, _ = select.select([*readers, self._watch], writers, [], left)
        if pipe in can_read or pipe in can_write:
            return
        if not can_read:
            raise no_answer(self.program, self.log, self.timeout, moment)
        raise ended(self.program, self._process.wait(), self.log, moment)


def _opened(path: Path) -> int:
    """A named pipe, open at both ends, so that nothing waits for the other side."""
    return os.open(path, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)


def _finish(process: subprocess.Popen[bytes], descriptors: list[int]) -> None:
    """End the requests, and the process if it does not end by that."""
    for descriptor in descriptors:
        os.close(descriptor)
    with suppress(subprocess.TimeoutExpired):
        process.wait(_GRACE)
    if process.returncode is None:
        end_program(process)
        process.wait()
