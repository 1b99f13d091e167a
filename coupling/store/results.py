"""What a run leaves behind: ``results.h5``, readable at any moment, also after a kill.

Samples gather in memory; the file is copied, the copy extended and given the file's name. So the
file with the name is always whole, and its copy costs disk space once more while it is written.
"""

from __future__ import annotations

import shutil
import time as clock
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

import h5py
import numpy as np

from coupling.ports import Array, Ints
from coupling.store import results_layout as layout
from coupling.store import xdmf
from coupling.store.atomic import H5_ERRORS, UnreadableFile, replacing, write_text
from coupling.store.results_head import FILE, read_times
from coupling.store.run_record import Sample

if TYPE_CHECKING:
    import xarray as xr

XDMF_FILE = "results.xdmf"

_WRITING_SHARE = 20.0  # wall time between two writings, over the cost of one


@dataclass(frozen=True, kw_only=True)
class Results:
    """A run's results as arrays: T instants, n nodes, m triangles (SI, tank frame).

    ``time`` (T,); ``tank_acceleration``, ``tank_displacement``, ``liquid_cg``, ``force``,
    ``moment`` (T, 3); ``reference`` (n, 3), ``triangles`` (m, 3); ``position`` (T, n, 3);
    ``pressure``, ``dynamic_pressure`` (T, n); ``strain``, ``tension`` (T, m);
    ``shell_slip``, ``self_slip`` (T, n); ``volume``, ``datum_pressure``,
    ``iterations``, ``residual`` (T,); ``metrics`` by name, (T,) each, in ``metric_units``.
    """

    model: str
    version: str
    scene_toml: str
    triangles: Ints
    reference: Array
    time: Array
    tank_acceleration: Array
    tank_displacement: Array
    position: Array
    pressure: Array
    dynamic_pressure: Array
    strain: Array
    tension: Array
    shell_slip: Array
    self_slip: Array
    volume: Array
    datum_pressure: Array
    liquid_cg: Array
    force: Array
    moment: Array
    iterations: Ints
    residual: Array
    metrics: dict[str, Array]
    metric_units: dict[str, str]

    @property
    def units(self) -> dict[str, str]:
        """Unit of every array by its name, metrics included; "-" where it has none."""
        fields = dict(layout.FIELDS.values())
        return {"triangles": "-", "reference": "m", **fields, **self.metric_units}

    def to_xarray(self) -> xr.Dataset:
        """Return all arrays as a dataset over time, node, triangle and axis, with their units."""
        from coupling.store.results_dataset import dataset_of

        return dataset_of(self)


def read_results(folder: Path | str) -> Results:
    """Read ``results.h5`` of a run's folder, finished, running or killed.

    Raises
    ------
    UnreadableFile
        There is none, it is cut, or it is not one of ours.
    """
    path = Path(folder) / FILE
    if not path.is_file():
        raise UnreadableFile(f"{path}: no such file. Give the folder that `edt run` wrote to.")
    try:
        with h5py.File(path, "r") as file:
            metrics = file["metrics"]
            return Results(
                model=str(file.attrs["model"]),
                version=str(file.attrs["version"]),
                scene_toml=str(file.attrs["scene"]),
                triangles=file["diaphragm/triangles"][()],
                reference=file["diaphragm/reference"][()],
                metrics={name: metrics[name][()] for name in metrics},
                metric_units={name: str(metrics[name].attrs["unit"]) for name in metrics},
                **{name: file[dataset][()] for dataset, (name, _) in layout.FIELDS.items()},
            )
    except H5_ERRORS as error:
        raise UnreadableFile(
            f"{path}: not a results file ({error}). Run the scene again."
        ) from error


