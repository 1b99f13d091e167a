"""The rubber's loss: Kelvin and Voigt's solid, whatever the step, and only where it pulls."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest

from cloth import reference
from cloth.energy import stretch_energy
from cloth.flat import strip
from cloth.load import Settings
from cloth.material import Diaphragm
from cloth.step import Cloth
from cloth.viscous import plane_stress_energy, rubber_strain, triangle_strain

STIFFNESS, ETA, OMEGA = 8.6e6 * 0.002, 0.15, 10.0
TAU = ETA / OMEGA


@dataclass(frozen=True)
class Nothing:
    density: float = 0.0
    body_force: np.ndarray = field(default_factory=lambda: np.zeros(3))
    volume: float | None = None
    datum: float | None = 0.0
    turn: None = None
    recoil: None = None


SLACK = 1e-4 * STIFFNESS  # holds what does not pull in place


def pulled_strip(tau: float) -> Cloth:
    """Without Poisson's effect, so that its strain is the same everywhere; of hardly any mass."""
    rubber = Diaphragm(density=1e-3, thickness=0.002, youngs_modulus=8.6e6, poisson_ratio=0.0)
    settings = Settings(
        tolerance=1e-10, stretch_damping=tau, bending_damping=0.0, drag=0.0, penalty=3e4
    )
    return Cloth(
        mesh=strip(1.0, 0.5, 3), diaphragm=rubber, compressive_stiffness=SLACK, settings=settings
    )


def pull(cloth: Cloth, strain: float, dt: float, *, across: float = 0.0) -> None:
    """One step to ``strain`` of the whole, by its ends, and ``across``."""
    cloth.model.clamped = cloth.reference * [1.0 + strain, 1.0 + across, 1.0]
    cloth.begin_step(dt, Nothing())
    cloth.solve(np.zeros_like(cloth.reference))
    cloth.accept_step()


def a_period(steps: int) -> tuple[float, float]:
    """Loss by name, and area of the loop of tension over strain, over pi eta T a^2 A, both."""
    dt, mean, swing = 2.0 * np.pi / OMEGA / steps, 0.02, 0.01
    cloth = pulled_strip(TAU)
    lost = loop = tension = 0.0
    strains = mean + swing * np.sin(OMEGA * dt * np.arange(-steps, steps + 1))
    for k, strain in enumerate(strains):
        pull(cloth, strain, dt)
        before, tension = tension, float(cloth.state.tension.mean())
        if k > steps:
            lost += dt * cloth.losses().stretch
            loop += 0.5 * (before + tension) * (strain - strains[k - 1]) * cloth.model.areas.sum()
    whole = np.pi * ETA * STIFFNESS * swing**2 * cloth.model.areas.sum()
    return lost / whole, loop / whole


def test_harmonic_strain_loses_pi_eta_times_stiffness_and_amplitude_squared():
    """(sin x / x)^2 of it by the step's own rate, (sin 2x / 2x)^2 in the loop: x = omega dt / 2."""
    for steps in (16, 32, 64):
        x = np.pi / steps
        lost, loop = a_period(steps)
        assert lost == pytest.approx((np.sin(x) / x) ** 2, rel=1e-6)
        assert loop == pytest.approx((np.sin(2.0 * x) / (2.0 * x)) ** 2, rel=1e-6)


def test_released_rubber_creeps_back_in_its_own_time_and_does_not_push():
    """The strain of rubber that is let go falls as exp(-t/tau), (1 + dt/tau)^-n with Euler's rate;
    all its energy is lost, and it pulls again where it meets its triangles' strain."""
    cloth, dt, steps = pulled_strip(TAU), 0.2 * TAU, 5
    for _ in range(100):
        pull(cloth, 0.02, dt)
    held = cloth.energy().stretch
    assert held == pytest.approx(0.5 * STIFFNESS * 0.02**2 * cloth.model.areas.sum(), rel=1e-6)
    lost = 0.0
    for _ in range(steps):
        pull(cloth, 0.0, dt, across=-1e-4)
        lost += dt * cloth.losses().stretch
    left = 0.02 / 1.2**steps
    np.testing.assert_allclose(
        np.sum(cloth.save()["rubber_strain"][:, ::2], axis=1), left, rtol=1e-6
    )
    assert np.abs(cloth.save()["tension"]).max() < 2.0 * SLACK * left
    assert lost == pytest.approx(held - cloth.energy().stretch, rel=2e-4)  # SLACK's energy
    pull(cloth, left, 1e3 * TAU)
    assert cloth.state.tension == pytest.approx(STIFFNESS * left, rel=2e-3)


