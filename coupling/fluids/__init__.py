"""The fluid ladder: what the liquid's pressure on the diaphragm is taken to be.

A fluid model is one file with a ``FluidModel``, and one line in ``FLUIDS``. No other package names
one: all that others ask of it, the model says.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from coupling.registry import Registry

if TYPE_CHECKING:  # a scene reads the names before there is a scene that a model could be of
    from coupling.fluids.model import FluidModel

__all__ = ["ASSUMED", "DEFAULT", "FLUIDS", "by_rank"]

# the simplest first, the one that leaves out least last
FLUIDS: Registry[FluidModel] = Registry(
    "fluid model",
    {
        "datum": "coupling.fluids.datum:DATUM",
        "hydrostatic": "coupling.fluids.hydrostatic:HYDROSTATIC",
        "potential": "coupling.fluids.potential.model:POTENTIAL",
        "openfoam": "coupling.fluids.openfoam.model:OPENFOAM",
    },
)
DEFAULT = "openfoam"  # of a scene that names none
ASSUMED = "hydrostatic"  # the assumption that a study puts to the test


def by_rank(names: Iterable[str]) -> list[str]:
    """``names`` of fluid models, the simplest first."""
    return sorted(names, key=FLUIDS.rank)
