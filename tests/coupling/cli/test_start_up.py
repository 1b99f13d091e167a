"""The command starts quickly since its verbs import what they work with when they are called."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from small_scene import SMALL

SHORT = """\
[model]
fluid = "hydrostatic"
[cloth]
resolution = 6
[time]
duration = 0.02
step = 0.01
"""
CASE = Path(__file__).parents[3] / "foam_cases" / "pad_sway_coarse"
# Each takes a tenth of a second of CPU or more.
COMPUTING = {
    "PyFoam", "dask", "distributed", "h5py", "matplotlib", "meshio", "numba", "pandas", "scipy",
    "xarray",
}  # fmt: skip


def imported(code: str) -> set[str]:
    """Top-level modules that a fresh interpreter has imported after ``code``."""
    lines = ("import sys", "try:", f"    {code}", "except SystemExit:", "    pass")
    after = "\n".join([*lines, "print()", "print(*sys.modules)"])
    done = subprocess.run(
        [sys.executable, "-c", after], capture_output=True, text=True, check=True, timeout=60
    )
    return {name.partition(".")[0] for name in done.stdout.splitlines()[-1].split()}


def edt(*words: object) -> set[str]:
    given = ["edt", *map(str, words)]
    return imported(f"sys.argv = {given!r}; from coupling.cli.entry import main; main()")


@pytest.mark.parametrize("words", [["--help"], ["--version"]])
def test_listing_the_verbs_imports_nothing_that_computes(words: list[str]) -> None:
    assert not edt(*words) & (COMPUTING | {"numpy", "pydantic"})


@pytest.mark.openfoam
def test_checking_a_scene_imports_no_solver() -> None:
    """Numbers, estimated errors and costs of a sine take NumPy alone."""
    found = edt("check", CASE)
    assert {"numpy", "pydantic"} <= found
    assert not found & COMPUTING


def test_importing_the_package_imports_nothing_else() -> None:
    assert not imported("import coupling") & (COMPUTING | {"numpy", "pydantic", "typer"})


def test_a_run_without_a_report_imports_nothing_that_draws(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(f"{SMALL}{SHORT}")
    found = edt("run", tmp_path, "-o", tmp_path / "run", "--no-report", "--json")
    assert (tmp_path / "run" / "summary.json").is_file()
    assert not found & {"matplotlib", "mpl_toolkits", "PIL"}
