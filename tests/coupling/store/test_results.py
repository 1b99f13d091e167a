"""Results: the round trip, readers of others, kills and full disks."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import h5py
import known_run as run
import meshio
import numpy as np
import pytest

from coupling.ports import RunFailed
from coupling.store.results import read_results
from coupling.store.results_layout import FIELDS, STEP_FIELDS, STEPS, is_field
from coupling.store.results_writer import ResultsWriter

REFERENCE, TRIANGLES = run.disc()


def writer(folder: Path) -> ResultsWriter:
    return ResultsWriter.create(
        folder, scene_toml="x = 1\n", model="openfoam", reference=REFERENCE, triangles=TRIANGLES
    )


def test_everything_written_is_read_back_bit_for_bit(tmp_path: Path) -> None:
    out = writer(tmp_path)
    samples = [run.sample(0.1 * k, REFERENCE, TRIANGLES) for k in range(7)]
    for item in samples:
        out.append(item)
    out.close()
    results = read_results(tmp_path)
    assert (results.model, results.scene_toml) == ("openfoam", "x = 1\n")
    assert np.array_equal(results.triangles, TRIANGLES)
    assert np.array_equal(results.reference, REFERENCE)
    for name, _ in FIELDS.values():
        expected = np.stack([np.asarray(getattr(item, name)) for item in samples])
        assert np.array_equal(getattr(results, name), expected), name
        if not is_field(name):
            assert np.array_equal(getattr(results.steps, name), expected), name
    assert np.array_equal(results.metrics["speed_max"], np.full(7, 0.8))
    assert results.metric_units["speed_max"] == "m/s"


def test_every_dataset_has_a_unit(tmp_path: Path) -> None:
    run.write_run(tmp_path, periods=0.5)
    without: list[str] = []

    def visit(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and "unit" not in item.attrs:
            without.append(name)

    with h5py.File(tmp_path / "results.h5") as file:
        file.visititems(visit)
        assert {"schema", "version", "model", "scene"} <= set(file.attrs)
    assert without == []


def check_xdmf(folder: Path) -> int:
    """Read every instant that ``results.xdmf`` names; how many there are."""
    results = read_results(folder)
    with meshio.xdmf.TimeSeriesReader(folder / "results.xdmf") as reader:
        points, cells = reader.read_points_cells()
        assert np.array_equal(points, results.position[0])
        assert np.array_equal(cells[0].data, results.triangles)
        for row in range(reader.num_steps):
            instant, point_data, cell_data = reader.read_data(row)
            assert instant == results.time[row]
            assert np.array_equal(point_data["position"], results.position[row])
            assert np.array_equal(point_data["pressure"], results.pressure[row])
            assert np.array_equal(point_data["dynamic_pressure"], results.dynamic_pressure[row])
            assert np.array_equal(cell_data["strain"][0], results.strain[row])
        return int(reader.num_steps)


def test_meshio_reads_every_instant(tmp_path: Path) -> None:
    run.write_run(tmp_path, periods=1.0)
    assert check_xdmf(tmp_path) == len(read_results(tmp_path).time)


def test_a_run_without_any_instant_can_be_read(tmp_path: Path) -> None:
    writer(tmp_path).close()
    results = read_results(tmp_path)
    assert results.time.shape == (0,)
    assert results.position.shape == (0, len(REFERENCE), 3)


def test_resume_drops_what_is_later_and_ends_like_an_unbroken_run(tmp_path: Path) -> None:
    times = [0.1 * k for k in range(10)]
    whole = writer(tmp_path / "whole")
    broken = writer(tmp_path / "broken")
    for instant in times:
        whole.append(run.sample(instant, REFERENCE, TRIANGLES))
    for instant in times[:8]:
        broken.append(run.sample(instant, REFERENCE, TRIANGLES))
    whole.close()
    broken.close()
    again = ResultsWriter.resume(tmp_path / "broken", until=times[4])
    assert len(read_results(tmp_path / "broken").time) == 5
    assert check_xdmf(tmp_path / "broken") == 5
    for instant in times[5:]:
        again.append(run.sample(instant, REFERENCE, TRIANGLES))
    again.close()
    one, other = read_results(tmp_path / "whole"), read_results(tmp_path / "broken")
    for name, _ in FIELDS.values():
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert check_xdmf(tmp_path / "broken") == len(times)


def test_steps_stand_beside_the_instants_however_they_are_flushed(tmp_path: Path) -> None:
    """Of both copies of the file each lacks now instants, now steps, now nothing."""
    out = writer(tmp_path)
    samples = [run.sample(0.1 * k, REFERENCE, TRIANGLES) for k in range(40)]
    instants = {0, 3, 4, 11, 12, 13, 30}
    for k, item in enumerate(samples):
        out.append(item if k in instants else item.at_step())
        if k % 2 or 10 < k < 20:
            out.flush()
        if k == 17:
            out._leave_room()  # as after an error
    out.close()
    results = read_results(tmp_path)
    assert np.array_equal(results.time, [samples[k].time for k in sorted(instants)])
    assert out.rows == len(instants)
    for name, _ in STEP_FIELDS.values():
        expected = np.stack([np.asarray(getattr(item, name)) for item in samples])
        assert np.array_equal(getattr(results.steps, name), expected), name
    rms = [item.metrics["hydrostatic_pressure_rms"] for item in samples]
    assert np.array_equal(results.steps.metrics["hydrostatic_pressure_rms"], rms)
    assert check_xdmf(tmp_path) == len(instants)


def test_resume_drops_steps_and_instants_each_after_its_own_end(tmp_path: Path) -> None:
    out = writer(tmp_path)
    for k in range(10):
        item = run.sample(0.1 * k, REFERENCE, TRIANGLES)
        out.append(item.at_step() if k % 4 else item)
    out.close()
    again = ResultsWriter.resume(tmp_path, until=0.4, steps_until=0.6)
    kept = read_results(tmp_path)
    assert (len(kept.time), len(kept.steps.time)) == (2, 7)
    assert len(kept.steps.metrics["speed_max"]) == 7
    for k in range(7, 10):
        item = run.sample(0.1 * k, REFERENCE, TRIANGLES)
        again.append(item.at_step() if k % 4 else item)
    again.close()
    whole = read_results(tmp_path)
    assert np.array_equal(whole.steps.time, 0.1 * np.arange(10))
    assert np.array_equal(whole.time, 0.1 * np.array([0, 4, 8]))


def test_results_of_a_version_without_steps_are_read_and_gone_on_with(tmp_path: Path) -> None:
    run.write_run(tmp_path, periods=0.5)
    with h5py.File(tmp_path / "results.h5", "r+") as file:
        del file[STEPS]
    older = read_results(tmp_path)
    assert older.every_step is None
    assert np.array_equal(older.steps.time, older.time)
    assert np.array_equal(older.steps.force, older.force)
    assert older.steps.metrics is older.metrics
    again = ResultsWriter.resume(tmp_path, until=float(older.time[4]))
    again.append(run.sample(1.0, REFERENCE, TRIANGLES))
    again.append(run.sample(1.1, REFERENCE, TRIANGLES).at_step())
    again.close()
    assert list(read_results(tmp_path).steps.time) == [*older.time[:5], 1.0]


def test_a_metric_that_begins_late_is_nan_before(tmp_path: Path) -> None:
    out = writer(tmp_path)
    first = run.sample(0.0, REFERENCE, TRIANGLES)
    out.append(type(first)(**{**vars(first), "metrics": {}}))
    out.append(run.sample(0.1, REFERENCE, TRIANGLES))
    out.close()
    speed = read_results(tmp_path).metrics["speed_max"]
    assert np.isnan(speed[0])
    assert speed[1] == 0.8


def test_a_folder_without_results_is_refused_with_the_mend(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match="edt run"):
        read_results(tmp_path)
    (tmp_path / "results.h5").write_bytes(b"not HDF5")
    with pytest.raises(RunFailed, match=r"results\.h5"):
        read_results(tmp_path)
    with pytest.raises(RunFailed, match=r"results\.h5"):
        ResultsWriter.resume(tmp_path, until=1.0)


WRITE_FOR_EVER = """
import itertools, sys
import known_run as run
from coupling.store.results_writer import ResultsWriter
reference, triangles = run.disc(20)
writer = ResultsWriter.create(
    sys.argv[1], scene_toml="", model="m", reference=reference, triangles=triangles
)
for k in itertools.count():
    sample = run.sample(0.01 * k, reference, triangles)
    writer.append(sample.at_step() if k % 3 else sample)  # two flushes in three without instants
    writer.flush()
    if k == 0:
        print("first", flush=True)
