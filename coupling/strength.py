"""Whether the rubber would hold, before anything is run."""

from __future__ import annotations

from coupling.scene import Scene
from coupling.shaking import largest_body_force


def stress_estimate(scene: Scene) -> float:
    """rho b R^2/(2 t) [Pa]: a dome of the tank's radius under rho b R, where it is thinnest.

    b is the largest body force of the motion. An upper estimate: where the diaphragm lies on the
    shell, the shell carries the load; slams, which pull harder for an instant, are left out.
    """
    pressure = scene.liquid.density * largest_body_force(scene) * scene.tank.radius
    return pressure * scene.tank.radius / (2.0 * scene.diaphragm.thickness_range[0])


def burst_warning(scene: Scene) -> str | None:
    """A sentence where the estimate is above ``diaphragm.strength``; None otherwise."""
    strength, stress = scene.diaphragm.strength, stress_estimate(scene)
    if strength is None or stress <= strength:
        return None
    return (
        f"The rubber would burst: shaken at up to {largest_body_force(scene):.4g} m/s^2 it would "
        f"carry about {1e-6 * stress:.3g} MPa, its strength is {1e-6 * strength:.3g} MPa."
    )
