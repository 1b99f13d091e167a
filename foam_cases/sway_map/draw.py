"""Draws errors.png beside this file: how far two models are off, over the frequency.

    python foam_cases/sway_map/draw.py

From coupling/estimate/model_errors.csv, which `gather.py` makes.
"""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from coupling.estimate.model_errors import DATA, read_rows

MARKS = {"hydrostatic": "o", "potential": "^"}
PICTURE = Path(__file__).with_name("errors.png")


def main(picture: Path = PICTURE) -> None:
    """Draw it into ``picture``."""
    rows = read_rows((files("coupling.estimate") / DATA).read_text(encoding="utf-8").splitlines())
    figure, axes = plt.subplots(figsize=(7.0, 4.6), layout="constrained")
    for model, mark in MARKS.items():
        chosen = [row for row in rows if row.model == model]
        ratio, body_force = 10.0 ** np.array([row.coordinates[:2] for row in chosen]).T
        drawn = axes.scatter(
            ratio, [row.error for row in chosen], c=np.log10(body_force - 1.0), marker=mark,
            vmin=-1.7, vmax=0.3, cmap="viridis", edgecolors="black", linewidths=0.4, s=30,
            label=f"{model} against {chosen[0].reference}",
        )  # fmt: skip
    line = np.geomspace(0.06, 6.0, 2)
    axes.plot(line, line**2, color="black", linewidth=1.0, label=r"$(f/f_1)^2$")
    axes.set(xscale="log", yscale="log", xlabel=r"$f/f_1$", ylim=(1e-4, 50.0))
    axes.set_ylabel("error of the CG's motion, $|c - c_{ref}|/|c_{ref}|$")
    for level in (0.01, 0.05, 0.2):
        axes.axhline(level, color="grey", linewidth=0.6, linestyle=":")
    axes.legend(loc="upper left")
    bar = figure.colorbar(drawn, label="largest acceleration over gravity")
    bar.set_ticks(np.log10([0.025, 0.1, 0.4, 1.6]), labels=["0.025", "0.1", "0.4", "1.6"])
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    main()
