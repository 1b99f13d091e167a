"""What is seen to before a run, a study or a sweep starts: its scene, its folder, its programs."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene, SceneError, load_scene, tables_of, with_overrides
from coupling.scene.source import scene_file
from coupling.store.folder_lock import FolderError
from coupling.store.run_folder import check_scene_outside, default_folder

Changes = Sequence[str] | Mapping[str, Any]
Progress = Callable[[str, float, float, str], None]
_COUNTS = {1: "one", 2: "two"}


def scene_of(scene: Scene | str | Path, changes: Changes = ()) -> Scene:
    """Return a scene as it is or read from its file, with ``changes``; raises ``SceneError``."""
    if isinstance(scene, Scene):
        return with_overrides(scene, changes) if changes else scene
    return load_scene(scene, changes)


def folder_for(
    scene: Scene | str | Path,
    tables: Collection[Path],
    out: str | Path | None,
    *,
    suffix: str = "",
    written: Collection[str] = (),
) -> Path:
    """Return the folder to write to: ``out``, or ``runs/NAME`` after the scene's file.

    ``tables``: files that the scene names; ``written``: what the folder will hold, if not a run.

    Raises
    ------
    FolderError
        The results would replace the scene's own files, or a scene without a file has no ``out``.
    """
    read = list(tables)
    if not isinstance(scene, Scene):
        read.append(scene_file(Path(scene)))
    if out is not None:
        folder = Path(out)
    elif isinstance(scene, Scene):
        raise FolderError("out: a scene without a file needs it. Give the folder to write to.")
    else:
        folder = default_folder(Path(scene), suffix)
    check_scene_outside(folder, read, written)
    return folder


def files_of(scene: Scene) -> list[Path]:
    """Return the tables that ``scene`` names."""
    return list(tables_of(scene).values())


def check_installed(scene: Scene, models: Iterable[str], *, start: bool = True) -> None:
    """See that what ``models`` need works before anything starts.

    With ``start`` false their programs are only looked for. Raises ``RunFailed`` with the mend.
    """
    for name in models:
        if name in FLUIDS:  # not "auto", which takes one later
            FLUIDS[name].check_installed(scene, start=start)


def chosen_models(models: Sequence[str] | None, *, least: int = 2) -> tuple[str, ...]:
    """Return ``models``, all if None; ``SceneError`` unless ``least`` or more different ones."""
    if models is None:
        return FLUIDS.names
    unknown = [name for name in models if name not in FLUIDS]
    count = _COUNTS[least]
    if unknown or len(set(models)) < max(least, len(models)):
        raise SceneError(
            [
                f"--models: must be {count} or more different ones of {', '.join(FLUIDS)}, "
                f"got '{','.join(models)}'."
            ]
        )
    return tuple(models)
