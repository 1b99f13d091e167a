"""Folders that runs and studies are written to: chosen and checked before anything starts."""

from __future__ import annotations

import shlex
import shutil
import tempfile
from collections.abc import Collection, Iterable
from pathlib import Path

from coupling.scene.source import SCENE_FILE
from coupling.store.folder_lock import LOCK_FILE, FolderError, check_not_held

# A run's copy of what it computes.
_SCENE_FILES = frozenset(
    {SCENE_FILE, "motion.csv", "thickness.csv", "profile.csv", "force.csv", "mould.csv"}
)
# What a run writes beside it, and a new one replaces.
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
        "compare.json",
        "compare.csv",
        "compare.html",
    }
)
_RUN_MARKERS = frozenset({"log.txt", "auto.json", "results.h5", "summary.json", "checkpoint.h5"})
_CAMPAIGN_MARKERS = frozenset(
    {"study.json", "sweep.json", "design.json", "mechanical_model.json", "discretisation", "points"}
)


LEAST_ROOM = 1_000_000  # bytes: the least that a run and its report take


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
    """See that a new run, or the ``study`` that writes these names, can be written to ``folder``.

    ``folder`` exists. A study or a sweep goes on with a folder that holds nothing else, also where
    a kill left a file half written beside; a run with one that a kill left without a scene.
    ``force`` removes an earlier run's files, or the study's, from the folder, and nothing else.

    Raises
    ------
    FolderError
        The folder holds anything else, or cannot be written.
    """
    try:
        held = _held(folder)
        _check_fits(folder, held, study, force=force)
        with tempfile.TemporaryFile(dir=folder):
            pass
        free = shutil.disk_usage(folder).free
        if free < LEAST_ROOM:
            raise FolderError(
                f"{folder}: its disk has {free / 1e6:.1f} MB left, and no run is smaller than "
                f"{LEAST_ROOM / 1e6:g} MB. Make room, or give another folder with -o."
            )
        if study is None and held & _RUN_MARKERS:
            clear_run(folder)
        elif study is not None and force and held & _CAMPAIGN_MARKERS:
            check_not_held(folder)
            for name in sorted(held & set(study)):
                _remove(folder / name)
    except OSError as error:
        raise FolderError(
            f"{folder}: cannot be written: {error.strerror}. Give another folder with -o."
        ) from error


def _held(folder: Path) -> set[str]:
    """Names in ``folder``, but for those that a kill may leave."""
    names = {path.name for path in folder.iterdir()}
    return {n for n in names if n != LOCK_FILE and not (n[0] == "." and n.endswith(".partial"))}


def _check_fits(
    folder: Path, held: set[str], study: Collection[str] | None, *, force: bool
) -> None:
    """Raise ``FolderError`` where ``held`` keeps a run, or the ``study``, out of ``folder``."""
    begun = held & _RUN_MARKERS
    foreign = {"a study or a sweep": held & _CAMPAIGN_MARKERS - set(study or ())}
    if study is not None:
        foreign["a run"] = begun
        goes_on = held <= set(study)
    else:
        foreign["a scene"] = set() if begun else held & _SCENE_FILES
        without_scene = {"log.txt", "auto.json"} | _SCENE_FILES - {SCENE_FILE}
        goes_on = bool(begun) and held <= without_scene
    for what, names in foreign.items():
        if names and (force or what == "a study or a sweep"):
            raise FolderError(
                f"{folder}: holds {what}, which is not replaced. Give another folder with -o."
            )
    if held and not force and not goes_on:
        raise FolderError(_occupied(folder, held))


def _occupied(folder: Path, held: Collection[str]) -> str:
    if _RUN_MARKERS & set(held) and SCENE_FILE in held:
        what = "holds a run"
        mend = f"Go on with it: edt resume {shlex.quote(str(folder))}; or replace it: --force"
    elif _CAMPAIGN_MARKERS & set(held):
        what, mend = "holds a study or a sweep", "Replace it with --force"
    else:
        what, mend = "is not empty", "Write into it all the same with --force"
    return f"{folder}: {what}. {mend}; or give another folder with -o."


def check_scene_outside(folder: Path, files: Iterable[Path], written: Collection[str] = ()) -> None:
    """Raise ``FolderError`` where a run, or a study that has ``written``, would replace ``files``.

    ``files``: the scene and what it names.
    """
    place, names = folder.resolve(), set(written) or _RUN_FILES | _SCENE_FILES
    for file in map(Path.resolve, files):
        if file.is_relative_to(place) and file.relative_to(place).parts[0] in names:
            raise FolderError(
                f"{folder}: the results would replace {file}, which the scene is read from. "
                "Give another folder with -o."
            )


def clear_run(folder: Path) -> None:
    """Remove what a run has written to ``folder``."""
    for name in (
        *sorted(_SCENE_FILES),
        *sorted(_RUN_FILES),
    ):  # a kill leaves no scene to go on with
        _remove(folder / name)


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def holds_run(folder: Path) -> bool:
    """Whether a run has begun in ``folder``."""
    return folder.is_dir() and not _RUN_MARKERS.isdisjoint(_held(folder))


def check_resumable(folder: Path) -> None:
    """``FolderError`` unless ``folder`` holds a run, which may have been stopped at any moment."""
    _check_exists(folder)
    held = _held(folder)
    if SCENE_FILE not in held or not held & _RUN_MARKERS:
        raise FolderError(
            f"{folder}: no run to go on with. Give the folder of a run, or start one: "
            f"edt run SCENE -o {shlex.quote(str(folder))}."
        )


def check_reportable(folder: Path) -> None:
    """``FolderError`` unless ``folder`` holds the files of a run, a study or a sweep."""
    _check_exists(folder)
    known = ("results.h5", "study.json", "sweep.json", "design.json", "mechanical_model.json")
    if not any((folder / name).is_file() for name in known):
        raise FolderError(
            f"{folder}: nothing to report, none of {', '.join(known)} is there. "
            "Give the folder of a run, a study, a sweep, a design or an identification."
        )


def _check_exists(folder: Path) -> None:
    if not folder.is_dir():
        what = "is not a folder" if folder.exists() else "does not exist"
        raise FolderError(f"{folder}: {what}. Give the folder of a run.")
