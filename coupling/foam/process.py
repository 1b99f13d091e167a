"""Starting OpenFOAM's programs, watching them, and saying why one failed.

Processes are started directly: PyFoam's runners have no time limit, split paths at blanks and keep
five status files a call. PyFoam reads the logs and edits the dictionaries.
"""

from __future__ import annotations

import os
import select
import shutil
import signal
import subprocess
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from coupling.ports import RunFailed

LOG_TAIL = 15  # lines of a failed program's log that its error quotes
_DEBIAN_PROJECT = Path("/usr/share/openfoam")


class OpenFoamMissing(RunFailed):
    """No OpenFOAM where one is needed."""


class OpenFoamFailed(RunFailed):
    """A program of OpenFOAM died, hung or left no result."""


@dataclass(frozen=True, kw_only=True)
class OpenFoam:
    """What was found: ``solver`` is the program's path, ``project_dir`` holds ``etc``."""

    solver: Path
    project_dir: Path
    version: str

    @property
    def environment(self) -> dict[str, str]:
        """Environment of a solver call: one thread, and the folder with ``etc/controlDict``."""
        return os.environ | {"WM_PROJECT_DIR": str(self.project_dir), "OMP_NUM_THREADS": "1"}


def find_openfoam(command: str = "pimpleFoam") -> OpenFoam:
    """The OpenFOAM whose ``command`` stands on the PATH, or the path of a solver.

    Raises ``OpenFoamMissing`` with the mend. That the solver runs is not checked.
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
    return OpenFoam(solver=Path(found), project_dir=project, version=_version(found, str(project)))


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


# Debian's util-linux: the solver dies with us, also when we are killed, and leaves no late files.
_LEASH = ("setpriv", "--pdeathsig", "KILL", "--") if shutil.which("setpriv") else ()


def run_program(
    program: Path, case: Path, *, openfoam: OpenFoam, log: Path, timeout: float, moment: str
) -> None:
    """Run ``program -case case`` to its end; its output goes to ``log``.

    ``timeout`` [s] of wall time; ``moment`` says in errors when it was called. Raises
    ``OpenFoamFailed`` with the last lines of the log. Only the process started here is ended,
    with those that it started itself: it leads a group of its own.
    """
    if not os.access(program, os.X_OK):
        raise OpenFoamFailed(f"{moment}: {program} cannot be started: not a program.")
    try:
        with log.open("w") as output, subprocess.Popen(
            [*_LEASH, str(program), "-case", str(case)],
            cwd=case, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
            env=openfoam.environment | {"PWD": str(case)}, process_group=0,
        ) as process:  # fmt: skip
            try:
                _await(process, timeout)
                status = process.wait(0)
            except subprocess.TimeoutExpired:
                _end(process)
                raise OpenFoamFailed(
                    f"{moment}: {program.name} gave no answer within {timeout:g} s and was ended. "
                    f"Raise openfoam.timeout, or read {log}.\n{log_tail(log)}"
                ) from None
            except BaseException:
                _end(process)
                raise
    except OSError as error:
        raise OpenFoamFailed(f"{moment}: {program} cannot be started: {error}.") from error
    if status != 0:
        cause = f"exit status {status}" if status > 0 else f"signal {-status}"
        raise OpenFoamFailed(
            f"{moment}: {program.name} ended with {cause}. "
            f"Halve time.step, or read {log}.\n{log_tail(log)}"
        )


def _await(process: subprocess.Popen[bytes], timeout: float) -> None:
    """Return when ``process`` has ended or after ``timeout`` [s].

    ``Popen.wait`` with a time limit looks only every 50 ms, a third of a coarse step.
    """
    descriptor = os.pidfd_open(process.pid)
    try:
        select.select([descriptor], [], [], timeout)
    finally:
        os.close(descriptor)


def _end(process: subprocess.Popen[bytes]) -> None:
    """Kill ``process``, not yet waited for, and its group."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def log_tail(log: Path) -> str:
    """The last lines of a log, indented; 'no output' where there is none."""
    try:
        lines = log.read_text(errors="replace").rstrip().splitlines()
    except OSError:
        lines = []
    return "\n".join(f"    {line}" for line in lines[-LOG_TAIL:]) or "    (no output)"
