"""What a folder's results say of themselves, without reading their arrays."""

from __future__ import annotations

from pathlib import Path

import h5py

from coupling.ports import Array
from coupling.store.atomic import H5_ERRORS, UnreadableFile
from coupling.store.results_layout import STEPS

FILE = "results.h5"


def read_times(folder: Path | str) -> Array:
    """The instants (T,) [s] in a folder's results; raises UnreadableFile where there are none."""
    return _read(folder)[0]


def read_step_times(folder: Path | str) -> Array | None:
    """The ends of steps (S,) [s] in a folder's results, the start included.

    None where a version that did not keep them wrote the results. Raises UnreadableFile.
    """
    return _read(folder)[2]


def read_scene_hash(folder: Path | str) -> str:
    """Hash of the scene that a folder's results are of; raises UnreadableFile."""
    return _read(folder)[1]


def _read(folder: Path | str) -> tuple[Array, str, Array | None]:
    path = Path(folder) / FILE
    try:
        with h5py.File(path, "r") as file:
            steps = file[f"{STEPS}/time"][()] if STEPS in file else None
            return file["time"][()], str(file.attrs.get("scene_hash", "")), steps
    except H5_ERRORS as error:
        raise UnreadableFile(
            f"{path}: no readable results ({error}). Run the scene again."
        ) from error
