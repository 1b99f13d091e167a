"""What boundary layers take from an irrotational liquid, against the closed form and modes."""

import numpy as np
import pytest
from scipy.special import jnp_zeros, jv
from shells import pill

from cloth.shell.arc_spline import ellipse
from cloth.shell.meridian import Meridian
from cloth.shell.sphere import Sphere
from coupling.estimate.sloshing_modes import layer_slip, slosh_eigenvalue
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.liquid import PotentialLiquid
from coupling.fluids.potential.ritz import RitzLiquid, wall_integral
from coupling.fluids.potential.step import PotentialStep
from coupling.fluids.potential.wall_layers import layer_speed, slip_form
from coupling.ports import HydrostaticLoad
from coupling.verify.cylinder import cylinder_samples
from coupling.verify.disc import disc_grid
from coupling.verify.free_surface import FreeSurface

RADIUS, DENSITY, GRAVITY = 0.4445, 1000.0, 9.81


def case_parkinson(k, depth):
    """R int |u_t|^2 dA/int |grad phi|^2 dV of the mode m = 1 in an upright cylinder of radius R.

    (1 + 1/(kR)^2)/(1 - 1/(kR)^2) - 2 kH/sinh 2kH of the side, and 2 kR/sinh 2kH of the bottom.
    """
    square, both = 1.0 / k**2, np.sinh(2.0 * k * depth)
    return (1 + square) / (1 - square) + (2.0 * k - 2.0 * k * depth) / both


@pytest.mark.parametrize("depth", [0.5, 1.0])
def test_layers_of_an_upright_cylinder_are_those_of_case_and_parkinson(depth):
    k, degree, half = jnp_zeros(1, 1)[-1], 12, 0.5 * depth * RADIUS
    plan, quads = disc_grid(4 * degree**2)
    top = np.column_stack([RADIUS * plan, np.full(len(plan), half)])
    harmonics = SolidHarmonics(degree, float(np.hypot(RADIUS, half)))
    points, area = cylinder_samples(degree, RADIUS, half)
    size = np.linalg.norm(area, axis=1)
    values = harmonics.values(points)
    form = slip_form(harmonics, values, area / size[:, None], size)
    liquid = RitzLiquid(
        triangles=np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]),
        harmonics=harmonics, wall=wall_integral(harmonics, points, area), density=DENSITY,
    ).at(top)  # fmt: skip
    distance = np.linalg.norm(plan, axis=1)
    rise = np.zeros_like(top)
    rise[:, 2] = jv(1, k * distance) * plan[:, 0] / np.maximum(distance, 1e-12)
    found = liquid.potential(rise)
    slip = RADIUS * found @ form @ found / (2.0 * liquid.kinetic_energy(rise) / DENSITY)
    # The grid's error h^2 with 16 cells in a radius, and what degree 12 leaves of the mode.
    assert slip == pytest.approx(case_parkinson(k, depth), rel=0.01)


def test_layers_of_a_half_full_ball_agree_with_those_of_polynomials():
    """Two methods that share nothing: the meridian's elements, and harmonics of degree 12."""
    degree, exact = 12, layer_slip(1.0, 1)
    liquid, surface = half_full(degree, viscosity=1e-6)
    shape = liquid.at(surface.reference)
    _, heights = surface.mode(surface.reference[:, 0], shape.rows())
    rise = heights[:, None] * surface.path
    layers, potential = liquid.layers(surface.reference, shape), shape.potential(rise)
    scale = DENSITY * layers.speed * 2.0 * shape.kinetic_energy(rise) / DENSITY / RADIUS
    # Velocities at the boundary come slower than frequencies: of first order in 1/degree.
    assert layers.power(potential, rise) / scale == pytest.approx(sum(exact), rel=0.2 / degree)
    assert exact == pytest.approx(layer_slip(1.0 + 1e-9, 1))


def test_the_slowest_wave_of_a_half_full_ball_is_that_of_its_elements():
    """The surface that counts lies within half a cell's distance of the shell: a third of an edge.

    Half a cell of 16 in a radius moves omega^2 by at most as much, 3 %, and the frequency by half.
    """
    liquid, surface = half_full(8, viscosity=0.0)
    found = liquid.slowest_wave(surface.reference, np.array([0.0, 0.0, -GRAVITY]))
    exact = np.sqrt(slosh_eigenvalue(1.0) * GRAVITY / RADIUS) / (2.0 * np.pi)
    assert found == pytest.approx(exact, rel=0.016)


