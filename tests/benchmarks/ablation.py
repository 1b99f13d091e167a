"""What each tuned constant is worth: one gentle and one violent scene, with and without it.

    python -P tests/benchmarks/ablation.py [--results ablation.jsonl] [--table] [--only PART]

Every run changes one setting of the coupled step, the schemes, the patch or the contact curve, and
is kept as a line of RESULTS: started again, the runs that stand there are not repeated. ``--table``
prints the table of what is there and runs nothing; ``--only`` takes the variants whose names
contain PART. Two runs a variant, of 10 to 60 CPU seconds each: an hour in all where a solver that
stays alive has been built.
"""

from __future__ import annotations

import argparse
import json
import logging
import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from math import radians, tan
from pathlib import Path
from typing import Any
from unittest.mock import patch

from coupling.interface.contact_curve import ContactSettings
from coupling.interface.patch_settings import PatchSettings
from coupling.interface.weights import Support
from coupling.scene.scene import load_scene
from coupling.schemes.iqn_ils import IqnIlsSettings
from coupling.simulation.driver import run
from coupling.step.backtracking import BacktrackingSettings
from coupling.step.coupled import CoupledSettings
from coupling.step.halving import HalvingSettings
from coupling.step.remap import RemapSettings

SCENE = Path(__file__).parents[2] / "foam_cases" / "pad_sway_coarse"
COMMON = (
    "openfoam.cells=540", "openfoam.write_fields=false", "cloth.resolution=10",
    "time.duration=0.8", "coupling.max_unconverged=1000",
    "coupling.max_unconverged_share=1.0",
)  # fmt: skip
SCENES = {
    "gentle": ("liquid.fill_fraction=0.8", "motion.amplitude=0.025", "motion.ramp=0.5"),
    "violent": ("liquid.fill_fraction=0.5", "motion.amplitude=0.25", "motion.ramp=0.0"),
}
AS_IT_IS = "as it is"
TRIED: dict[type, dict[str, tuple[float, ...]]] = {
    BacktrackingSettings: {"halvings": (0,)},
    RemapSettings: {"maps": (1,), "slow": (4,)},
    HalvingSettings: {"halvings": (0,)},
    CoupledSettings: {"diverged": (10.0,)},
    IqnIlsSettings: {"filtering": (0.0, 0.3)},
    PatchSettings: {
        "wedge": (tan(radians(5.0)), tan(radians(30.0))), "film": (0.005, 0.08),
        "steep": (0.05, 0.7), "smallest": (0.0, 1.0), "creased": (0.98, 0.5),
        "smooth": (0.9905,), "rounds": (0,), "more": (20,),
    },
    ContactSettings: {
        "reach": (1.0, 0.25), "order": (3, 12), "share": (1.0, 0.25), "upright": (0.0, 2.0),
    },
}  # fmt: skip
TOGETHER: dict[type, dict[str, dict[str, Any]]] = {
    PatchSettings: {
        "first order everywhere": {"smooth": 1e9},
        "corners not rounded": {"open": -2.0, "sharp": -3.0},
        "linear.reach = 1": {"linear": Support(reach=1.0, least=12)},
        "linear.least = 6": {"linear": Support(reach=1.3, least=6)},
        "quadratic.reach = 1.3": {"quadratic": Support(reach=1.3, least=20)},
        "quadratic.least = 12": {"quadratic": Support(reach=1.8, least=12)},
    },
}


@dataclass(frozen=True)
class Variant:
    """Settings that differ from what they are: ``changes`` of the fields of ``settings``."""

    settings: type
    label: str
    changes: dict[str, Any]

    @property
    def name(self) -> str:
        """As the table has it."""
        return f"{self.settings.__name__}: {self.label}" if self.changes else AS_IT_IS


def variants() -> Iterator[Variant]:
    """All that is tried, the settings as they are first."""
    yield Variant(CoupledSettings, "", {})
    yield Variant(PatchSettings, "film = 0.0200001, which is noise", {"film": 0.0200001})
    for settings, values in TRIED.items():
        for name, others in values.items():
            for value in others:
                yield Variant(settings, f"{name} = {value:.3g}", {name: value})
        for label, changes in TOGETHER.get(settings, {}).items():
            yield Variant(settings, label, changes)


