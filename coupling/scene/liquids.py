"""Liquids that can be named in a scene.

Density and surface tension are those of the thesis' Table 3. It gives no viscosities; they are
quoted at 25 C from the sources named beside each, and only matter to the Navier-Stokes fluid.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class LiquidData:
    """``density`` [kg/m^3], kinematic ``viscosity`` [m^2/s], ``surface_tension`` [N/m]."""

    density: float
    viscosity: float
    surface_tension: float
    viscosity_source: str


LIQUIDS: dict[str, LiquidData] = {
    "water": LiquidData(
        density=997.0,
        viscosity=8.93e-7,
        surface_tension=0.073,
        viscosity_source="IAPWS R12-08 (2008), 0.890 mPa s over 997.05 kg/m^3",
    ),
    "hydrazine": LiquidData(
        density=1010.0,
        viscosity=8.73e-7,
        surface_tension=0.062,
        viscosity_source="Schmidt, Hydrazine and its Derivatives (Wiley), "
        "0.876 mPa s over 1004 kg/m^3",
    ),
    "novec": LiquidData(
        density=1500.0,
        viscosity=3.84e-7,
        surface_tension=0.019,
        viscosity_source="3M Novec 7100 product information, 0.58 mPa s over 1510 kg/m^3. "
        "The thesis does not say which Novec; its surface tension is nearer to Novec 7700",
    ),
    "fc-72": LiquidData(
        density=1680.0,
        viscosity=3.8e-7,
        surface_tension=0.010,
        viscosity_source="3M Fluorinert FC-72 product information, 0.38 cSt",
    ),
}
