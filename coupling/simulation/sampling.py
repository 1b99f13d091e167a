"""One instant of a run put together from both sides of the interface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from coupling.interface.liquid_shape import liquid_cg
from coupling.metrics.bernoulli import node_areas, weighted_rms
from coupling.ports import Array, DiaphragmState, HydrostaticLoad, Ints, LiquidSample, Shell
from coupling.store.run_record import Sample


@dataclass(frozen=True, kw_only=True)
class NodePressures:
    """Pressures of a ``LiquidSample`` at the diaphragm's nodes, each (n,) [Pa]."""

    dynamic: Array
    kinetic: Array
    viscous: Array


def still(nodes: int) -> NodePressures:
    """Return the pressures of a liquid without a flow at so many ``nodes``: none."""
    none = np.zeros(nodes)
    return NodePressures(dynamic=none, kinetic=none, viscous=none)


def at_nodes(liquid: LiquidSample, to_nodes: Callable[[Array], Array]) -> NodePressures:
    """Return the pressures of ``liquid`` at the nodes, all by one map.

    ``to_nodes`` takes values (F, k) on the faces to the nodes (n, k).
    """
    parts = (liquid.face_pressure, liquid.kinetic_pressure, liquid.viscous_traction)
    dynamic, kinetic, viscous = np.ascontiguousarray(to_nodes(np.stack(parts, axis=1)).T)
    return NodePressures(dynamic=dynamic, kinetic=kinetic, viscous=viscous)


def sample_at(
    time: float,
    *,
    state: DiaphragmState,
    triangles: Ints,
    shell: Shell,
    load: HydrostaticLoad,
    acceleration: Array,
    displacement: Array,
    rotation: Array,
    rate: Array,
    flow: LiquidSample | None,
    pressures: NodePressures,
    iterations: int,
    residual: float,
    metrics: dict[str, float],
) -> Sample:
    """Return the results at an instant, from both sides of the interface.

    The force on tank and diaphragm is that of the hydrostatic pressure on the closed boundary,
    rho V b, and of p* on the flow's walls; the wall's shear, of the order of sqrt(nu f) times the
    speed, is left out.

    Parameters
    ----------
    time
        The instant [s].
    state
        The diaphragm there.
    triangles
        Nodes of each of its triangles (m, 3).
    shell
        The tank's shell.
    load
        Density and body force of the step that ends there.
    acceleration, displacement
        The tank's acceleration [m/s^2] and displacement [m], each (3,).
    rotation, rate
        How the tank has turned, a rotation vector (3,) [rad], and how fast it does (3,) [rad/s] in
        its own axes.
    flow
        The flow there, None without one.
    pressures
        p*, its kinetic part and the viscous traction at the diaphragm's nodes, each (n,) [Pa].
    iterations, residual
        Coupling iterations of the step, and the relative residual that they left.
    metrics
        Further scalars by name; those of ``split_metrics`` are added.

    Returns
    -------
    Sample
        The results, in the shapes and units given there.
    """
    weight = load.density * load.body_force * state.volume
    cg = liquid_cg(state.position, triangles, shell, state.volume)
    force, moment = weight, np.cross(cg, weight)
    if flow is not None:
        force = force + flow.wall_pressure_force
        moment = moment + flow.wall_pressure_moment
    hydrostatic = state.datum_pressure + load.density * state.position @ load.body_force
    turns = load.turn is not None
    return Sample(
        time=time,
        tank_acceleration=acceleration,
        tank_displacement=displacement,
        tank_rotation=rotation,
        tank_rate=rate,
        position=state.position,
        pressure=hydrostatic + pressures.dynamic,
        dynamic_pressure=pressures.dynamic,
        strain=state.strain,
        tension=state.tension,
        velocity=state.velocity - np.cross(rate, state.position) if turns else state.velocity,
        contact_force=state.contact_force,
        shell_pressure=state.shell_pressure,
        self_pressure=state.self_pressure,
        shell_slip=state.shell_slip,
        self_slip=state.self_slip,
        shell_work=state.shell_work,
        self_work=state.self_work,
        rub_place=state.rub_place,
        volume=state.volume,
        datum_pressure=state.datum_pressure,
        liquid_cg=cg,
        force=force,
        moment=moment,
        iterations=iterations,
        residual=residual,
        metrics=metrics | split_metrics(state.position, triangles, hydrostatic, pressures),
    )


def split_metrics(
    position: Array, triangles: Ints, hydrostatic: Array, pressures: NodePressures
) -> dict[str, float]:
    """Return the rms over the diaphragm [Pa] of the parts of the liquid's pressure, by name.

    A node counts with a third of its triangles' area, as in ``dynamic_fraction``. Of pressures the
    mean over the diaphragm is removed; the viscous traction is a magnitude, and its mean is not.

    Parameters
    ----------
    position
        Nodes of the diaphragm (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3).
    hydrostatic
        Hydrostatic pressure at the nodes (n,) [Pa].
    pressures
        p*, its kinetic part and the viscous traction at the nodes, each (n,) [Pa].

    Returns
    -------
    dict of float by str
        The rms [Pa] of the hydrostatic pressure, of p*, of its unsteady and kinetic part, and of
        the viscous traction.
    """
    weight = node_areas(position[None], triangles)
    parts = {
        "hydrostatic_pressure_rms": hydrostatic,
        "dynamic_pressure_rms": pressures.dynamic,
        "unsteady_pressure_rms": pressures.dynamic - pressures.kinetic,
        "kinetic_pressure_rms": pressures.kinetic,
    }
    found = {name: weighted_rms(values[None], weight) for name, values in parts.items()}
    square = float(weight[0] @ pressures.viscous**2 / weight.sum())
    return found | {"viscous_traction_rms": float(np.sqrt(square))}
