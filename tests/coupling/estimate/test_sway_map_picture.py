"""The picture beside the maps of the sway: all rows of the table, both models named."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from coupling.estimate.model_errors import DATA, read_rows
from foam_cases.sway_map.draw import main


@pytest.fixture
def picture(tmp_path: Path) -> Iterator[Path]:
    file = tmp_path / "errors.png"
    main(file)
    yield file
    plt.close()


def test_both_models_are_drawn_and_named(picture: Path) -> None:
    axes = plt.gcf().axes[0]
    legend = axes.get_legend()
    assert legend is not None
    named = [text.get_text().partition(" against ")[0] for text in legend.get_texts()]
    assert named[:2] == ["hydrostatic", "potential"]
    text = (files("coupling.estimate") / DATA).read_text()
    models = [row.model for row in read_rows(text.splitlines())]
    points = [len(drawn.get_offsets()) for drawn in axes.collections]
    assert points == [models.count("hydrostatic"), models.count("potential")]


def test_the_file_is_an_image_with_something_on_it(picture: Path) -> None:
    image = plt.imread(picture)
    assert image.shape[:2] == (506, 770)  # 4.6 and 7 inches at 110 dots
    assert image[..., :3].std() > 0.0
