"""What writes ``results.h5`` and ``results.xdmf``: whole at any moment, also after a kill.

Instants, with all that is over nodes and triangles, and steps, with the rest alone, gather in
memory and are appended to a second copy of the file, which then takes its name
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
from coupling.store.results_head import FILE, read_step_times, read_times
from coupling.store.run_record import Sample, StepSample
from coupling.store.waiting_rows import WaitingRows

XDMF_FILE = "results.xdmf"

_WRITING_SHARE = 0.05  # of the wall time


class ResultsWriter:
    """Writes ``results.h5`` and ``results.xdmf``; the files are whole whenever they are looked at.

    Writing takes about 5 % of the wall time at most: samples wait in memory until the time since
    the last writing is 20 times its cost, or until ``flush``. The first is written at once.
    """

    def __init__(
        self,
        folder: Path | str,
        sizes: tuple[int, int],
        *,
        instants: int = 0,
        steps: int | None = 0,
    ) -> None:
        """Go on after so many ``instants`` and ``steps``; None for a file that keeps no steps."""
        self._folder = Path(folder)
        self._results = AlternatingFile(self._folder / FILE)
        self._xdmf = AlternatingFile(self._folder / XDMF_FILE)
        self._sizes = sizes  # numbers of nodes and triangles
        self._instants = WaitingRows[Sample](instants)
        self._steps = None if steps is None else WaitingRows[StepSample](steps)
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
        cls,
        folder: Path | str,
        *,
        until: float,
        steps_until: float | None = None,
        scene_toml: str | None = None,
    ) -> ResultsWriter:
        """Go on with a folder's results after dropping what is later.

        Results that a version without steps began stay without them.

        Parameters
        ----------
        folder
            The run's folder.
        until, steps_until
            The last instant and the end of the last step to keep [s]; without the second both are
            the same.
        scene_toml
            Stands for the one that is in the file, if given.

        Raises
        ------
        UnreadableFile
            The folder has no readable results.
        """
        times, ends = read_times(folder), read_step_times(folder)
        keep, keep_steps = _until(times, until), 0
        if ends is not None:
            keep_steps = _until(ends, until if steps_until is None else steps_until)
        writer = cls(
            folder, _sizes(Path(folder) / FILE), instants=keep,
            steps=None if ends is None else keep_steps,
        )  # fmt: skip
        # the list of times first: it must never name what results.h5 lacks
        write_text(writer._folder / XDMF_FILE, xdmf.document(FILE, times[:keep], *writer._sizes))
        dropped = keep < len(times) or (ends is not None and keep_steps < len(ends))
        if dropped or scene_toml is not None:
            with replacing(writer._folder / FILE) as part:
                shutil.copyfile(writer._folder / FILE, part)
                with h5py.File(part, "r+") as file:
                    layout.truncate(file, keep, keep_steps)
                    if scene_toml is not None:
                        file.attrs["scene"] = scene_toml
        return writer

    @property
    def rows(self) -> int:
        """Number of instants taken."""
        return len(self._instants)

    def append(self, sample: StepSample) -> None:
        """Take the end of a step; it is in the file after the next ``flush`` at the latest.

        A ``Sample`` is an instant too.
        """
        if self._steps is not None:
            self._steps.kept.append(sample.at_step() if isinstance(sample, Sample) else sample)
        if isinstance(sample, Sample):
            self._instants.kept.append(sample)
        if self._pace.due:
            self.flush()

    def append_instant(self, sample: Sample) -> None:
        """Take what was taken last as a step for an instant as well."""
        self._instants.kept.append(sample)

    def flush(self) -> None:
        """Write what waits, at the end of the files.

        Raises
        ------
        RunFailed
            The disk is full or cannot be written; the former files stay as they were.
        """
        if not (self._instants.wait or (self._steps is not None and self._steps.wait)):
            return
        try:
            with self._pace.timed():
                self._extend_results()
                self._extend_xdmf()
        except RunFailed:
            self._leave_room()
            raise
        self._instants.note_written()
        if self._steps is not None:
            self._steps.note_written()

    def _extend_results(self) -> None:
        # Without a cache of chunks a full disk is an OSError here, not a crash on the way out.
        with self._results.extending() as copy, h5py.File(copy, "r+", rdcc_nbytes=0) as file:
            there = len(file["time"])
            if there < len(self._instants):  # else both copies have all, or an earlier try
                layout.extend(file, there, self._instants.after(there))  # got so far and no further
            if self._steps is not None:
                there = len(file[layout.STEPS]["time"])
                if there < len(self._steps):
                    layout.extend_steps(file, there, self._steps.after(there))

    def _extend_xdmf(self) -> None:
        path, times = self._folder / XDMF_FILE, [sample.time for sample in self._instants.kept]
        if path.is_file():
            if times:  # else both copies have all of them
                with self._xdmf.extending() as copy:
                    xdmf.extend(copy, FILE, self._instants.first, times, *self._sizes)
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


def _until(times: Array, last: float) -> int:
    """How many of ``times`` (T,) [s] are not after the ``last`` [s]."""
    return int(np.searchsorted(times, last + 1e-9 * max(1.0, abs(last)), side="right"))


def _version() -> str:
    try:
        return version("diaphragm-tank")
    except PackageNotFoundError:  # run from the tree
        return "unknown"


def _sizes(path: Path) -> tuple[int, int]:
    with h5py.File(path, "r") as file:
        return len(file["diaphragm/reference"]), len(file["diaphragm/triangles"])
