"""What writes ``results.h5`` and ``results.xdmf``: whole at any moment, also after a kill.

Samples gather in memory and are appended to a second copy of the file, which then takes its name
(``AlternatingFile``). So the file with the name is always whole, nothing is written more than
twice, and the copy costs disk space once more while a run goes.
"""

from __future__ import annotations

import shutil
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import h5py
import numpy as np

from coupling.ports import Array, Ints, RunFailed
from coupling.store import results_layout as layout
from coupling.store import xdmf
from coupling.store.alternating import AlternatingFile
from coupling.store.atomic import replacing, write_text
from coupling.store.pace import Pace
from coupling.store.results_head import FILE, read_times
from coupling.store.run_record import Sample

XDMF_FILE = "results.xdmf"

_WRITING_SHARE = 0.05  # of the wall time


class ResultsWriter:
    """Writes ``results.h5`` and ``results.xdmf``; the files are whole whenever they are looked at.

    Writing takes about 5 % of the wall time at most: samples wait in memory until the time since
    the last writing is 20 times its cost, or until ``flush``. The first is written at once.
    """

    def __init__(self, folder: Path | str, sizes: tuple[int, int], *, written: int = 0) -> None:
        self._folder = Path(folder)
        self._results = AlternatingFile(self._folder / FILE)
        self._xdmf = AlternatingFile(self._folder / XDMF_FILE)
        self._sizes = sizes  # numbers of nodes and triangles
        self._written = written  # samples that stand in the file
        # Samples from row ``_first`` on: the last written, which a second copy lacks, and more.
        self._kept: list[Sample] = []
        self._first = written
        self._pace = Pace(_WRITING_SHARE)

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
        writer = cls(folder, (len(reference), len(triangles)))
        writer._folder.mkdir(parents=True, exist_ok=True)
        (writer._folder / XDMF_FILE).unlink(missing_ok=True)  # of an earlier run
        with replacing(writer._folder / FILE) as part, h5py.File(part, "w") as file:
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
        writer = cls(folder, _sizes(Path(folder) / FILE), written=keep)
        # the list of times first: it must never name what results.h5 lacks
        write_text(writer._folder / XDMF_FILE, xdmf.document(FILE, times[:keep], *writer._sizes))
        if keep < len(times) or scene_toml is not None:
            with replacing(writer._folder / FILE) as part:
                shutil.copyfile(writer._folder / FILE, part)
                with h5py.File(part, "r+") as file:
                    layout.truncate(file, keep)
                    if scene_toml is not None:
                        file.attrs["scene"] = scene_toml
        return writer

    @property
    def rows(self) -> int:
        """Number of samples taken."""
        return self._first + len(self._kept)

    def append(self, sample: Sample) -> None:
        """Take one instant; it is in the file after the next ``flush`` at the latest."""
        self._kept.append(sample)
        if self._pace.due:
            self.flush()

    def flush(self) -> None:
        """Write what waits, at the end of the files.

        Raises
        ------
        RunFailed
            The disk is full or cannot be written; the former files stay as they were.
        """
        if self.rows == self._written:
            return
        try:
            with self._pace.timed():
                self._extend_results()
                self._extend_xdmf()
        except RunFailed:
            self._leave_room()
            raise
        rows = self.rows
        del self._kept[: self._written - self._first]
        self._first, self._written = self._written, rows

    def _extend_results(self) -> None:
        # Without a cache of chunks a full disk is an OSError here, not a crash on the way out.
        with self._results.extending() as copy, h5py.File(copy, "r+", rdcc_nbytes=0) as file:
            there = len(file["time"])
            if there < self.rows:  # else an earlier try got so far and no further
                layout.extend(file, there, self._kept[there - self._first :])

    def _extend_xdmf(self) -> None:
        path, times = self._folder / XDMF_FILE, [sample.time for sample in self._kept]
        if path.is_file():
            with self._xdmf.extending() as copy:
                xdmf.extend(copy, FILE, self._first, times, *self._sizes)
        else:
            write_text(path, xdmf.document(FILE, np.array(times), *self._sizes))

    def close(self) -> None:
        """Write what waits; the writer may not be used afterwards."""
        try:
            self.flush()
        finally:
            self._leave_room()

    def _leave_room(self) -> None:
        """Remove the second copies, which the next writing makes anew."""
        self._results.close()
        self._xdmf.close()


def _version() -> str:
    try:
        return version("diaphragm-tank")
    except PackageNotFoundError:  # run from the tree
        return "unknown"


def _sizes(path: Path) -> tuple[int, int]:
    with h5py.File(path, "r") as file:
        return len(file["diaphragm/reference"]), len(file["diaphragm/triangles"])
