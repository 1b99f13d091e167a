"""The OpenFOAMs installed under the usual prefixes, and taking one of them for this process.

Without a choice a run takes what the PATH and WM_PROJECT_DIR say, as after sourcing an
``etc/bashrc``.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from coupling.ports import RunFailed

STOCK = "pimpleFoam"  # the solver that the one that stays alive stands in for
USUAL = (
    "/usr/lib/openfoam/openfoam*",  # OpenCFD's packages for Debian and Ubuntu
    "/opt/openfoam*",
    "/opt/OpenFOAM/OpenFOAM-v*",
    "/usr/share/openfoam",  # Debian's own package
    "~/OpenFOAM/OpenFOAM-v*",  # compiled by the user
)
_SOURCE_TIMEOUT = 60.0  # [s] for etc/bashrc, which starts some twenty small programs
_OF_THE_SHELL = ("_", "SHLVL", "PWD", "OLDPWD")
_PATHS = ("PATH", "LD_LIBRARY_PATH")


class OpenFoamMissing(RunFailed):
    """No OpenFOAM that works where one is needed."""


@dataclass(frozen=True, kw_only=True)
class Installation:
    """An OpenFOAM of OpenCFD's line: ``prefix`` holds ``etc``, ``version`` is as 1912 or 2312."""

    prefix: Path
    version: str

    def __str__(self) -> str:
        return f"{self.version} in {self.prefix}"


def installations(patterns: Iterable[str] = USUAL) -> list[Installation]:
    """Return what stands under ``patterns``, the oldest version first; no program is started.

    Versions of the OpenFOAM Foundation, which bear one or two digits, are left out.
    """
    found: dict[Path, Installation] = {}
    for pattern in patterns:
        path = Path(pattern).expanduser()
        for prefix in sorted(path.parent.glob(path.name)):
            version = version_of(prefix)
            if (prefix / "etc" / "controlDict").is_file() and re.fullmatch(r"\d{4}", version):
                found.setdefault(prefix.resolve(), Installation(prefix=prefix, version=version))
    return sorted(found.values(), key=lambda one: (one.version, str(one.prefix)))


def version_of(prefix: Path) -> str:
    """Return the version that the files below ``prefix`` state, as 2312; empty without any."""
    for name, pattern in (
        ("META-INFO/api-info", r"(?m)^api=(\w+)"),
        ("etc/bashrc", r"(?m)^\s*(?:export\s+)?WM_PROJECT_VERSION=v?(\w+)"),
    ):
        path = prefix / name
        if path.is_file():
            stated = re.search(pattern, path.read_text(encoding="utf-8", errors="replace"))
            if stated is not None:
                return stated[1]
    return ""


def same_version(one: str, other: str) -> bool:
    """Whether two versions are the same, however written: 1912, v1912."""
    return one.removeprefix("v") == other.removeprefix("v")


def advice(version: str | None = None) -> str:
    """Return how to choose one of those found here, of ``version`` if given; empty without any."""
    fitting = [one for one in installations() if version is None or one.version == version]
    if not fitting:
        return ""
    return f"Give --openfoam PREFIX to take one of those found here: {listed(fitting)}."


def listed(found: Iterable[Installation]) -> str:
    """Return versions and prefixes as text."""
    return ", ".join(map(str, found))


def take(prefix: Path) -> None:
    """Make the OpenFOAM in ``prefix`` that of this process and of all that it starts.

    The environment becomes that after sourcing its ``etc/bashrc``; one whose programs are the
    system's, as Debian's, is only named. Raises ``OpenFoamMissing``.
    """
    prefix = prefix.expanduser().absolute()
    if not (prefix / "etc" / "controlDict").is_file():
        raise OpenFoamMissing(
            f"{prefix}: no OpenFOAM, it has no etc/controlDict. {advice()}".rstrip()
        )
    own = (prefix / "platforms").is_dir()
    chosen = _sourced(prefix) if own else _of_the_system(prefix)
    solver = shutil.which(STOCK, path=chosen.get("PATH"))
    if solver is None or (own and not Path(solver).resolve().is_relative_to(prefix.resolve())):
        raise OpenFoamMissing(
            f"{prefix}: its etc/bashrc puts no {STOCK} of its own on the PATH. Compile it, or give "
            "another prefix."
        )
    for name in set(os.environ) - set(chosen):
        del os.environ[name]
    os.environ.update(chosen)


def _sourced(prefix: Path) -> dict[str, str]:
    """Return the environment after sourcing, in which another OpenFOAM's own folders are gone."""
    script = 'bashrc="$1"; shift; . "$bashrc" > /dev/null 2>&1; exec env -0'
    command = ["bash", "--noprofile", "--norc", "-c", script, "bash", str(prefix / "etc/bashrc")]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=_SOURCE_TIMEOUT,
            check=True,
        )  # fmt: skip
    except (OSError, subprocess.SubprocessError) as error:
        raise OpenFoamMissing(
            f"{prefix}/etc/bashrc: cannot be sourced: {error}. Source it before, and leave "
            "--openfoam out."
        ) from error
    pairs = (line.split("=", 1) for line in os.fsdecode(done.stdout).split("\0") if "=" in line)
    found = {name: value for name, value in pairs if name not in _OF_THE_SHELL}
    kept = {name: os.environ[name] for name in _OF_THE_SHELL if name in os.environ}
    return found | kept | {"WM_PROJECT_DIR": str(prefix)}


def _of_the_system(prefix: Path) -> dict[str, str]:
    """Return the environment without the folders of an OpenFOAM that has been sourced."""
    found, former = dict(os.environ), os.environ.get("WM_PROJECT_DIR")
    if former and Path(former) != prefix:
        for name in _PATHS:
            places = found.get(name, "").split(os.pathsep)
            kept = [place for place in places if not Path(place).is_relative_to(former)]
            found[name] = os.pathsep.join(kept)
    return {name: value for name, value in found.items() if value} | {"WM_PROJECT_DIR": str(prefix)}
