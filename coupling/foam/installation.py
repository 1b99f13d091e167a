"""Finding OpenFOAM's programs and seeing, before anything is computed, that they start here."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from functools import lru_cache
from pathlib import Path

from coupling.foam.prefixes import STOCK, OpenFoamMissing, advice
from coupling.foam.process import OpenFoam, clean_environment, takes_path
from coupling.foam.solver_cache import WALLS, built_for_any, built_solver

ALLOW_COMMAND = "EDT_ALLOW_COMMAND"  # set by --allow-command, read here and by worker processes
_DEBIAN_PROJECT = Path("/usr/share/openfoam")
_SPECIAL = "blanks, quotes, colons, semicolons or dollars"
_START_TIMEOUT = 20.0  # [s] for a program to print its help


def find_openfoam(
    command: str = STOCK, *, keep_alive: bool = False, processors: int = 1
) -> OpenFoam:
    """The OpenFOAM whose solver is ``command``, which is started once for its version.

    With ``keep_alive`` the solver that stays alive is taken where it has been built and the
    command is the stock solver, whose equations it has. Raises ``OpenFoamMissing`` with the mend.
    """
    found, project = _located(command)
    version = _version(found, str(project))
    built = built_solver(version)
    alive = built if keep_alive and Path(found).name == STOCK else None
    if processors > 1:
        _check_parallel(alive is not None)
    _check_paths(found, built)
    return OpenFoam(
        solver=Path(found),
        project_dir=project,
        version=version,
        keep_alive=alive,
        walls=None if built is None else built.with_name(WALLS),
        processors=processors,
        mpirun=Path(str(shutil.which("mpirun"))) if processors > 1 else None,
    )


def check_installed(command: str, *, keep_alive: bool, processors: int) -> None:
    """Raise ``OpenFoamMissing`` where what a run needs is not there; no program is started."""
    found, _ = _located(command)
    if not built_for_any():
        raise OpenFoamMissing(
            "openfoam: the walls' library, without which points cannot slide along the diaphragm, "
            "has not been built. Run 'edt build-solver', once, or take model.fluid = 'potential'."
        )
    if processors > 1:
        _check_parallel(keep_alive and Path(found).name == STOCK and built_for_any())


def _located(command: str) -> tuple[str, Path]:
    """Path of the solver and the folder that holds OpenFOAM's ``etc``; nothing is started.

    A scene may come from anybody: any solver but the stock one on the PATH takes the permission
    of the environment variable ALLOW_COMMAND.
    """
    if command != STOCK and not os.environ.get(ALLOW_COMMAND):
        raise OpenFoamMissing(
            f"openfoam.command: must be '{STOCK}', got '{command}'. A scene alone starts no other "
            "program: leave the key out, or give --allow-command where you trust that program."
        )
    found = shutil.which(command)
    if found is None:
        choice = advice() if command == STOCK else ""
        raise OpenFoamMissing(
            f"openfoam.command: no program '{command}' on the PATH. "
            "Install OpenFOAM (Debian: apt-get install openfoam) or source its etc/bashrc. "
            f"{choice}".rstrip()
        )
    project = Path(os.environ.get("WM_PROJECT_DIR") or _DEBIAN_PROJECT)
    if not (project / "etc" / "controlDict").is_file():
        raise OpenFoamMissing(
            f"{found}: no etc/controlDict below {project}. "
            f"Set WM_PROJECT_DIR to OpenFOAM's folder, source its etc/bashrc, or give --openfoam."
        )
    return str(Path(found).absolute()), project


def _check_paths(solver: str, built: Path | None) -> None:
    if not takes_path(solver):
        raise OpenFoamMissing(
            f"openfoam.command: OpenFOAM cannot run from a path with {_SPECIAL}, got {solver}. "
            "Link to it from another folder."
        )
    if built is not None and not takes_path(built):
        raise OpenFoamMissing(
            f"{built.parent}: OpenFOAM cannot run from a path with {_SPECIAL}. Set XDG_CACHE_HOME "
            "to another folder and run 'edt build-solver' again."
        )


def _check_parallel(alive: bool) -> None:
    if not alive:
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


@lru_cache(maxsize=4)
def _version(solver: str, project: str) -> str:
    """What the program itself prints; 'unknown' where it does not say.

    Raises ``OpenFoamMissing`` where it does not start.
    """
    environment = clean_environment() | {"WM_PROJECT_DIR": project}
    try:
        answer = subprocess.run(
            [solver, "-help"], env=environment, stdin=subprocess.DEVNULL, capture_output=True,
            text=True, errors="replace", timeout=_START_TIMEOUT,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise OpenFoamMissing(f"{solver}: cannot be started: {error}. {mend_of('')}") from error
    if answer.returncode != 0:
        output = answer.stdout + answer.stderr
        raise OpenFoamMissing(f"{solver}: does not start: {cause_of(output)} {mend_of(output)}")
    for line in (answer.stdout + answer.stderr).splitlines():
        if "OpenFOAM-" in line:
            return line.split("OpenFOAM-", 1)[1].split()[0].strip(".,()")
        if line.startswith("Using: OpenFOAM"):
            return line.split(" ", 2)[-1].split()[0].strip(".,()")
    return "unknown"


def cause_of(output: str) -> str:
    """The first line of a program's ``output`` that speaks of an error, else the last; a sentence.

    Together with the next line where that says which.
    """
    lines = [line.strip() for line in output.splitlines() if line.strip(" -*|\\/")]
    for line, following in zip(lines, [*lines[1:], ""], strict=False):
        if re.search("error|cannot|could not|unable", line.lower()):
            further = re.search(r":$|^could not", line.lower()) is not None
            return f"{line.removeprefix('--> ')} {following if further else ''}".strip(" .") + "."
    return f"{(lines or ['it says nothing'])[-1].rstrip('.')}."


def mend_of(output: str, openfoam: OpenFoam | None = None) -> str:
    """What to do about a program that said ``output`` and ended.

    ``openfoam`` where its stock solver starts and the one that it would run does not work.
    """
    libraries = os.environ.get("LD_LIBRARY_PATH")
    loader = any(word in output for word in ("shared librar", "symbol", "could not load"))
    if libraries and (loader or not output):
        return (
            f"Take other versions of its libraries out of LD_LIBRARY_PATH (now {libraries}): "
            "unset LD_LIBRARY_PATH, or put OpenFOAM's own folder first."
        )
    if "No space left" in output:
        return "Make room on the disk, or set TMPDIR to a folder that has some."
    if openfoam is None:
        return "Install OpenFOAM anew (Debian: apt-get install --reinstall openfoam)."
    mends = []
    if openfoam.processors > 1:
        mends.append("set openfoam.processors = 1")
    if openfoam.walls is not None:
        mends.append(f"remove {openfoam.walls.parent} and run 'edt build-solver' again")
    return f"{', or '.join(mends) or 'give another openfoam.command'}.".capitalize()
