"""The even thickness that moves as a ridged diaphragm does, by the CG and by the folds.

``.venv/bin/python -P tests/benchmarks/ridges.py [FOLDER]`` runs ``foam_cases/ridges`` with both
directions of ridges and with even thicknesses, on two grids, with half the step, another damping of
folds and another liquid, and prints the table of that case's README. Runs in FOLDER are not done
again.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cloth.mesh import moulded, rest_gradients
from coupling import run as run_scene
from coupling.metrics.folds import FoldFinder
from coupling.ports import Array
from coupling.scene.scene import Scene, load_scene
from coupling.store.results import read_results
from coupling.store.run_record import SUMMARY, read_summary

CASE = Path(__file__).parents[2] / "foam_cases" / "ridges"
EVEN = (0.0012, 0.0014, 0.0016, 0.0018, 0.0020, 0.0022, 0.0024)  # m
RIDGED: dict[str, dict[str, Any]] = {
    "circumferential": {},
    "radial": {"diaphragm.ridge_direction": "radial", "diaphragm.ridge_number": 8},
}
VARIED: dict[str, dict[str, Any]] = {
    "12 rings": {},
    "16 rings": {"cloth.resolution": 16},
    "step halved": {"time.step": 0.00625},
    "fold_damping 0.25": {"cloth.fold_damping": 0.25},
    "potential": {"model.fluid": "potential"},
}
FINE = 2001  # thicknesses between which a curve is searched


@dataclass(frozen=True, kw_only=True)
class Found:
    """A run's figures: ``cg`` [m] the phasor along the sway; means over the last period of the
    area ``folded`` over [-] and of the ``curvature`` [1/m] that the sharpest tenth exceeds."""

    cg: complex
    folded: float
    curvature: float


def figures(folder: Path, changes: dict[str, Any]) -> Found:
    """Figures of the case with ``changes``, run in ``folder`` unless that is done."""
    scene = load_scene(CASE, changes)
    if not (folder / SUMMARY).is_file():
        run_scene(CASE, folder, changes=changes, report=False)
    summary, results = read_summary(folder), read_results(folder)
    phase = np.radians(summary["cg"]["phase_deg"][0])
    finder = FoldFinder(results.reference, results.triangles)
    steps = results.steps
    assert scene.period is not None
    last, rows = (time > time[-1] - scene.period for time in (steps.time, results.time))
    radii = [finder.folds(position).tenth_radius for position in results.position[rows]]
    return Found(
        cg=summary["cg"]["amplitude_m"][0] * np.exp(1j * phase),
        folded=float(steps.metrics["folded_area"][last].mean() / finder.area),
        curvature=float(np.mean(1.0 / np.array(radii))),
    )


def even(thickness: float) -> dict[str, Any]:
    """Changes of the case to a diaphragm of one ``thickness`` [m]: ridges of no height."""
    return {"diaphragm.thickness": thickness, "diaphragm.ridge_height": 1e-15}


def equivalents(ridged: Found, found: list[Found]) -> tuple[float, float, list[float], list[float]]:
    """Thickness [m] with the nearest CG phasor, how far off that is, and those of equal folds."""
    fine = np.linspace(EVEN[0], EVEN[-1], FINE)
    phasors = np.interp(fine, EVEN, [one.cg for one in found])
    away = np.abs(phasors - ridged.cg) / abs(ridged.cg)
    nearest = int(np.argmin(away))
    crossings = [
        _crossings(fine, np.interp(fine, EVEN, [getattr(one, name) for one in found]), value)
        for name, value in (("folded", ridged.folded), ("curvature", ridged.curvature))
    ]
    return float(fine[nearest]), float(away[nearest]), crossings[0], crossings[1]


def _crossings(x: Array, y: Array, value: float) -> list[float]:
    """Where a curve passes ``value``."""
    return [float(one) for one in x[1:][np.diff(np.sign(y - value)) != 0]]


def means(scene: Scene) -> tuple[float, float]:
    """Mean thickness and the cube root of the mean of its cube [m], of the moulded area."""
    mesh = moulded(scene.mould, 64)
    thickness = scene.thickness_at(mesh.points[mesh.triangles].mean(axis=1))
    _, areas = rest_gradients(mesh.points, mesh.triangles)
    assert thickness is not None
    return scene.mean_thickness, float((thickness**3 @ areas / areas.sum()) ** (1.0 / 3.0))


def main() -> None:
    """Run what is missing, and print the table."""
    root = Path(sys.argv[1] if len(sys.argv) > 1 else "runs/ridges")
    heads = ("", "mean", "root of t^3", "by CG", "off by", "by folded area", "by curvature")
    print("| " + " | ".join(heads) + " |\n" + "|---" * len(heads) + "|")
    for name, varied in VARIED.items():
        curve = [
            figures(root / f"{name} {1e3 * one:g}".replace(" ", "_"), varied | even(one))
            for one in EVEN
        ]
        print(
            f"<!-- {name}: "
            + "; ".join(_said(*one) for one in zip(EVEN, curve, strict=True))
            + " -->"
        )
        for direction, changes in RIDGED.items():
            found = figures(root / f"{name} {direction}".replace(" ", "_"), varied | changes)
            mean, root_mean = means(load_scene(CASE, changes))
            print(f"<!-- {direction}: {_said(mean, found)} -->")
            by_cg, off, folded, curvature = equivalents(found, curve)
            cells = (
                f"{direction}, {name}", _mm([mean]), _mm([root_mean]), _mm([by_cg]),
                f"{100.0 * off:.1f} %", _mm(folded), _mm(curvature),
            )  # fmt: skip
            print("| " + " | ".join(cells) + " |", flush=True)


def _said(thickness: float, found: Found) -> str:
    return (
        f"{1e3 * thickness:.2f} mm: CG {1e3 * abs(found.cg):.2f} mm at "
        f"{np.degrees(np.angle(found.cg)):.2f} deg, folded {100.0 * found.folded:.1f} %, "
        f"curvature {found.curvature:.2f}/m"
    )


def _mm(values: list[float]) -> str:
    return ", ".join(f"{1e3 * value:.2f} mm" for value in values) or "none"


if __name__ == "__main__":
    main()