def half_full(degree, viscosity):
    """A liquid of ``viscosity`` under a free surface across the middle of a ball."""
    plan, quads = disc_grid(4 * degree**2)
    plan = plan / np.linalg.norm(plan, axis=1).max()  # within the shell
    points = np.column_stack([RADIUS * plan, np.zeros(len(plan))])
    path = np.zeros_like(points)
    path[:, 2] = 1.0
    surface = FreeSurface(points, quads, path, mass=1e-3, density=DENSITY, gravity=GRAVITY)
    surface.converged = True
    liquid = PotentialLiquid(
        surface.triangles, len(points), shell=Sphere(RADIUS), degree=degree, density=DENSITY,
        layer=layer_speed(viscosity, 0.934),
    )  # fmt: skip
    return liquid, surface


def test_a_released_wave_falls_as_stokes_layers_take_it():
    """Energy lost in three periods; and all that is lost is what the layers are said to take."""
    liquid, surface = half_full(6, viscosity=1e-5)
    rows = liquid.at(surface.reference).rows()
    omega, heights = surface.mode(surface.reference[:, 0], rows)
    surface.displace(2e-3 * RADIUS * heights)
    step, load = (
        PotentialStep(surface, liquid),
        HydrostaticLoad(density=DENSITY, body_force=np.zeros(3)),
    )
    period, dt = 2.0 * np.pi / omega, 0.01
    energy, named = [], []
    for number in range(round(4 * period / dt)):
        step.attempt(number * dt, dt, load)
        step.accept()
        energy.append(surface.energy(rows))
        named.append(step.metrics(None)["dissipated_by_layers"])
    means = np.array([np.mean(part) for part in np.array_split(energy, 4)])
    rate = -np.log(means[-1] / means[0]) / (3.0 * period)
    expected = liquid.layer * sum(layer_slip(1.0, 1)) / RADIUS
    # Degree 6 is 2.4 % low on the boundary; the step itself takes pi (omega dt)^3 a period, 1.2 %.
    assert rate == pytest.approx(expected, rel=0.03)
    lost = energy[9] - energy[-1]
    assert named[-1] - named[9] == pytest.approx(lost, rel=0.03)


@pytest.mark.parametrize(
    "shell",
    [Sphere(RADIUS), Meridian(ellipse(RADIUS, 0.4 * RADIUS)), pill(RADIUS, RADIUS)],
    ids=["sphere", "flat ellipsoid", "pill"],
)
def test_a_sheet_on_the_shell_leaves_no_wall_below_it(shell):
    """Where the sheet lies on the lower half there is no liquid, and no layer takes anything."""
    plan, quads = disc_grid(1000)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    reach = np.minimum(np.linalg.norm(plan, axis=1), 1.0)
    r, z = shell.along(shell.arc_to(shell.poles[0]) * (1.0 - reach))
    points = np.column_stack([plan * (r / np.maximum(reach, 1e-12))[:, None], z])
    liquid = PotentialLiquid(
        triangles, len(points), shell=shell, degree=4, density=DENSITY, layer=1e-3
    )
    whole = liquid._shell_form[1:, 1:]
    left = liquid.layers(points, liquid.at(points))
    # The facets' area and places miss the shell's by h^2, with 20 cells from pole to rim.
    assert np.abs(left.form).max() < 0.02 * np.abs(whole).max()
    assert not left.wetted.any()
    above = np.column_stack([points[:, :2], -points[:, 2]])
    full = liquid.layers(above, liquid.at(above))
    assert full.wetted.all()


def test_drag_on_the_sheet_and_on_the_liquid_take_what_the_layers_take():
    """Power of the form = what the potential's decay and the drag on the nodes take together."""
    liquid, surface = half_full(5, viscosity=1e-4)
    shape, random = liquid.at(surface.reference), np.random.default_rng(1)
    layers = liquid.layers(surface.reference, shape)
    velocity = random.standard_normal((len(surface.reference), 3))
    potential = shape.potential(velocity)
    rate = layers.rate(velocity) - layers.carried(velocity)
    push = shape.force(-DENSITY * shape.values @ rate) + layers.force(potential, velocity)
    assert -np.vdot(push, velocity) == pytest.approx(layers.power(potential, velocity), rel=1e-10)
    rows = layers.rows(0.01).reshape(len(layers.decay), -1)
    implicit = rows.T @ (rows @ velocity.ravel())
    plain = shape.rows().reshape(len(layers.decay), -1)
    expected = plain.T @ (plain @ velocity.ravel())
    expected -= 0.01 * shape.force(-DENSITY * shape.values @ layers.rate(velocity)).ravel()
    assert np.abs(implicit - expected).max() < 1e-10 * np.abs(expected).max()
