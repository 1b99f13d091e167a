"""Whether the rubber would hold, before anything is run."""

from __future__ import annotations

from coupling.motion.shaking import largest_body_force
from coupling.scene.scene import Scene


def stress_estimate(scene: Scene) -> float:
    """rho b R^2/(2 t) [Pa]: a dome of the tank's radius under rho b R, where it is thinnest.

    b is the largest body force of the motion. An upper estimate: where the diaphragm lies on the
    shell, the shell carries the load; slams, which pull harder for an instant, are left out.
    """
    radius = scene.tank.shell.size
    pressure = scene.liquid.density * largest_body_force(scene) * radius
    return pressure * radius / (2.0 * scene.diaphragm.thickness_range[0])


def strength_verdict(scene: Scene, stress: float | None) -> str | None:
    """Whether the rubber holds, of a run whose largest computed ``stress`` [Pa] is known.

    None where its strength or the stress is not. The load's estimate decides where it can: the
    computed stress does not converge where the sheet snaps taut, it grows as the step falls.
    """
    strength, load = scene.diaphragm.strength, stress_estimate(scene)
    if strength is None or stress is None:
        return None
    asked = f"the load alone asks for about {1e-6 * load:.3g} MPa"
    share = f"{stress / strength:.2g} times the strength"
    if load > strength:
        return f"No: {asked}, the strength is {1e-6 * strength:.3g} MPa."
    if stress > strength:
        return (
            f"Not decided: {asked}, which it bears, but where the sheet snapped taut the stress "
            f"reached {share}. That peak grows as the step falls; measure before you rely on it."
        )
    return f"Yes: {asked}, and the largest stress computed is {share}."


def burst_warning(scene: Scene) -> str | None:
    """A sentence where the estimate is above ``diaphragm.strength``; None otherwise."""
    strength, stress = scene.diaphragm.strength, stress_estimate(scene)
    if strength is None or stress <= strength:
        return None
    return (
        f"The rubber would burst: shaken at up to {largest_body_force(scene):.4g} m/s^2 it would "
        f"carry about {1e-6 * stress:.3g} MPa, its strength is {1e-6 * strength:.3g} MPa."
    )
