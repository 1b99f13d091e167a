"""OpenFOAM's headers on a Debian that has its binaries only: out of Debian's own source package.

Found with the machine's own package sources, asked for source packages in a private folder: nothing
of the system is changed and nobody needs to be root. What was fetched once is kept.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tarfile
import tempfile
from collections.abc import Callable
from pathlib import Path, PurePosixPath

from coupling.foam.solver_cache import cache_folder
from coupling.ports import RunFailed

APT = Path("/etc/apt")
FETCH_TIMEOUT = 1800.0  # [s]
_SOLVER = "applications/solvers/incompressible/pimpleFoam"
# Folders of headers that Make/options names: those as wmake's lnInclude makes them, flat, ...
_LIBRARIES = (
    "OpenFOAM",
    "OSspecific/POSIX",
    "finiteVolume",
    "meshTools",
    "sampling",
    "TurbulenceModels/turbulenceModels",
    "TurbulenceModels/incompressible",
    "dynamicMesh",
    "dynamicFvMesh",
)
_TREE = "transportModels"  # ... and one as it stands in the source
# Left alone in spite of our own lists: hooks that tend the system's.
_SETTINGS = """\
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
APT::Sandbox::User "root";
Acquire::Languages "none";
Dir::Etc::sourcelist "{place}/none";
Dir::Etc::sourceparts "{place}/sources";
Dir::State::lists "{place}/lists";
Dir::Cache "{place}/cache";
"""


class NoHeaders(RunFailed):
    """No headers to build against; the message has the mend."""


def source_package(program: Path) -> tuple[str, str]:
    """Name and version of the source package that ``program`` comes from."""
    owner = _asked("dpkg-query", "--search", str(program.resolve())).partition(":")[0]
    answer = _asked(
        "dpkg-query", "--show", "--showformat=${source:Package} ${source:Version}", owner
    )
    name, _, version = answer.partition(" ")
    return name, version


def _asked(*command: str) -> str:
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError) as error:
        reason = getattr(error, "stderr", "") or error
        raise NoHeaders(
            f"{' '.join(command)}: {str(reason).strip()}. Without Debian's packages the solver can "
            "be built with an OpenFOAM that has src/ and wmake/: source its etc/bashrc."
        ) from error


def fetch(name: str, version: str, say: Callable[[str], None]) -> Path:
    """The tarball of source package ``name`` at ``version``, from the cache or from Debian."""
    upstream = version.rpartition("-")[0].partition(":")[2] or version.rpartition("-")[0]
    kept = cache_folder() / "source"
    for tarball in sorted(kept.glob(f"{name}_{upstream}.orig.tar.*")):
        return tarball
    kept.mkdir(parents=True, exist_ok=True)
    say(f"fetching the source package {name} {version}")
    with tempfile.TemporaryDirectory(dir=kept) as folder:
        place = Path(folder)
        for part in ("lists/partial", "cache/archives/partial", "sources", "files"):
            (place / part).mkdir(parents=True)
        (place / "apt.conf").write_text(_SETTINGS.format(place=place), encoding="utf-8")
        _write_sources(place / "sources")
        output = _apt(place, "update")
        output += _apt(place, "--download-only", "source", f"{name}={version}")
        found = sorted((place / "files").glob(f"{name}_{upstream}.orig.tar.*"))
        if not found:
            tail = "\n".join(f"    {line}" for line in output.splitlines()[-12:])
            raise NoHeaders(
                f"apt-get source {name}={version}: nothing came. Is there a network, and has the "
                f"package source in {APT} this version? Or put {name}_{upstream}.orig.tar.bz2 into "
                f"{kept}.\n{tail}"
            )
        return found[0].replace(kept / found[0].name)


def _write_sources(into: Path) -> None:
    """The machine's package sources, turned into ones of source packages."""
    for path in [APT / "sources.list", *sorted((APT / "sources.list.d").glob("*"))]:
        if path.is_file() and path.suffix in (".list", ".sources"):
            text = path.read_text(encoding="utf-8", errors="replace")
            text = re.sub(r"(?m)^deb(-src)?\s", "deb-src ", text)
            text = re.sub(r"(?mi)^Types:.*$", "Types: deb-src", text)
            (into / path.name).write_text(text, encoding="utf-8")


def _apt(place: Path, *arguments: str) -> str:
    """What apt-get says; whether it did its work shows in what it leaves."""
    command = ["apt-get", "-q", "-y", "-c", str(place / "apt.conf"), *arguments]
    try:
        done = subprocess.run(
            command, cwd=place / "files", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, text=True, errors="replace", timeout=FETCH_TIMEOUT,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoHeaders(f"{' '.join(command)}: {error}. It takes Debian's apt-get.") from error
    return done.stdout


def unpack_headers(tarball: Path, into: Path) -> list[Path]:
    """Put the headers, and the templates' bodies, into ``into``; the folders for ``g++ -I``."""
    try:
        with tarfile.open(tarball) as archive:
            for member in archive:
                target = _target(PurePosixPath(*PurePosixPath(member.name).parts[1:]))
                if target is not None and member.isfile():
                    stream = archive.extractfile(member)
                    assert stream is not None
                    (into / target).parent.mkdir(parents=True, exist_ok=True)
                    with (into / target).open("wb") as file:
                        shutil.copyfileobj(stream, file)
    except (OSError, EOFError, tarfile.TarError) as error:
        raise NoHeaders(f"{tarball}: {error}. Remove it, and it is fetched again.") from error
    tree = (_TREE, f"{_TREE}/incompressible/singlePhaseTransportModel")
    return [into / name for name in (*_LIBRARIES, "solver", *tree)]


def _target(path: PurePosixPath) -> str | None:
    """Where a file of the source belongs among the headers, if it does."""
    if path.suffix not in (".H", ".C", ".h", ".hxx", ".txx"):
        return None
    if path.parent == PurePosixPath(_SOLVER):
        return f"solver/{path.name}" if path.suffix == ".H" else None
    for library in _LIBRARIES:
        if path.is_relative_to(f"src/{library}"):
            return f"{library}/{path.name}"
    return str(path.relative_to("src")) if path.is_relative_to(f"src/{_TREE}") else None
