"""Finding OpenFOAM's programs, starting them, watching them, and saying why one failed.

Processes are started directly: PyFoam's runners have no time limit, split paths at blanks and keep
five status files a call. PyFoam reads the logs and edits the dictionaries.
"""

from __future__ import annotations

import os
import re
import select
import shutil
import signal
import subprocess
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import IO

from coupling.foam.solver_cache import WALLS, built_solver
from coupling.ports import Cause, RunFailed

STOCK = "pimpleFoam"  # the solver that the one that stays alive stands in for
LOG_TAIL = 15  # lines of a failed program's log that its error quotes
_DEBIAN_PROJECT = Path("/usr/share/openfoam")


class OpenFoamMissing(RunFailed):
    """No OpenFOAM where one is needed."""


class OpenFoamFailed(RunFailed):
    """A program of OpenFOAM died, hung or left no result."""


@dataclass(frozen=True, kw_only=True)
class OpenFoam:
    """What was found: ``solver`` is the program's path, ``project_dir`` holds ``etc``.

    ``keep_alive`` is the solver that stays alive, if it shall be used; ``walls`` the library with
    the walls' pressure, where it has been built. With ``processors`` > 1 the solvers run under
    ``mpirun``.
    """

    solver: Path
    project_dir: Path
    version: str
    keep_alive: Path | None = None
    walls: Path | None = None
    processors: int = 1
    mpirun: Path | None = None

    @property
    def environment(self) -> dict[str, str]:
        """Environment of a solver call: one thread, and the folder with ``etc/controlDict``."""
        found = os.environ | {"WM_PROJECT_DIR": str(self.project_dir), "OMP_NUM_THREADS": "1"}
        if self.walls is not None:
            places = [str(self.walls.parent), *filter(None, [found.get("LD_LIBRARY_PATH")])]
            found["LD_LIBRARY_PATH"] = os.pathsep.join(places)
        return found if self.mpirun is None else found | _open_mpi()

    def command(self, program: Path, case: Path, *arguments: str) -> list[str]:
        """The words that start a solver on ``case``, on all processors."""
        words = [str(program), "-case", str(case), *arguments]
        if self.mpirun is None:
            return words
        return [str(self.mpirun), "-np", str(self.processors), *words, "-parallel"]


def _open_mpi() -> dict[str, str]:
    """What Open MPI needs told; other kinds of MPI do not read it."""
    told = {
        "OMPI_MCA_rmaps_base_oversubscribe": "1",  # more processors than it counts
        "OMPI_MCA_hwloc_base_binding_policy": "none",  # two runs would share a core
        "OMPI_MCA_mpi_yield_when_idle": "1",  # the diaphragm's solver wants one too
    }
    if os.geteuid() == 0:  # in a container
        told |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return told


def find_openfoam(
    command: str = STOCK, *, keep_alive: bool = False, processors: int = 1
) -> OpenFoam:
    """The OpenFOAM whose ``command`` stands on the PATH, or the path of a solver.

    With ``keep_alive`` the solver that stays alive is taken where it has been built and the
    command is the stock solver, whose equations it has. Raises ``OpenFoamMissing`` with the mend.
    That the solver runs is not checked.
    """
    found = shutil.which(command)
    if found is None:
        raise OpenFoamMissing(
            f"openfoam.command: no program '{command}' on the PATH. "
            "Install OpenFOAM (Debian: apt-get install openfoam) or source its etc/bashrc."
        )
    project = Path(os.environ.get("WM_PROJECT_DIR", _DEBIAN_PROJECT))
    if not (project / "etc" / "controlDict").is_file():
        raise OpenFoamMissing(
            f"{found}: no etc/controlDict below {project}. "
            "Set WM_PROJECT_DIR to OpenFOAM's folder, or source its etc/bashrc."
        )
    version = _version(found, str(project))
    built = built_solver(version) if Path(found).name == STOCK else None
    alive = built if keep_alive else None
    return OpenFoam(
        solver=Path(found),
        project_dir=project,
        version=version,
        keep_alive=alive,
        walls=None if built is None else built.with_name(WALLS),
        processors=processors,
        mpirun=_mpirun(alive) if processors > 1 else None,
    )


def _mpirun(alive: Path | None) -> Path:
    if alive is None:
        # CorrectPhi of v1912 holds pcorr in a cell of every processor, and U errs by some 1e-3.
        raise OpenFoamMissing(
            "openfoam.processors: more than 1 takes the solver that stays alive; the stock one is "
            "wrong in a closed domain then. Build it with 'edt build-solver' and keep "
            f"openfoam.keep_alive = true and openfoam.command = '{STOCK}', or set "
            "openfoam.processors = 1."
        )
    for program, package in (("mpirun", "openmpi-bin"), ("decomposePar", "openfoam")):
        if shutil.which(program) is None:
            raise OpenFoamMissing(
                f"openfoam.processors: more than 1 takes '{program}', which is not on the PATH. "
                f"Install it (Debian: apt-get install {package}) or set openfoam.processors = 1."
            )
    return Path(str(shutil.which("mpirun")))


