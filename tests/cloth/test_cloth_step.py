"""One step can be repeated, a run continued, the statics and the kinematics are exact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from cloth.contact import slid
from cloth.kinematics import kinematics
from cloth.load import Settings, penalty_of
from cloth.material import Diaphragm, diaphragm
from cloth.mesh import Mesh, hemisphere
from cloth.settle import settle
from cloth.shell.sphere import Sphere
from cloth.step import Cloth

R = 0.4445
TANK = 4.0 / 3.0 * math.pi * R**3
WATER = 997.0
GRAVITY = np.array([0.0, 0.0, -9.81])
TAUT, SLACK = 3e5, 10.0  # N/m: 155 and 0.005 times rho g R^2


@dataclass(frozen=True)
class Water:
    volume: float | None
    body_force: np.ndarray
    datum: float | None = None
    recoil: None = None
    density: float = WATER
    turn: None = None


def build(rings: int, **options) -> Cloth:
    sheet = diaphragm("AF-E-332", 1.778e-3)
    options = {"tensile_stiffness": TAUT, "compressive_stiffness": SLACK} | options
    return Cloth(mesh=hemisphere(R, rings), diaphragm=sheet, shell=Sphere(R), **options)


def level(fill: float) -> float:
    return float(brentq(lambda h: 0.5 + 0.75 * h - 0.25 * h**3 - fill, -1.0, 1.0))


def liquid_moment(x: np.ndarray, mesh: Mesh) -> np.ndarray:
    p = x[mesh.triangles]
    cone = np.einsum("td,td->t", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
    moment = (cone[:, None] * p.sum(axis=1) / 4.0).sum(axis=0)
    return np.asarray(moment - np.array([0.0, 0.0, 0.25 * math.pi * R**4]))


def sway_acceleration(t: float, frequency: float = 1.25, amplitude: float = 0.25) -> float:
    """Second derivative of A sin(wt) under a quintic ramp of one period."""
    w, s = 2.0 * math.pi * frequency, min(t * frequency, 1.0)
    r = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    r1 = 30.0 * s**2 * (1.0 - s) ** 2 * frequency
    r2 = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * frequency**2
    sine, cosine = math.sin(w * t), math.cos(w * t)
    return amplitude * (r2 * sine + 2.0 * r1 * w * cosine - r * w * w * sine)


class PatchMass:
    """A stand-in for a flow: rho times a 1/(2 pi r) kernel between patches of nodes.

    A source of unit flux spread over a disc of area a sees itself as 8/(3 pi^2 radius).
    """

    def __init__(self, mesh: Mesh, patches: int) -> None:
        x = mesh.points
        centres = [0]
        distance = np.linalg.norm(x - x[0], axis=1)
        while len(centres) < patches:
            centres.append(int(distance.argmax()))
            distance = np.minimum(distance, np.linalg.norm(x - x[centres[-1]], axis=1))
        gaps = np.linalg.norm(x[:, None] - x[centres][None], axis=2)
        self.owner, self.count, self.mesh = gaps.argmin(axis=1), patches, mesh

    def rows(self, cloth: Cloth, x: np.ndarray) -> np.ndarray:
        gradient = cloth.model.volume_and_gradient(x)[1]
        wall = (x[:, 2] < 0.0) & (np.linalg.norm(x, axis=1) > 0.99 * R)
        on = np.flatnonzero(~wall & ~self.mesh.fixed)
        flux = np.zeros((self.count, *x.shape))
        flux[self.owner[on], on] = gradient[on]
        area = np.zeros(self.count)
        centre = np.zeros((self.count, 3))
        size = np.linalg.norm(gradient[on], axis=1)
        np.add.at(area, self.owner[on], size)
        np.add.at(centre, self.owner[on], size[:, None] * x[on])
        used = area > 0.0
        centre, area = centre[used] / area[used, None], area[used]
        r = np.linalg.norm(centre[:, None] - centre[None], axis=2)
        np.fill_diagonal(r, 3.0 * math.pi / 16.0 * np.sqrt(area / math.pi))
        values, vectors = np.linalg.eigh(1.0 / (2.0 * math.pi * r))
        scale = np.sqrt(WATER * np.maximum(values, 1e-3 * values.max()))
        return np.einsum("pk,p,kid->pid", vectors.T, scale, flux[used])


@pytest.fixture(scope="module")
def settled() -> dict[float, tuple[Cloth, dict[str, np.ndarray]]]:
    result = {}
    for fill in (0.5, 0.8):
        cloth = build(15)
        assert settle(cloth, Water(fill * TANK, GRAVITY)).converged
        result[fill] = (cloth, cloth.save())
    return result


def run(cloth: Cloth, steps: int, *, first: int = 0, dt: float = 0.005, patches: int = 0):
    """Pad sway; yields every committed state."""
    volume, zero = cloth.state.volume, np.zeros_like(cloth.reference)
    mass = PatchMass(cloth.model.mesh, patches) if patches else None
    for step in range(first, first + steps):
        push = np.array([sway_acceleration((step + 1) * dt), 0.0, 0.0])
        rows = mass.rows(cloth, cloth.state.position) if mass else None
        cloth.begin_step(dt, Water(volume, GRAVITY - push), rows)
        cloth.solve(zero)
        cloth.accept_step()
        yield cloth.state


def run_under(cloth: Cloth, load, steps: int, dt: float):
    """Steps of ``dt`` [s] under ``load(time)`` alone; yields every committed state."""
    zero = np.zeros_like(cloth.reference)
    for step in range(steps):
        cloth.begin_step(dt, load((step + 1) * dt))
        cloth.solve(zero)
        cloth.accept_step()
        yield cloth.state


@pytest.mark.parametrize("fill", [0.5, 0.8])
def test_static_level_gravity_centre_and_pressure(settled, fill):
    """Without bending: a level surface at R h, the rest on the shell, the spherical cap's CG.

    Bending rounds the contact corner and wrinkles the slack rim over the elasto-gravity length
    (kappa/(rho g))^(1/4) = 27 mm = 6 % R, and the datum carries the sheet's weight too. The
    tolerances come from measurement (15 rings: level within 0.1 % R, datum 0.4 % R), not theory.
    """
    cloth, saved = settled[fill]
    cloth.restore(saved)
    x, h = cloth.state.position, level(fill)
    off = np.linalg.norm(x, axis=1) < 0.995 * R
    assert x[off, 2].mean() / R == pytest.approx(h, abs=4e-3)
    centre = liquid_moment(x, cloth.model.mesh) / cloth.state.volume
    exact = -math.pi / 4.0 * (1.0 - h * h) ** 2 / (fill * 4.0 / 3.0 * math.pi) * R
    np.testing.assert_allclose(centre, [0.0, 0.0, exact], atol=4e-3 * R)
    head = cloth.state.datum_pressure / (WATER * 9.81)
    own = cloth.model.mass.sum() / (2.0 * math.pi * R**2) / WATER
    assert (head - own) / R == pytest.approx(h, abs=6e-3)
    assert cloth.state.volume == pytest.approx(fill * TANK, rel=1e-12)
    assert cloth.state.strain.max() <= 1e-3
    assert np.linalg.norm(x, axis=1).max() <= R * (1.0 + 1e-12)


@pytest.mark.parametrize(("fill", "patches"), [(0.5, 0), (0.8, 0), (0.5, 60), (0.8, 60)])
def test_rest_stays_rest(settled, fill, patches):
    cloth, saved = settled[fill]
    cloth.restore(saved)
    rows = None
    if patches:
        rows = PatchMass(cloth.model.mesh, patches).rows(cloth, cloth.state.position)
    zero, before = np.zeros_like(cloth.reference), cloth.state.position
    for _ in range(40):
        cloth.begin_step(0.005, Water(fill * TANK, GRAVITY), rows)
        cloth.solve(zero)
        cloth.accept_step()
        after = cloth.state.position
        assert np.abs(after - before).max() <= 1e-5 * R
        before = after


@pytest.mark.parametrize(("fill", "patches"), [(0.8, 0), (0.8, 60), (0.5, 60)])
def test_pad_sway_keeps_its_volume_and_stays_in_the_shell(fill, patches):
    cloth = build(10)
    assert settle(cloth, Water(fill * TANK, GRAVITY)).converged
    volume, swing = cloth.state.volume, []
    for state in run(cloth, 320, patches=patches):
        assert cloth.converged
        assert abs(state.volume / volume - 1.0) <= 1e-9
        assert np.linalg.norm(state.position, axis=1).max() <= R * (1.0 + 1e-12)
        swing.append(liquid_moment(state.position, cloth.model.mesh)[0] / volume)
    assert 0.02 < max(swing[160:]) / (1.0 if fill == 0.8 else 2.0) < 0.07  # see numerics: .04-.06


@pytest.mark.parametrize("patches", [0, 60])
def test_solve_repeats_bit_for_bit_and_is_continuous(settled, patches):
    """Equal forces give equal bits; force increments answer in proportion (Lipschitz).

    Halving a small increment halves the answer up to its curvature.
    """
    cloth, saved = settled[0.8]
    cloth.restore(saved)
    for _ in run(cloth, 60, patches=patches):
        pass
    committed = cloth.save()
    rows = None
    if patches:
        rows = PatchMass(cloth.model.mesh, patches).rows(cloth, cloth.state.position)
    cloth.begin_step(0.005, Water(0.8 * TANK, GRAVITY - [3.0, 0.0, 0.0]), rows)
    zero = np.zeros_like(cloth.reference)
    push = 1e-3 * cloth.model.volume_and_gradient(cloth.state.position)[1] * cloth.reference[:, :1]
    first = cloth.solve(zero)
    answers = [np.linalg.norm(cloth.solve(e * push) - first) / e for e in (1.0, 0.5, 0.25)]
    np.testing.assert_array_equal(cloth.solve(zero), first)
    assert answers[0] > 0.0
    np.testing.assert_allclose(answers, answers[0], rtol=0.05)
    for name, value in cloth.save().items():
        np.testing.assert_array_equal(value, committed[name])


@pytest.mark.parametrize("patches", [0, 60])
def test_restart_is_bitwise(settled, patches):
    cloth, saved = settled[0.8]
    cloth.restore(saved)
    for _ in run(cloth, 12, patches=patches):
        pass
    half = cloth.save()
    for _ in run(cloth, 12, first=12, patches=patches):
        pass
    whole = cloth.save()
    other = build(15)
    other.restore(half)
    for _ in run(other, 12, first=12, patches=patches):
        pass
    for name, value in other.save().items():
        np.testing.assert_array_equal(value, whole[name], err_msg=name)


@pytest.mark.parametrize(("rings", "fill"), [(8, 0.1), (8, 0.5), (6, 0.5), (6, 0.3)])
def test_settles_on_coarse_meshes(rings, fill):
    """Slack sheets creep: without extrapolation none of half fill settles in 1000 steps."""
    cloth = build(rings)
    load, zero = Water(fill * TANK, GRAVITY), np.zeros_like(cloth.reference)
    assert settle(cloth, load).converged
    for _ in range(20):
        before = cloth.state.position
        cloth.begin_step(0.005, load)
        cloth.solve(zero)
        cloth.accept_step()
        assert np.abs(cloth.state.position - before).max() <= 1e-5 * R


def test_restore_refuses_another_mesh():
    with pytest.raises(ValueError, match="resolution"):
        build(4).restore(build(5).save())


def test_kinematics_are_exact_for_parabolas():
    """BDF2's velocity is exact for x = t^2 on any two steps, Euler's for x = t."""
    one = np.ones((1, 3))
    for dt0, dt in ((0.1, 0.1), (0.1, 0.04)):
        kin = kinematics(dt, dt0, 0.0 * one, 0.0 * one, dt0**2 * one, -2.0 * dt0 * one)
        np.testing.assert_allclose(kin.velocity(dt**2 * one), 2.0 * dt, rtol=1e-12)
        if dt == dt0:
            assert kin.b == pytest.approx(2.0 * dt / 3.0)
        acceleration = (kin.velocity(dt**2 * one) - kin.velocity_anchor) / kin.b
        np.testing.assert_allclose(acceleration, 2.0, rtol=1e-12)
    start = kinematics(0.1, 0.0, one, 2.0 * one, 9.0 * one, 9.0 * one)
    np.testing.assert_allclose(start.velocity(1.2 * one), 2.0, rtol=1e-12)


@pytest.mark.parametrize(("dt0", "dt"), [(0.0, 0.1), (0.1, 0.1), (0.1, 0.04), (0.05, 0.1)])
def test_local_error_is_that_of_the_implicit_formula(dt0, dt):
    """x = t^3 (t^2 for Euler's first step), whose next velocity alone is known exactly."""
    power = 3 if dt0 else 2
    position, before = (np.full((1, 3), time**power) for time in (0.5, 0.5 - dt0))
    speed, speed_before = (
        np.full((1, 3), power * time ** (power - 1)) for time in (0.5, 0.5 - dt0)
    )
    kin = kinematics(dt, dt0, position, speed, before, speed_before)
    end = 0.5 + dt
    found = kin.position_anchor + kin.b * power * end ** (power - 1)
    wrong = np.linalg.norm(found - end**power)
    assert kin.local_error(found) == pytest.approx(wrong, rel=1e-9)


def test_momentum_balance_names_the_acceleration():
    """A free particle's limit: with no tension yet, a = b + force/m on a slack, unloaded sheet."""
    sheet = Diaphragm(density=1070.0, thickness=1.778e-3, youngs_modulus=0.0)
    cloth = Cloth(
        mesh=hemisphere(R, 6),
        diaphragm=sheet,
        shell=Sphere(R),
        compressive_stiffness=0.0,
        settings=Settings(iterations=4000, tolerance=0.0),
    )
    force = np.zeros_like(cloth.reference)
    force[0, 2] = -1e-4
    cloth.begin_step(1e-3, Water(None, np.zeros(3), datum=0.0))
    x = cloth.solve(force)
    still = cloth.solve(np.zeros_like(force))
    a = (x - cloth.inertial_prediction()) / cloth.acceleration_scale
    assert a[0, 2] == pytest.approx(-1e-4 / cloth.mass[0], rel=1e-4)
    np.testing.assert_allclose(still, cloth.reference, atol=1e-12)


def test_held_cloth_never_moves():
    cloth = build(6, held=True)
    zero = np.zeros_like(cloth.reference)
    for _ in range(3):
        cloth.begin_step(0.01, Water(TANK, np.array([3.0, 0.0, -9.81])))
        np.testing.assert_array_equal(cloth.solve(zero + 1.0), cloth.reference)
        cloth.accept_step()
    assert np.all(cloth.state.velocity == 0.0)


@pytest.mark.parametrize("datum", [None, 2e3])
@pytest.mark.parametrize("push", [math.inf, math.nan])
def test_divergence_is_raised_and_leaves_the_state(datum, push):
    cloth = build(4)
    committed = cloth.save()
    volume = None if datum is not None else cloth.state.volume
    cloth.begin_step(0.01, Water(volume, GRAVITY, datum=datum))
    force = np.zeros_like(cloth.reference)
    force[0] = push
    with pytest.raises(ArithmeticError, match=r"time step of 0\.01 s.*nodal forces"):
        cloth.solve(force)
    for name, value in cloth.save().items():
        np.testing.assert_array_equal(value, committed[name])


def test_given_datum_drifts_but_does_not_evert():
    """Pad sway with the thesis' fixed datum: the volume follows no constraint, yet stays near.

    Measured -4.3 to +6.9 % at 10, 16 and 24 rings and at 2, 5 and 10 ms; -1 to +8 % in the source.
    Everted it would be +25 %.
    """
    cloth = build(10, settings=Settings(bending_damping=0.3))
    settle(cloth, Water(0.8 * TANK, GRAVITY))
    zero, drift = np.zeros_like(cloth.reference), []
    for step in range(160):
        b = GRAVITY - np.array([sway_acceleration(0.01 * (step + 1)), 0.0, 0.0])
        datum = WATER * float(np.linalg.norm(b)) * level(0.8) * R
        cloth.begin_step(0.01, Water(None, b, datum=datum))
        cloth.solve(zero)
        cloth.accept_step()
        drift.append(cloth.state.volume / (0.8 * TANK) - 1.0)
    assert abs(drift[0]) <= 0.01
    assert -0.06 <= min(drift) < -0.02
    assert 0.02 < max(drift) <= 0.09


def test_load_needs_either_volume_or_datum():
    with pytest.raises(ValueError, match="either the volume or the datum"):
        build(3).begin_step(0.01, Water(None, GRAVITY))


def test_slip_counts_the_way_along_the_shell_of_pressed_nodes_only():
    """A quarter turn in small steps is a quarter of the circle; radial moves count nothing."""
    angle = np.linspace(0.0, 0.5 * math.pi, 91)
    way = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    total, on, shell = np.zeros(2), np.array([True, False]), Sphere(1.0)
    for start, end in pairwise(way):
        total += slid(np.stack([start, start]), np.stack([end, end]), on, shell)
    np.testing.assert_allclose(total, [0.5 * math.pi, 0.0], rtol=(math.pi / 180.0) ** 2 / 24.0)
    assert slid(way[:1], 0.9 * way[:1], on[:1], shell)[0] == pytest.approx(0.0, abs=1e-15)


def test_sway_rubs_the_shell_and_settling_does_not_count(settled):
    cloth, saved = settled[0.8]
    cloth.restore(saved)
    assert not cloth.state.shell_slip.any()
    slip = [state.shell_slip for state in run(cloth, 100)]
    assert np.all(np.diff([s.sum() for s in slip]) >= 0.0)
    assert 0.005 < slip[-1].max() < R
    assert not slip[-1][cloth.fixed].any()


def test_tension_carries_the_pressure():
    """An inextensible half ball under p = p0 alone pulls with p0 R/2 both ways, Laplace's law.

    The facets lie below the sphere by h^2: 1 % at 12 rings.
    """
    sheet = Diaphragm(density=1070.0, thickness=1e-3, youngs_modulus=0.0)
    cloth = Cloth(
        mesh=hemisphere(R, 12), diaphragm=sheet, tensile_stiffness=TAUT, compressive_stiffness=SLACK
    )
    settle(cloth, Water(None, np.zeros(3), datum=2000.0))
    inner = cloth.model.mesh.rim_distance[cloth.triangles].min(axis=1) > 0.2 * R
    assert np.median(cloth.state.tension[inner]) == pytest.approx(2000.0 * R / 2.0, rel=0.02)


@pytest.mark.parametrize(
    ("frequency", "amplitude", "dt"), [(25.0, 0.004, 0.002), (25.0, 0.25, 0.001)]
)
def test_hard_shaking_keeps_length_and_volume(settled, frequency, amplitude, dt):
    """10 g and 629 g: penalty and stiffness grow with the load."""
    largest = max(1.0, amplitude * (2.0 * math.pi * frequency) ** 2 / 9.81)
    cloth = build(15, tensile_stiffness=TAUT * largest, settings=Settings(iterations=2000))
    cloth.restore(settled[0.8][1])

    def load(time: float) -> Water:
        push = sway_acceleration(time, frequency, amplitude)
        return Water(0.8 * TANK, GRAVITY - np.array([push, 0.0, 0.0]))

    for state in run_under(cloth, load, 60, dt):
        assert cloth.converged
        assert np.isfinite(state.position).all()


def test_penalty_grows_with_the_load_in_few_steps():
    """In steps of sqrt(2), above rho b R^2 and never below the inertia."""
    penalties = set()
    for push in np.linspace(0.0, 6000.0, 200):
        load = Water(1.0, GRAVITY - np.array([push, 0.0, 0.0]))
        tension = WATER * float(np.linalg.norm(load.body_force)) * R**2
        penalty = penalty_of(load, size=R, inertia=2000.0)
        assert max(2000.0, tension) <= penalty < max(2000.1, 1.4143 * tension)
        penalties.add(penalty)
    assert len(penalties) <= 20  # of 200 loads, over a factor of 600
    assert penalty_of(Water(1.0, GRAVITY), size=R, inertia=5e4) == 5e4


@pytest.mark.parametrize("dt", [0.001, 0.002, 0.005, 0.01])
def test_rest_does_not_depend_on_the_step(settled, dt):
    """0.3 s at rest stays within 0.1 % R, rms; without the penalty's part for inertia 1 ms moves
    it by more. Single slack nodes at the crease tremble by 0.2 mm at 1 and 2 ms."""
    cloth, saved = settled[0.8]
    cloth.restore(saved)
    *_, last = run_under(cloth, lambda _: Water(0.8 * TANK, GRAVITY), round(0.3 / dt), dt)
    shift = np.linalg.norm(last.position - saved["position"], axis=1)
    assert np.sqrt(np.mean(shift**2)) <= 1e-3 * R


@pytest.mark.parametrize("stiffness", [None, 100.0 * WATER * 9.81 * R**2])
def test_a_dome_stretches_as_a_plane_stress_sheet(stiffness):
    """p R (1 - nu)/(2 E t), the mean of both principal strains away from the rim that holds it.
    A ``stiffness`` in place of the rubber's own acts in both directions alone.

    Of one triangle they differ as its facets do; the mean errs by (h/R)^2 at most, 1.7 %.
    """
    pressure = 200.0
    sheet = Diaphragm(density=1070.0, thickness=1.778e-3, youngs_modulus=8.6e6)
    cloth = Cloth(
        mesh=hemisphere(R, 12),
        diaphragm=sheet,
        tensile_stiffness=stiffness,
        settings=Settings(penalty=2e4),
    )
    assert settle(cloth, Water(None, np.zeros(3), datum=pressure)).converged
    top = cloth.model.mesh.rim_distance[cloth.triangles].min(axis=1) > 0.7 * R
    corner = cloth.state.position[cloth.triangles[top]]
    stretch = np.einsum("tid,tie->tde", corner, cloth.model.gradients[top])
    strain = np.linalg.svd(stretch, compute_uv=False) - 1.0
    exact = pressure * R * (1.0 - 0.5) / (2.0 * sheet.membrane_stiffness)
    if stiffness is not None:
        exact = pressure * R / (2.0 * stiffness)
    assert strain.mean() == pytest.approx(exact, rel=0.017)
