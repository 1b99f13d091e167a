"""Videos of a period: read back, and counted against the results."""

from __future__ import annotations

from pathlib import Path

import imageio_ffmpeg
import known_run
import numpy as np
import pytest
from PIL import Image, ImageSequence

from coupling.ports import Array, RunFailed
from coupling.report import render_video
from coupling.store.results import Results, read_results
from coupling.store.results_writer import ResultsWriter

STEP, PERIOD = 0.08, 10  # s, and instants in the period of 0.8 s


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("known")
    known_run.write_run(folder, step=STEP)
    return read_results(folder)


def frames_of(path: Path) -> Array:
    """Frames (k, height, width, 3) of a video, of either kind."""
    if path.suffix == ".gif":
        with Image.open(path) as gif:
            return np.stack([np.array(f.convert("RGB")) for f in ImageSequence.Iterator(gif)])
    reader = imageio_ffmpeg.read_frames(str(path))
    width, height = next(reader)["size"]
    return np.stack([np.frombuffer(f, np.uint8).reshape(height, width, 3) for f in reader])


@pytest.mark.parametrize("ending", [".mp4", ".gif"])
def test_a_video_has_a_frame_of_every_instant_of_the_period(
    results: Results, tmp_path: Path, ending: str
) -> None:
    frames = frames_of(render_video(results, tmp_path / f"period{ending}"))
    assert frames.shape == (PERIOD, 800, 640, 3)
    # p* is 200 Pa sin(omega t) x/R, x to the right: red leans right as the sine has it. The colours
    # are odd and monotonic in p*, not linear: even two colours alone would keep 0.9 of the
    # correlation.
    redness = frames[:, :600, :, 0].astype(float) - frames[:, :600, :, 2]
    lean = redness[:, :, 320:].mean(axis=(1, 2)) - redness[:, :, :320].mean(axis=(1, 2))
    time = results.time[-PERIOD:]
    assert np.corrcoef(lean, np.sin(known_run.OMEGA * time))[0, 1] > 0.9


def test_a_run_without_an_instant_has_no_video(tmp_path: Path) -> None:
    reference, triangles = known_run.disc()
    ResultsWriter.create(
        tmp_path, scene_toml="", model="datum", reference=reference, triangles=triangles
    ).close()
    with pytest.raises(RunFailed, match="no instant yet"):
        render_video(read_results(tmp_path), tmp_path / "period.gif")


def test_a_video_that_ffmpeg_does_not_write_is_a_failure(
    results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", "/bin/false")
    with pytest.raises(RunFailed, match="ffmpeg could not write it"):
        render_video(results, tmp_path / "period.mp4")
