"""What a run goes on from: its checkpoint, held against the scene and the results beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coupling.ports import AnyArray
from coupling.scene.content import (
    DURATION,
    FREE_KEYS,
    Content,
    content_of,
    differences,
    unpacked_tables,
)
from coupling.scene.scene import Scene
from coupling.store import checkpoint
from coupling.store.folder_lock import FolderError
from coupling.store.results_head import FILE as RESULTS
from coupling.store.results_head import read_scene_hash, read_step_times, read_times
from coupling.store.run_record import is_whole, read_summary

CHECKPOINT = "checkpoint.h5"
_TABLES = "tables"  # part of a checkpoint


@dataclass(frozen=True, kw_only=True)
class SavedRun:
    """A run as its last checkpoint has it, after ``step`` steps.

    ``parts`` and ``statistics`` as they were saved; ``time`` [s]: where it stands; ``last_output``
    [s]: the last instant of the results to keep. ``finished``: the summary of a run that has
    nothing left to compute.
    """

    step: int
    time: float
    last_output: float
    parts: Mapping[str, Mapping[str, AnyArray]]
    statistics: dict[str, Any]
    finished: dict[str, Any] | None


def save_run(
    folder: Path,
    content: Content,
    *,
    step: int,
    rows: int,
    parts: Mapping[str, Mapping[str, AnyArray]],
    statistics: Mapping[str, Any],
) -> None:
    """Write the checkpoint of a run, with a copy of the ``content`` of its scene.

    Raises ``RunFailed`` where it cannot be written; the former one stays.
    """
    attributes = {
        "step": step,
        "rows": rows,
        "statistics": dict(statistics),
        "scene": content.values,
        "scene_hash": content.digest(),
    }
    checkpoint.save_checkpoint(
        folder / CHECKPOINT, {**parts, _TABLES: content.packed_tables()}, attributes
    )


def saved_run(folder: Path, scene: Scene) -> SavedRun | None:
    """The run of ``scene`` in ``folder``; None where it was stopped before its first checkpoint.

    Raises
    ------
    FolderError
        The checkpoint is of another scene, the results are of another run, or they reach beyond
        the scene's duration.
    UnreadableFile
        A file is damaged or of another version.
    """
    if not (folder / CHECKPOINT).is_file():
        _check_nothing_lost(folder)
        return None
    parts, attributes = checkpoint.load_checkpoint(folder / CHECKPOINT)
    former = Content(values=attributes["scene"], tables=unpacked_tables(parts.pop(_TABLES)))
    _check_same_scene(folder, former, content_of(scene))
    step, rows = int(attributes["step"]), int(attributes["rows"])
    times, ends = read_times(folder), read_step_times(folder)
    fewer = len(times) < rows or (ends is not None and len(ends) <= step)
    if read_scene_hash(folder) != attributes["scene_hash"] or fewer:
        raise FolderError(
            f"{folder}: {CHECKPOINT} and {RESULTS} are of different runs. Put those of one run "
            f"there, or run the scene again: edt run {folder / 'scene.toml'} -o ANOTHER."
        )
    computed = max(step * scene.time.step, float(times[-1]))
    if scene.time.steps * scene.time.step < computed * (1.0 - 1e-9):
        raise FolderError(
            f"{folder}: {DURATION}: {scene.time.duration:g} s is less than the {computed:g} s that "
            f"are computed. Give {former.values[DURATION]:g} or more."
        )
    if step % int(former.values["time.output_every"]) and step < scene.time.steps:
        rows -= step * scene.time.step <= times[rows - 1] * (1.0 + 1e-9)  # written as the last
    summary = read_summary(folder)
    return SavedRun(
        step=step,
        time=step * scene.time.step,
        last_output=float(times[rows - 1]),
        parts=parts,
        statistics=attributes["statistics"],
        finished=summary if is_whole(summary, scene.time.steps) else None,
    )


def _check_nothing_lost(folder: Path) -> None:
    """A run without a checkpoint begins again, unless its results hold more than the beginning."""
    if (folder / RESULTS).is_file() and len(times := read_times(folder)) > 1:
        raise FolderError(
            f"{folder}: {CHECKPOINT} is missing, while {RESULTS} reaches {times[-1]:g} s. "
            f"Put it back, or run the scene again: edt run {folder / 'scene.toml'} -o ANOTHER."
        )


def _check_same_scene(folder: Path, former: Content, now: Content) -> None:
    changed = differences(former, now, free=FREE_KEYS | {DURATION})
    if changed:
        listed = "\n".join(f"  {line}" for line in changed)
        file = folder / "scene.toml"
        raise FolderError(
            f"{folder}: the scene is not that of {CHECKPOINT}:\n{listed}\n"
            f"Put the former values back into {file} to go on, or run the changed scene by itself: "
            f"edt run {file} -o ANOTHER. Only a longer {DURATION} and "
            f"{', '.join(sorted(FREE_KEYS))} may change."
        )