"""


@pytest.mark.parametrize("seed", range(6))
def test_a_kill_at_any_moment_leaves_whole_files(tmp_path: Path, seed: int) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", WRITE_FOR_EVER, str(tmp_path)],
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parents[3],
        env={"PYTHONPATH": f"{Path(__file__).parents[1]}:{Path(__file__).parents[3]}"},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == b"first\n"
    time.sleep(random.Random(seed).uniform(0.0, 0.5))
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()
    results = read_results(tmp_path)
    steps = check_xdmf(tmp_path)
    assert 1 <= steps <= len(results.time) <= steps + 1
    ends = results.steps.time
    assert np.array_equal(ends, 0.01 * np.arange(len(ends)))
    assert np.array_equal(results.time, ends[::3])
    assert len(results.steps.metrics["speed_max"]) == len(ends)
    again = ResultsWriter.resume(tmp_path, until=float(results.time[-1]))
    again.append(run.sample(1e3, *run.disc(20)))
    again.close()
    assert check_xdmf(tmp_path) == len(results.time) + 1
    assert not list(tmp_path.glob(".*"))


FILL = """
import itertools, resource, signal, sys
import known_run as run
from coupling.ports import RunFailed
from coupling.store.results import read_results
from coupling.store.results_writer import ResultsWriter
if int(sys.argv[2]):
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]),) * 2)
reference, triangles = run.disc()
writer = ResultsWriter.create(
    sys.argv[1], scene_toml="", model="m", reference=reference, triangles=triangles
)
written = 0
try:
    for k in itertools.count():
        writer.append(run.sample(0.01 * k, reference, triangles))
        writer.flush()
        written = k + 1
