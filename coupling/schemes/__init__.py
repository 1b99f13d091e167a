"""Coupling schemes for the interface's fixed point x = S(F(x)), behind one protocol.

Each has the form its paper gives it. With the added-mass scheme the structure takes the liquid's
inertia into its own step (a Robin condition), which changes S.
"""

from __future__ import annotations

from coupling.ports import Scheme
from coupling.schemes.added_mass import AddedMass
from coupling.schemes.aitken import Aitken
from coupling.schemes.fixed_point import FixedPoint
from coupling.schemes.iqn_ils import IqnIls

__all__ = ["AddedMass", "Aitken", "FixedPoint", "IqnIls", "scheme_named"]


def scheme_named(name: str, *, relaxation: float, reuse: int) -> tuple[Scheme, bool]:
    """The scheme of the scene's ``coupling.scheme``, and whether it takes the added mass in."""
    match name:
        case "fixed-point":
            return FixedPoint(), False
        case "aitken":
            return Aitken(relaxation), False
        case "iqn-ils":
            return IqnIls(relaxation, reuse), False
        case "added-mass":
            return AddedMass(), True
    raise ValueError(f"no coupling scheme '{name}'")