@lru_cache(maxsize=4)
def _version(solver: str, project: str) -> str:
    """What the program itself prints; 'unknown' where it does not say."""
    environment = os.environ | {"WM_PROJECT_DIR": project}
    try:
        answer = subprocess.run(
            [solver, "-help"], env=environment, capture_output=True, text=True, timeout=20
        )
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    for line in (answer.stdout + answer.stderr).splitlines():
        if "OpenFOAM-" in line:
            return line.split("OpenFOAM-", 1)[1].split()[0].strip(".,()")
        if line.startswith("Using: OpenFOAM"):
            return line.split(" ", 2)[-1].split()[0].strip(".,()")
    return "unknown"


# util-linux: the solver dies with us, also when we are killed, and leaves no late files.
_LEASH = ("setpriv", "--pdeathsig", "KILL", "--") if shutil.which("setpriv") else ()


def run_program(
    program: Path, case: Path, *, openfoam: OpenFoam, log: Path, timeout: float, moment: str
) -> None:
    """Run ``program`` on ``case`` to its end, on all processors; its output goes to ``log``.

    ``timeout`` [s] of wall time; ``moment`` says in errors when it was called. Raises
    ``OpenFoamFailed`` with the last lines of the log. Only the process started here is ended,
    with those that it started itself: it leads a group of its own.
    """
    with log.open("w") as output:
        process = start_program(program, case, openfoam=openfoam, log=output, moment=moment)
    with process:
        try:
            _await(process, timeout)
            status = process.wait(0)
        except subprocess.TimeoutExpired:
            end_program(process)
            raise no_answer(program, log, timeout, moment) from None
        except BaseException:
            end_program(process)
            raise
    if status != 0:
        raise ended(program, status, log, moment)


def start_program(
    program: Path, case: Path, *arguments: str, openfoam: OpenFoam, log: IO[str], moment: str
) -> subprocess.Popen[bytes]:
    """Start ``program`` on ``case``, on all processors, as the leader of a group of its own.

    It dies with us. Raises ``OpenFoamFailed`` where it cannot be started.
    """
    if not os.access(program, os.X_OK):
        raise OpenFoamFailed(f"{moment}: {program} cannot be started: not a program.")
    try:
        return subprocess.Popen(
            [*_LEASH, *openfoam.command(program, case, *arguments)],
            cwd=case, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT,
            env=openfoam.environment | {"PWD": str(case)}, process_group=0,
        )  # fmt: skip
    except OSError as error:
        raise OpenFoamFailed(f"{moment}: {program} cannot be started: {error}.") from error


def no_answer(program: Path, log: Path, timeout: float, moment: str) -> OpenFoamFailed:
    """The error of a program that hung and was ended."""
    return OpenFoamFailed(
        f"{moment}: {program.name} gave no answer within {timeout:g} s and was ended. "
        f"Raise openfoam.timeout, or read {log}.\n{log_tail(log)}"
    )


def ended(program: Path, status: int, log: Path, moment: str) -> OpenFoamFailed:
    """The error of a program that ended with ``status`` where it should not have."""
    how, tail = f"exit status {status}" if status >= 0 else f"signal {-status}", log_tail(log)
    diverged, mend = False, f"Read {log}."
    if _signal(status) == signal.SIGFPE or "sigFpe" in tail:
        diverged, mend = True, f"A number overflowed: the flow diverged, see {log}."
    elif _signal(status) == signal.SIGKILL:
        mend = "It was killed, as the system does where memory runs out. Go on with 'edt resume'."
    elif re.search("error while loading shared libraries|symbol lookup error", tail):
        mend = "One of its libraries cannot be loaded. Mend LD_LIBRARY_PATH, then 'edt resume'."
    return OpenFoamFailed(
        f"{moment}: {program.name} ended with {how}. {mend}\n{tail}",
        cause=Cause.FLOW if diverged else None,
    )


def _signal(status: int) -> int:
    """The signal that ended a program of exit ``status``, also one below a shell or mpirun."""
    return -status if status < 0 else max(0, status - 128)


def _await(process: subprocess.Popen[bytes], timeout: float) -> None:
    """Return when ``process`` has ended or after ``timeout`` [s].

    ``Popen.wait`` with a time limit looks only every 50 ms, a third of a coarse step.
    """
    descriptor = os.pidfd_open(process.pid)
    try:
        select.select([descriptor], [], [], timeout)
    finally:
        os.close(descriptor)


def end_program(process: subprocess.Popen[bytes]) -> None:
    """Kill ``process``, not yet waited for, and its group."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def log_tail(log: Path) -> str:
    """The last lines of a log, indented; 'no output' where there is none."""
    try:
        with log.open("rb") as stream:
            stream.seek(max(0, log.stat().st_size - (1 << 16)))
            lines = stream.read().decode(errors="replace").rstrip().splitlines()
    except OSError:
        lines = []
    return "\n".join(f"    {line}" for line in lines[-LOG_TAIL:]) or "    (no output)"
