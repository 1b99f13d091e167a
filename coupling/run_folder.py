"""Folders that runs and studies are written to: chosen and checked before anything starts."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Collection
from pathlib import Path

from coupling.scene_source import SCENE_FILE

# What a run writes and a new one replaces; the scene and its table are overwritten.
_RUN_FILES = frozenset(
    {
        "results.h5",
        "results.xdmf",
        "summary.json",
        "coupling.csv",
        "checkpoint.h5",
        "report.html",
        "period.mp4",
        "log.txt",
        "foam",
        "auto.json",
        "check",
    }
)
_MARKERS = frozenset({"results.h5", "summary.json", "checkpoint.h5", "study.json", "sweep.json"})


class FolderError(Exception):
    """A folder that cannot be used; the message says why and the mend."""


def default_folder(scene_path: Path, suffix: str = "") -> Path:
    """``runs/<name><suffix>`` below the working directory, named after the scene's folder or file.

    A file of another name than ``scene.toml`` gives its own name, without the extension.
    """
    path = scene_path.resolve()
    inside = path.name == SCENE_FILE
    name = path.parent.name if inside else path.name if path.is_dir() else path.stem
    return Path("runs") / f"{name or 'scene'}{suffix}"


def prepare_folder(
    folder: Path, *, force: bool = False, study: Collection[str] | None = None
) -> None:
    """Create ``folder`` and see that it can be written to.

    ``study`` names what a study or a sweep writes: a folder that holds nothing else is gone on
    with, also where a kill left a file half written beside.
    ``force`` removes an earlier run's or study's files from the folder, and nothing else.
    ``FolderError`` where the folder holds anything else, or cannot be created or written.
    """
    try:
        held = {path.name for path in folder.iterdir()} if folder.is_dir() else set()
        held = {name for name in held if not (name[0] == "." and name.endswith(".partial"))}
        if held and not force and not held <= set(study or ()):
            raise FolderError(_occupied(folder, held))
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
        if force and held & _MARKERS:
            for name in held & _RUN_FILES.union(study or ()):
                _remove(folder / name)
    except OSError as error:
        raise FolderError(
            f"{folder}: cannot be written: {error.strerror}. Give another folder with -o."
        ) from error


def _occupied(folder: Path, held: Collection[str]) -> str:
    if "checkpoint.h5" in held:
        what, mend = "holds a run", f"Go on with it: edt resume {folder}; or replace it: --force"
    elif _MARKERS & set(held):
        what, mend = "holds a run, a study or a sweep", "Replace it with --force"
    else:
        what, mend = "is not empty", "Write into it all the same with --force"
    return f"{folder}: {what}. {mend}; or give another folder with -o."


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()


def check_resumable(folder: Path) -> None:
    """``FolderError`` unless ``folder`` holds a scene and a checkpoint."""
    _check_exists(folder)
    missing = [name for name in (SCENE_FILE, "checkpoint.h5") if not (folder / name).is_file()]
    if missing:
        raise FolderError(
            f"{folder}: no run to go on with, {' and '.join(missing)} missing. "
            "Give the folder of a run that wrote a checkpoint, or start one with edt run."
        )


def check_reportable(folder: Path) -> None:
    """``FolderError`` unless ``folder`` holds the files of a run, a study or a sweep."""
    _check_exists(folder)
    known = ("results.h5", "study.json", "sweep.json")
    if not any((folder / name).is_file() for name in known):
        raise FolderError(
            f"{folder}: nothing to report, none of {', '.join(known)} is there. "
            "Give the folder of a run, a study or a sweep."
        )


def _check_exists(folder: Path) -> None:
    if not folder.is_dir():
        what = "is not a folder" if folder.exists() else "does not exist"
        raise FolderError(f"{folder}: {what}. Give the folder of a run.")
