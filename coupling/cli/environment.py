"""What a run stands on: versions, the compiler of the kernels, the flow solver."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

from coupling.fluids import FLUIDS

_PACKAGES = ("numpy", "scipy", "h5py", "pydantic")


def found() -> dict[str, str]:
    """Name and version of each part; where one is missing, what is lost and the mend."""
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