except RunFailed as error:
    assert len(read_results(sys.argv[1]).time) in (written, written + 1)
    print(written, error)
"""


def fill(folder: Path, limit: int) -> str:
    done = subprocess.run(
        [sys.executable, "-c", FILL, str(folder), str(limit)],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[3],
        env={"PYTHONPATH": f"{Path(__file__).parents[1]}:{Path(__file__).parents[3]}"},
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout


def test_a_file_that_may_not_grow_keeps_what_was_written(tmp_path: Path) -> None:
    said = fill(tmp_path, 2_000_000)
    assert int(said.split()[0]) > 3
    assert "disk is full" in said
    check_xdmf(tmp_path)
    assert not list(tmp_path.glob(".*"))


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    place = tmp_path / "disk"
    place.mkdir()
    made = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=6m", "tmpfs", str(place)], check=False
    )
    if made.returncode:
        pytest.skip("mounting a small disk needs root; the limit on the file's size stands in")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_full_disk_keeps_what_was_written(small_disk: Path) -> None:
    said = fill(small_disk, 0)
    assert int(said.split()[0]) > 3
    assert "disk is full" in said
    check_xdmf(small_disk)


def test_nothing_is_written_more_than_twice(tmp_path: Path) -> None:
    """Bytes for the second half of the rows, over what the file grows by meanwhile.

    Twice the rows, and the file's own tables where they change, which are small. A file copied
    whole at every writing would take 30, as many rows as it holds on average.
    """
    out = writer(tmp_path)

    def written(first: int, last: int) -> tuple[int, int]:
        for k in range(first, last):
            out.append(run.sample(0.01 * k, REFERENCE, TRIANGLES))
            out.flush()
        said = Path("/proc/self/io").read_text().split("wchar: ")[1].split()[0]
        return int(said), (tmp_path / "results.h5").stat().st_size

    bytes_before, size_before = written(0, 20)
    bytes_after, size_after = written(20, 40)
    assert bytes_after - bytes_before < 6 * (size_after - size_before)


def test_a_writing_that_got_half_way_is_made_up_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``results.h5`` had its rows when ``results.xdmf`` found the disk full."""
    out = writer(tmp_path)
    for k in range(3):
        out.append(run.sample(0.1 * k, REFERENCE, TRIANGLES))
        out.flush()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    fourth = run.sample(0.3, REFERENCE, TRIANGLES)
    with monkeypatch.context() as patch:
        patch.setattr(out, "flush", lambda: None)  # append may write at once
        out.append(fourth)
    with monkeypatch.context() as patch:
        patch.setattr("coupling.store.xdmf.extend", full)
        with pytest.raises(RunFailed, match="disk is full"):
            out.flush()
    assert len(read_results(tmp_path).time) == 4
    assert not list(tmp_path.glob(".*"))
    out.append(run.sample(0.4, REFERENCE, TRIANGLES))
    out.close()
    assert check_xdmf(tmp_path) == 5


def test_writing_takes_a_small_share_of_a_step(tmp_path: Path) -> None:
    """Of CPU time, as others compute beside the tests; a small step takes 20 ms."""
    out = writer(tmp_path)
    items = [run.sample(0.01 * k, REFERENCE, TRIANGLES) for k in range(100)]
    begin = time.process_time()
    for item in items:
        out.append(item)
    assert time.process_time() - begin < 100 * 0.15 * 0.02  # a twentieth, and room