class ResultsWriter:
    """Writes ``results.h5`` and ``results.xdmf``; the files are whole whenever they are looked at.

    Writing takes about 5 % of the wall time at most: samples wait in memory until the time since
    the last writing is 20 times its cost, or until ``flush``. The first is written at once.
    """

    def __init__(self, folder: Path | str, *, written: int = 0) -> None:
        self._folder = Path(folder)
        self._path = self._folder / FILE
        self._waiting: list[Sample] = []
        self._written = written  # samples that stand in the file
        self._last_flush, self._cost = -np.inf, 0.0  # [s]

    @classmethod
    def create(
        cls,
        folder: Path | str,
        *,
        scene_toml: str,
        model: str,
        reference: Array,
        triangles: Ints,
        scene_hash: str = "",
    ) -> ResultsWriter:
        """Begin a folder's results; those of an earlier run are lost.

        Parameters
        ----------
        folder
            The run's folder, made if need be.
        scene_toml, model, scene_hash
            The scene's text, its fluid model and its hash, kept as attributes.
        reference, triangles
            The diaphragm's nodes as moulded (n, 3) [m] and the nodes of each triangle (m, 3).

        Returns
        -------
        ResultsWriter
            A writer without samples.
        """
        writer = cls(folder)
        writer._folder.mkdir(parents=True, exist_ok=True)
        (writer._folder / XDMF_FILE).unlink(missing_ok=True)  # of an earlier run
        with replacing(writer._path) as beside, h5py.File(beside, "w") as file:
            attributes = {
                "version": _version(), "model": model, "scene": scene_toml,
                "scene_hash": scene_hash,
            }  # fmt: skip
            layout.create(file, attributes, reference, triangles)
        return writer

    @classmethod
    def resume(
        cls, folder: Path | str, *, until: float, scene_toml: str | None = None
    ) -> ResultsWriter:
        """Go on with a folder's results after dropping the samples later than ``until`` [s].

        ``scene_toml`` stands for the one that is in the file, if given.

        Raises
        ------
        UnreadableFile
            The folder has no readable results.
        """
        times = read_times(folder)
        keep = int(np.searchsorted(times, until + 1e-9 * max(1.0, abs(until)), side="right"))
        writer = cls(folder, written=keep)
        if keep < len(times) or scene_toml is not None:
            # the list of times first: it must never name what results.h5 lacks
            writer._write_xdmf(times[:keep], *_sizes(writer._path))
            with replacing(writer._path) as beside:
                shutil.copyfile(writer._path, beside)
                with h5py.File(beside, "r+") as file:
                    layout.truncate(file, keep)
                    if scene_toml is not None:
                        file.attrs["scene"] = scene_toml
        return writer

    @property
    def rows(self) -> int:
        """Number of samples taken."""
        return self._written + len(self._waiting)

    def append(self, sample: Sample) -> None:
        """Take one instant; it is in the file after the next ``flush`` at the latest."""
        self._waiting.append(sample)
        if clock.perf_counter() - self._last_flush > _WRITING_SHARE * self._cost:
            self.flush()

    def flush(self) -> None:
        """Write what waits.

        Raises
        ------
        RunFailed
            The disk is full or cannot be written; the former files stay as they were.
        """
        if not self._waiting:
            return
        begin = clock.perf_counter()
        with replacing(self._path) as beside:
            shutil.copyfile(self._path, beside)
            # Without a cache of chunks a full disk is an OSError here, not a crash on the way out.
            with h5py.File(beside, "r+", rdcc_nbytes=0) as file:
                layout.extend(file, self._written, self._waiting)
                times = file["time"][()]
        self._written += len(self._waiting)
        self._waiting.clear()
        self._write_xdmf(times, *_sizes(self._path))
        self._last_flush = clock.perf_counter()
        self._cost = self._last_flush - begin

    def close(self) -> None:
        """Write what waits; the writer may not be used afterwards."""
        self.flush()

    def _write_xdmf(self, times: Array, nodes: int, triangles: int) -> None:
        write_text(self._folder / XDMF_FILE, xdmf.document(FILE, times, nodes, triangles))


def _version() -> str:
    try:
        return version("diaphragm-tank")
    except PackageNotFoundError:  # run from the tree
        return "unknown"


def _sizes(path: Path) -> tuple[int, int]:
    with h5py.File(path, "r") as file:
        return len(file["diaphragm/reference"]), len(file["diaphragm/triangles"])