def by_weight(variant: Variant) -> int:
    """Variants in the order they are run: the first value of every constant before the others."""
    others = TRIED.get(variant.settings, {})
    ranks = [others.get(name, ()) for name in variant.changes]
    return max(
        (tried.index(value) for tried, value in zip(ranks, variant.changes.values(), strict=True)
         if value in tried), default=0,
    )  # fmt: skip


@contextmanager
def in_force(variant: Variant) -> Iterator[None]:
    """The variant's changes in place of the defaults of its settings."""
    with ExitStack() as stack:
        if variant.changes:
            defaults = variant.settings.__init__.__kwdefaults__  # type: ignore[misc]
            known = set(variant.settings.__dataclass_fields__)  # type: ignore[attr-defined]
            assert set(variant.changes) <= known, variant
            stack.enter_context(patch.dict(defaults, variant.changes))
        yield


def solved(variant: Variant, scene: str) -> dict[str, Any]:
    """What is kept of the run of ``scene`` with ``variant``."""
    before = sum(os.times()[:4])
    with in_force(variant), tempfile.TemporaryDirectory() as folder:
        summary = run(load_scene(SCENE, [*COMMON, *SCENES[scene]]), Path(folder))
    coupling, cg = summary["coupling"], summary.get("cg")
    return {
        "variant": variant.name,
        "scene": scene,
        "steps": summary["steps"],
        "mean": coupling["iterations_mean"],
        "max": coupling["iterations_max"],
        "failed": coupling["unconverged_steps"] + summary["halved_steps"],
        "amplitude": cg["amplitude_m"][0] if cg else None,
        "phase": cg["phase_deg"][0] if cg else None,
        "error": summary["error"],
        "cpu": sum(os.times()[:4]) - before,
    }


def read(file: Path) -> dict[tuple[str, str], dict[str, Any]]:
    """The runs kept in ``file``, by variant and scene."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.is_file() else []
    runs = [json.loads(line) for line in lines]
    return {(run["variant"], run["scene"]): run for run in runs}


def cells(run: dict[str, Any] | None, base: dict[str, Any] | None) -> list[str]:
    """Iterations, failed steps, and the change of the CG's amplitude and phase of a ``run``."""
    if run is None:
        return [""] * 4
    counts = [f"{run['mean']:.3f} ({run['max']})", str(run["failed"])]
    if run["error"] or run["amplitude"] is None or base is None:
        return [*counts, f"ended after {run['steps']} steps", ""]
    if run is base:
        return [*counts, f"{1000 * run['amplitude']:.2f} mm", f"{run['phase']:.2f}"]
    change = 100 * (run["amplitude"] / base["amplitude"] - 1)
    turned = (run["phase"] - base["phase"] + 180) % 360 - 180
    return [*counts, f"{change:+.2f} %", f"{turned:+.2f}"]


def table(file: Path, chosen: list[Variant]) -> None:
    """Print the runs kept in ``file`` as a table, the changes against the settings as they are."""
    runs = read(file)
    names = ("iterations", "failed", "CG", "phase, deg")
    heads = [f"{scene}: {name}" for scene in SCENES for name in names]
    print(f"| setting | {' | '.join(heads)} |\n|{'---|' * (1 + len(heads))}")
    for variant in chosen:
        row = [variant.name]
        for scene in SCENES:
            row += cells(runs.get((variant.name, scene)), runs.get((AS_IT_IS, scene)))
        if any(row[1:]):
            print(f"| {' | '.join(row)} |")


def main() -> None:
    """Run what is missing, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--results", type=Path, default=Path("ablation.jsonl"))
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    logging.disable(logging.ERROR)
    chosen = [variant for variant in variants() if given.only in variant.name]
    if not given.table:
        for variant in sorted(chosen, key=by_weight):
            for scene in SCENES:
                if (variant.name, scene) not in read(given.results):
                    with given.results.open("a", encoding="utf-8") as file:
                        file.write(json.dumps(solved(variant, scene)) + "\n")
    table(given.results, chosen)


if __name__ == "__main__":
    main()
