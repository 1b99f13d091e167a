"""A study or a sweep goes on with its own runs: those of another plan are not replaced."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from coupling.scene.content import content_in, content_of, differences
from coupling.scene.scene import SCENE_FILE, Scene
from coupling.store.folder_lock import FolderError

_MOST_LINES = 10


def check_same_plan(
    folder: Path, planned: Mapping[Path, Scene], runs: Sequence[str], *, force: bool
) -> None:
    """Raise ``FolderError`` where ``folder`` holds a run that ``planned`` replaces or leaves out.

    ``planned``: scenes by their folders within ``folder``; ``runs``: patterns of such folders. A
    plan that only adds runs to those that are there is the same. ``force`` allows any.
    """
    if force:
        return
    found: dict[str, list[Path]] = {}
    for place, scene in planned.items():
        if (folder / place / SCENE_FILE).is_file():
            for line in differences(content_in(folder / place), content_of(scene)):
                found.setdefault(line, []).append(place)
    files = (file for pattern in runs for file in folder.glob(f"{pattern}/{SCENE_FILE}"))
    for place in sorted(file.parent.relative_to(folder) for file in files):
        if place not in planned:
            found[f"{place} was run, and is left out now"] = []
    if found:
        raise FolderError(_refusal(folder, found))


def _refusal(folder: Path, found: Mapping[str, Sequence[Path]]) -> str:
    lines = []
    for line, places in found.items():
        more = f" and {len(places) - 1} more" if len(places) > 1 else ""
        lines.append(f"  {line} ({places[0]}{more})" if places else f"  {line}")
    if len(lines) > _MOST_LINES:
        lines = [*lines[:_MOST_LINES], f"  and {len(lines) - _MOST_LINES} differences more"]
    listed = "\n".join(lines)
    return (
        f"{folder}: holds runs of another plan:\n{listed}\n"
        "Give another folder with -o, the former settings to go on, or --force to replace them."
    )
