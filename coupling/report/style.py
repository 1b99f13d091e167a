"""How figures look: colours, sizes, and their way into the page."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from coupling.fluids import FLUIDS
from coupling.report.plotting import default_settings

# Okabe & Ito's palette, which the colour-blind can tell apart
_OTHERS: dict[str, tuple[str, Any]] = {  # rows of a study that are no fluid models
    "thesis": ("#E69F00", (0, (1, 3))),
    "compliant": ("#56B4E9", (0, (5, 1))),
    "inextensible": ("#56B4E9", (0, (5, 1))),
}
INK, GREY, LIGHT = "#1c2329", "#6b757d", "#d5dade"
BLUE, ORANGE = "#0072B2", "#D55E00"
# x, y and z of one vector differ by line and tone, which also survives a black and white printer
COMPONENTS = (("x", INK, "-"), ("y", "#56B4E9", "--"), ("z", "#E69F00", "-."))
WIDTH = 4.4  # inches: one column of the page; a telephone shows it at about 0.9

_STYLE: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Helvetica", "Arial", "Liberation Sans", "DejaVu Sans"],
    "font.size": 9.0,
    "text.color": INK,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e9ecee",
    "grid.linewidth": 0.7,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 1.8,
    "svg.fonttype": "path",
    "svg.hashsalt": "diaphragm-tank",
}


def look_of(row: str) -> tuple[str, Any]:
    """Colour and line of a study's row: its fluid model's, or its own.

    The best model's line is solid, so that a dashed curve on top of it shows both.
    """
    if row in FLUIDS:
        return FLUIDS[row].colour, FLUIDS[row].line
    return _OTHERS.get(row, (GREY, "-"))


@contextmanager
def house_style() -> Iterator[None]:
    """Matplotlib settings of the report and its defaults, within the block only."""
    with default_settings():
        mpl.rcParams.update(_STYLE)
        yield


def new_figure(height: float = 2.5, width: float = WIDTH) -> Figure:
    """Return an empty figure, of a size in inches, that no window shows."""
    return Figure(figsize=(width, height), layout="constrained")


def svg(figure: Figure) -> str:
    """The figure as a data address of an SVG image."""
    FigureCanvasSVG(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None}, transparent=True)
    return "data:image/svg+xml;base64," + base64.b64encode(buffer.getvalue()).decode()


def png(figure: Figure, dpi: float = 170.0) -> str:
    """The figure as a data address of a PNG image."""
    FigureCanvasAgg(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, transparent=True)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()


def legend_above(axes: Any, columns: int = 4) -> None:
    """Legend in a row above the axes, where it covers no curve."""
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns,
        borderaxespad=0.2,
        columnspacing=1.2,
    )


def thinned(time: Any, *series: Any, most: int = 1500) -> tuple[Any, ...]:
    """Every k-th instant, so that no curve has more than ``most`` points."""
    step = max(1, int(np.ceil(len(time) / most)))
    return tuple(np.asarray(item)[::step] for item in (time, *series))
