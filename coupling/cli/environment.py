"""The verbs ``edt info`` and ``edt build-solver``: what a run stands on.

That is the versions, the flow solver, and the compiler of the kernels.
"""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

import typer

from coupling.cli.exit_status import guarded
from coupling.cli.json_output import print_json
from coupling.cli.options import AsJson, OpenFoamPrefix

_PACKAGES = ("numpy", "scipy", "h5py", "pydantic")


@guarded("coupling.foam.build")
def build_solver(openfoam: OpenFoamPrefix = None) -> None:
    """Build the flow solver that stays alive for a whole run, and is some ten times as fast."""
    from coupling.foam.build import build_solver as build
    from coupling.foam.installation import find_openfoam

    typer.echo(build(find_openfoam(), say=lambda what: typer.echo(f"{what} ...", err=True)))


@guarded("coupling.fluids.model")
def info(openfoam: OpenFoamPrefix = None, as_json: AsJson = False) -> None:
    """Say which versions are here, what was found of OpenFOAM, and what is compiled."""
    values = found()
    if as_json:
        print_json(values)
    else:
        from coupling.cli.plain_table import print_table

        print_table("", ("", "found"), [(name, str(value)) for name, value in values.items()])


def found() -> dict[str, str]:
    """Name and version of each part; where one is missing, what is lost and the mend."""
    from coupling.fluids import FLUIDS

    values = {"diaphragm-tank": _version("diaphragm-tank"), "python": platform.python_version()}
    values |= {name: _version(name) for name in _PACKAGES}
    compiler = _version("numba")
    values["compiled kernels"] = (
        "no: numba is not installed" if compiler == "not installed" else f"numba {compiler}"
    )
    for name in FLUIDS:
        values |= FLUIDS[name].installed()
    return values


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
