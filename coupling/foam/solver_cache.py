"""Where the solver that stays alive is kept: in the user's cache, by OpenFOAM and source."""

from __future__ import annotations

import os
from hashlib import sha256
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from coupling.ports import RunFailed

NAME = "edtPimpleFoam"
WALLS = "libedtWalls.so"  # what both solvers load: a boundary condition, see solver/walls


class NoCache(RunFailed):
    """No folder of the user to keep anything in."""


def cache_folder() -> Path:
    """The user's cache of this program; not made here. Raises ``NoCache`` without a home."""
    base = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not base.is_absolute():  # as the specification asks: ignore any other
        try:
            base = Path.home() / ".cache"
        except RuntimeError as error:
            raise NoCache(
                "XDG_CACHE_HOME: there is no home folder to keep the flow solver in. "
                "Set XDG_CACHE_HOME to a folder of yours, by its whole path."
            ) from error
    return base / "diaphragm-tank"


def sources() -> dict[str, str]:
    """Texts of the solver's source by their paths, as they come with this package."""

    def below(folder: Traversable, prefix: str) -> dict[str, str]:
        found: dict[str, str] = {}
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
            if entry.is_dir():
                found |= below(entry, f"{prefix}{entry.name}/")
            else:
                found[f"{prefix}{entry.name}"] = entry.read_text(encoding="utf-8")
        return found

    return below(files("coupling.foam") / "solver", "")


def _key() -> str:
    text = "\0".join(f"{name}\0{content}" for name, content in sources().items())
    return sha256(text.encode()).hexdigest()[:12]


def solver_path(version: str) -> Path:
    """Where the solver built from these sources against OpenFOAM ``version`` belongs."""
    return cache_folder() / f"{version}-{_key()}" / NAME


def built_solver(version: str) -> Path | None:
    """The solver for OpenFOAM ``version`` where it has been built; the library stands beside it."""
    try:
        path = solver_path(version)
    except NoCache:
        return None
    return path if os.access(path, os.X_OK) else None


def built_for_any() -> bool:
    """Whether the solver has been built for any version of OpenFOAM."""
    try:
        found = cache_folder().glob(f"*-{_key()}/{NAME}")
    except NoCache:
        return False
    return any(os.access(path, os.X_OK) for path in found)
