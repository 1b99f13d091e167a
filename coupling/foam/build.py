"""Building the solver that stays alive, and the walls' library, against the OpenFOAM here."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

from coupling.foam.debian_source import fetch, source_package, unpack_headers
from coupling.foam.process import LOG_TAIL, OpenFoam
from coupling.foam.solver_cache import NAME, WALLS, cache_folder, solver_path, sources
from coupling.ports import RunFailed

COMPILE_TIMEOUT = 1800.0  # [s]
# wmake's own flags for linux64Gcc; Debian's libraries have labels of 32 bits and double precision.
# With other sizes the names of functions differ and nothing would link.
_FLAGS = (
    "-std=c++11", "-pthread", "-O2", "-fPIC", "-w", "-DWM_DP", "-DWM_LABEL_SIZE=32",
    "-DNoRepository", "-ftemplate-depth-100",
)  # fmt: skip
_LINK = ("-Xlinker", "--add-needed", "-Xlinker", "--no-as-needed")


class BuildFailed(RunFailed):
    """The solver could not be built; the message has the mend."""


def build_solver(openfoam: OpenFoam, *, say: Callable[[str], None] = lambda _: None) -> Path:
    """Build the solver for ``openfoam`` unless it is there; where it is.

    With an OpenFOAM that has its sources ``wmake`` builds it, with Debian's g++ does, against the
    headers of Debian's source package. Raises ``BuildFailed`` or ``NoHeaders`` with the mend.
    """
    target = solver_path(openfoam.version)
    if os.access(target, os.X_OK):
        return target
    cache_folder().mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=cache_folder()) as folder:
        place = Path(folder)
        for name, text in sources().items():
            path = place / "solver" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        if all((openfoam.project_dir / part).is_dir() for part in ("src", "wmake")):
            built = _by_wmake(place, say)
        elif (openfoam.project_dir / "platforms").is_dir():
            raise BuildFailed(
                f"{openfoam.project_dir}: has no src/ and wmake/ to build against. Install them "
                "(of OpenCFD's packages those with -dev and -source in their names)."
            )
        else:
            built = _by_compiler(place, openfoam, say)
        _check_loads(built, openfoam)
        target.parent.mkdir(exist_ok=True)
        built.with_name(WALLS).replace(target.with_name(WALLS))
        built.replace(target)  # last: where the solver is, the library is
    return target


def _by_wmake(place: Path, say: Callable[[str], None]) -> Path:
    if shutil.which("wmake") is None or "FOAM_SOLVERS" not in os.environ:
        raise BuildFailed("wmake: not on the PATH. Source OpenFOAM's etc/bashrc, then start again.")
    say("compiling with wmake")
    (place / "bin").mkdir()
    into = {name: str(place / "bin") for name in ("FOAM_USER_APPBIN", "FOAM_USER_LIBBIN")}
    _run(["wmake", "libso", str(place / "solver" / "walls")], os.environ | into)
    _run(["wmake", str(place / "solver")], os.environ | into)
    return place / "bin" / NAME


def _by_compiler(place: Path, openfoam: OpenFoam, say: Callable[[str], None]) -> Path:
    if shutil.which("g++") is None:
        raise BuildFailed("g++: not on the PATH. Install it (Debian: apt-get install g++).")
    tarball = fetch(*source_package(openfoam.solver), say)
    say(f"taking headers from {tarball.name}")
    headers = unpack_headers(tarball, place / "headers")
    version = re.sub(r"\D", "", openfoam.version)
    say("compiling, about three quarters of a minute")
    for folder, name, options in (("solver/walls", WALLS, ["-shared"]), ("solver", NAME, [])):
        listed = re.findall(
            r"\w+\.C", (place / folder / "Make" / "files").read_text(encoding="utf-8")
        )
        libraries = re.findall(
            r"-l\w+", (place / folder / "Make" / "options").read_text(encoding="utf-8")
        )
        _run(
            [
                "g++", *_FLAGS, f"-DOPENFOAM={version}", *(f"-I{path}" for path in headers),
                *options, *(str(place / folder / source) for source in listed),
                "-o", str(place / name),
                *_LINK, f"-L{_library_folder(openfoam)}", *libraries, "-lOpenFOAM", "-ldl", "-lm",
            ],
            dict(os.environ),
        )  # fmt: skip
    return place / NAME


def _library_folder(openfoam: OpenFoam) -> Path:
    """Where the libraries are that the stock solver loads."""
    listed = subprocess.run(["ldd", str(openfoam.solver)], capture_output=True, text=True).stdout
    found = re.search(r"libfiniteVolume\S* => (\S+)", listed)
    if found is None:
        raise BuildFailed(
            f"{openfoam.solver}: does not load libfiniteVolume.so. Is it OpenFOAM's own pimpleFoam?"
        )
    return Path(found[1]).resolve().parent


def _run(command: list[str], environment: dict[str, str]) -> None:
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, errors="replace", env=environment, timeout=COMPILE_TIMEOUT,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BuildFailed(f"{command[0]}: {error}.") from error
    if done.returncode != 0:
        errors = [line for line in done.stdout.splitlines() if "error" in line.lower()]
        tail = "\n".join(f"    {line}" for line in (errors or done.stdout.splitlines())[:LOG_TAIL])
        raise BuildFailed(
            f"{command[0]} ended with exit status {done.returncode}. The solver is written for "
            f"OpenFOAM v1912 to v2606 of openfoam.com.\n{tail}"
        )


def _check_loads(program: Path, openfoam: OpenFoam) -> None:
    """Refuse a program that does not even start."""
    done = subprocess.run(
        [str(program), "-help"], capture_output=True, text=True, env=openfoam.environment
    )
    if done.returncode != 0 or "-pipes" not in done.stdout:
        raise BuildFailed(f"{program.name} was built but does not start: {done.stderr.strip()}")
