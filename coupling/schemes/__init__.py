"""Coupling schemes for the interface's fixed point x = S(F(x)), behind one protocol.

Each has the form its paper gives it. With the added-mass scheme the structure takes the liquid's
inertia into its own step (a Robin condition), which changes S. A scheme is one file, and one line
in ``SCHEMES``.
"""

from __future__ import annotations

from coupling.ports import Scheme
from coupling.registry import Registry

__all__ = ["SCHEMES"]

# the best first: it is the default, and what a failed run is advised to take
SCHEMES: Registry[type[Scheme]] = Registry(
    "coupling scheme",
    {
        "added-mass": "coupling.schemes.added_mass:AddedMass",
        "iqn-ils": "coupling.schemes.iqn_ils:IqnIls",
        "aitken": "coupling.schemes.aitken:Aitken",
        "fixed-point": "coupling.schemes.fixed_point:FixedPoint",
    },
)