def test_no_loss_without_damping():
    cloth = pulled_strip(0.0)
    pull(cloth, 0.02, 0.01)
    pull(cloth, 0.0, 0.01)
    assert cloth.losses().stretch == 0.0
    assert cloth.energy().stretch == pytest.approx(0.0, abs=1e-12 * STIFFNESS)


def test_turning_a_stretched_sheet_loses_nothing_and_shearing_it_makes_no_torque():
    """The asked-for and the own deformation differ by a stress that turns no triangle:
    (y - z) z^T is symmetric, whatever the strain that it has relaxed to."""
    rng = np.random.default_rng(2)
    y = np.eye(3)[:, :2] + 0.1 * rng.standard_normal((50, 3, 2))
    rest = 0.05 * rng.standard_normal((50, 3))
    one = np.ones(50)
    z = reference.shifted(y, rest, 70.0 * one, 40.0 * one, 0.1 * one, 0.5)
    torque = np.einsum("tde,tfe->tdf", y - z, z)
    np.testing.assert_allclose(torque, torque.transpose(0, 2, 1), atol=1e-14)
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    turned = reference.shifted(turn @ y, rest, 70.0 * one, 40.0 * one, 0.1 * one, 0.5)
    np.testing.assert_allclose(turned, turn @ z, atol=1e-13)


@pytest.mark.parametrize("compressive", [0.0, 10.0, 1e9])
def test_step_is_the_least_of_energy_and_dissipation(compressive: float):
    """With rest and strain along the same axes: no stretch nearby has less of k/2 |z - y|^2 +
    W(m) + c C(m - m_n):(m - m_n)/2, m the rubber's own strain there."""
    c, k, nu = 0.8, 3000.0, 0.45
    full = compressive > STIFFNESS
    stiff = np.array([(1.0 + c) * STIFFNESS])
    soft = np.array([(1.0 + c) * compressive if full else compressive])
    for along, across in ((0.03, 0.02), (0.03, -0.05), (-0.02, -0.03)):
        before = np.array([[0.012, 0.0, 0.006]])
        rest = c / (1.0 + c) * before
        y = np.array([[[1.0 + along, 0.0], [0.0, 1.0 + across], [0.0, 0.0]]])
        z = reference.shifted(y, rest, np.array([k]), stiff, soft, nu)

        def total(e: float, f: float, y=y, rest=rest, before=before) -> float:
            strain = np.array([[e, 0.0, f]])
            own, _ = rubber_strain(strain, rest, stiff, soft, nu)
            rate = plane_stress_energy(own - before, c * stiff / (1.0 + c), nu)
            held = plane_stress_energy(own, stiff / (1.0 + c), nu)
            wrinkles = 0.0 if full else 0.5 * compressive * np.sum((strain - own) ** 2)
            distance = (1.0 + e - y[0, 0, 0]) ** 2 + (1.0 + f - y[0, 1, 1]) ** 2
            return float(held[0] + rate[0] + wrinkles + 0.5 * k * distance)

        e, f = z[0, 0, 0] - 1.0, z[0, 1, 1] - 1.0
        # What slack across adds to the stress along, K nu f beside T, is left out by ``limited``.
        best = total(e, f) - 0.5 * (min(compressive, 10.0) * nu * 0.06) ** 2 / (k + STIFFNESS)
        for angle in np.linspace(0.0, 2.0 * np.pi, 9):
            assert total(e + 1e-4 * np.cos(angle), f + 1e-4 * np.sin(angle)) > best


def test_strain_of_triangles_is_that_of_their_stretch_tensor():
    rubber = pulled_strip(0.0)
    rng = np.random.default_rng(3)
    x = rubber.reference + 0.05 * rng.standard_normal(rubber.reference.shape)
    found = triangle_strain(x, rubber.triangles, rubber.model.gradients)
    stretch = np.einsum("tid,tie->tde", x[rubber.triangles], rubber.model.gradients)
    _, sigma, right = np.linalg.svd(stretch, full_matrices=False)
    exact = right.transpose(0, 2, 1) * sigma[:, None, :] @ right - np.eye(2)
    np.testing.assert_allclose(found, exact[:, [0, 0, 1], [0, 1, 1]], atol=1e-12)
    assert stretch_energy(rubber.model, x) > 0.0
