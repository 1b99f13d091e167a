"""What a run stands on: versions, the flow solver, the compiler of the kernels."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from coupling.foam.installation import OpenFoamMissing, find_openfoam

_PACKAGES = ("numpy", "scipy", "h5py", "pydantic")


def found() -> dict[str, str]:
    """Name and version of each part; where one is missing, what is lost and the mend."""
    values = {"diaphragm-tank": _version("diaphragm-tank"), "python": platform.python_version()}
    values |= {name: _version(name) for name in _PACKAGES}
    compiler = _version("numba")
    values["compiled kernels"] = (
        "no: numba is not installed" if compiler == "not installed" else f"numba {compiler}"
    )
    try:
        solver = find_openfoam(keep_alive=True)
        values["openfoam"] = f"{solver.version}, {solver.solver}"
        values["solver that stays alive"] = str(
            solver.keep_alive
            or "not built: 'edt build-solver' makes runs with a flow faster, and waves last longer"
        )
    except OpenFoamMissing as missing:
        values["openfoam"] = f"not found: {missing}"
    return values


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
