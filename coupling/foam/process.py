"""Starting OpenFOAM's programs, watching them, and saying why one failed.

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
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from coupling.ports import Cause, RunFailed

# The working folder. OpenFOAM takes blanks and quotes out of the paths that it is given, and splits
# what it is given where they were: what the folder is really called does not reach it.
_HERE = "/proc/self/cwd"
# A batch system's and a surrounding mpirun's: our processes all run here, and are not its own.
_OF_A_JOB = ("SLURM_", "PBS_", "LSB_", "PE_HOSTFILE", "PMI_", "PMIX_", "PRTE_", "OMPI_", "HYDRA_")
_TRANSPORT = ("OMPI_MCA_btl", "OMPI_MCA_pml", "OMPI_MCA_mtl")  # how messages travel: kept
_OF_THE_USER = ("WM_PROJECT_SITE", "FOAM_CONTROLDICT")  # settings of OpenFOAM beside its own
# What a user's settings would otherwise decide: one file a field, traps for NaN and overflow.
_SETTINGS = {
    "OMP_NUM_THREADS": "1", "FOAM_FILEHANDLER": "uncollated", "FOAM_SIGFPE": "true",
    "FOAM_SETNAN": "false", "HOME": "/nonexistent",
}  # fmt: skip
LOG_TAIL = 15  # lines of a failed program's log that its error quotes


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
        found = clean_environment() | {"WM_PROJECT_DIR": str(self.project_dir)}
        found["TMPDIR"] = str(scratch_folder())
        if self.walls is not None:
            places = [str(self.walls.parent), *filter(None, [found.get("LD_LIBRARY_PATH")])]
            found["LD_LIBRARY_PATH"] = os.pathsep.join(places)
        return found if self.mpirun is None else found | _open_mpi()

    def command(self, program: Path, case: Path, *arguments: str) -> list[str]:
        """The words that start a solver on ``case``, on all processors, from within its folder."""
        words = [str(program), "-case", _HERE, *arguments]
        if self.mpirun is None:
            return words
        place = ["env", f"PWD={_HERE}"]  # mpirun gives its own
        return [str(self.mpirun), "-np", str(self.processors), *place, *words, "-parallel"]


def clean_environment() -> dict[str, str]:
    """Our environment without what would make OpenFOAM another than it is on its own."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if (name.startswith(_TRANSPORT) or not name.startswith(_OF_A_JOB))
        and name not in _OF_THE_USER
    }
    return kept | _SETTINGS


def takes_path(path: Path | str) -> bool:
    """Whether OpenFOAM and the loader of its libraries take ``path`` as it is.

    They split it at colons and semicolons, expand dollars, and stop at blanks and quotes.
    """
    return re.search(r"""[\s"':;$]""", str(path)) is None


def scratch_folder() -> Path:
    """A folder for what lives as long as a process, of a path that OpenFOAM takes.

    Raises ``OpenFoamFailed`` where none can be written.
    """
    tried = []
    with suppress(FileNotFoundError):
        tried.append(tempfile.gettempdir())
    tried += ["/tmp", "/var/tmp", "/dev/shm"]
    for folder in tried:
        if takes_path(folder) and os.access(folder, os.W_OK | os.X_OK):
            return Path(folder)
    raise OpenFoamFailed(
        f"TMPDIR: none of {', '.join(tried)} can be written and has a path that OpenFOAM takes, "
        "without blanks, quotes, colons, semicolons and dollars. Set TMPDIR to such a folder."
    )


def _open_mpi() -> dict[str, str]:
    """Environment that Open MPI needs; other kinds of MPI do not read it."""
    settings = {
        "OMPI_MCA_rmaps_base_oversubscribe": "1",  # more processors than it counts
        "OMPI_MCA_hwloc_base_binding_policy": "none",  # two runs would share a core
        "OMPI_MCA_mpi_yield_when_idle": "1",  # the diaphragm's solver wants one too
    }
    if os.geteuid() == 0:  # in a container
        settings |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return settings


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
            env=openfoam.environment | {"PWD": _HERE}, process_group=0,
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
