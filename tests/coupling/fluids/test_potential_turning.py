"""A potential whose tank turns: in turned axes it is the same, and a sphere drives nothing."""

from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from cloth.flat import disc
from cloth.shell.sphere import Sphere
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.liquid import PotentialLiquid
from coupling.fluids.potential.step import PotentialStep
from coupling.fluids.potential.turning import TurnedHarmonics
from coupling.ports import Array, HydrostaticLoad, Turn
from coupling.scene.tank import Tank

R, STEP = 0.5, 0.01
RATE = 6.0  # rad/s


def test_harmonics_turn_among_themselves():
    """Values of the turned combination at turned points are those before, to rounding."""
    harmonics, random = SolidHarmonics(8, R), np.random.default_rng(3)
    coefficients = random.normal(size=len(harmonics.degrees))
    points = random.uniform(-R, R, (20, 3))
    matrix = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    turned = TurnedHarmonics(harmonics).turned(coefficients, matrix)
    before = harmonics.values(points) @ coefficients
    after = harmonics.values(points @ matrix.T) @ turned
    np.testing.assert_allclose(after, before, atol=1e-12 * np.abs(before).max())


class Surface:
    """A surface that moves by itself in axes that do not turn, given in those of the tank."""

    def __init__(self, *, turns: bool) -> None:
        self.mesh, self.turns = disc(R, 5, 20), turns
        self.reference, self.triangles = self.mesh.points, self.mesh.triangles
        self.converged, self._time = True, 0.0

    def attitude(self, time: float) -> Array:
        """About z, where the rim comes to lie on itself."""
        angle = 0.5 * RATE * time * time if self.turns else 0.0
        return Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()

    def turn(self, end: float) -> Turn | None:
        if not self.turns:
            return None
        now = self.attitude(end)
        last, before = (now.T @ self.attitude(max(end - k * STEP, 0.0)) for k in (1, 2))
        return Turn(
            attitude=now, last=last, before=before, rate=np.array([0.0, 0.0, RATE * end]),
            acceleration=np.array([0.0, 0.0, RATE]),
        )  # fmt: skip

    def _position(self, time: float) -> Array:
        points = self.reference.copy()
        reach = 1.0 - np.sum(points[:, :2] ** 2, axis=1) / R**2
        points[:, 2] = 0.1 * reach * points[:, 0] * (1.0 - np.cos(8.0 * time))
        return np.asarray(points @ self.attitude(time))

    @property
    def state(self) -> SimpleNamespace:
        """Where it starts."""
        return SimpleNamespace(position=self._position(0.0))

    def begin_step(self, dt: float, load: HydrostaticLoad, rows: Array) -> None:
        del load, rows
        self._end = self._time + dt

    def solve(self, force: Array) -> Array:
        del force
        return self._position(self._end)

    def accept_step(self) -> None:
        self._time = self._end


def forces(*, turns: bool) -> tuple[Array, Array]:
    """On the walls, in axes that do not turn (T, 3) [N], and kinetic energies (T,) [J]."""
    surface = Surface(turns=turns)
    liquid = PotentialLiquid(
        surface.triangles, len(surface.reference), shell=Sphere(R), degree=6, density=1000.0
    )
    step, found, energies = PotentialStep(surface, liquid), [], []
    for number in range(1, 16):
        end = number * STEP
        load = HydrostaticLoad(
            density=1000.0, body_force=np.array([0.0, 0.0, -9.81]), volume=1.0,
            turn=surface.turn(end),
        )  # fmt: skip
        assert step.attempt(end - STEP, STEP, load)
        step.accept()
        sample = step.report().sample
        found.append(surface.attitude(end) @ sample.wall_pressure_force)
        energies.append(sample.kinetic_energy)
    return np.array(found), np.array(energies)


def test_an_inviscid_liquid_does_not_feel_a_sphere_turn():
    """The same surface in a tank that turns and one that does not: the same force to rounding."""
    (still, energy), (turning, other) = forces(turns=False), forces(turns=True)
    assert np.abs(still[:, 0]).max() > 10.0
    np.testing.assert_allclose(turning, still, atol=1e-9 * np.abs(still).max())
    np.testing.assert_allclose(other, energy, rtol=1e-9)


def test_a_sphere_drives_nothing_as_it_turns():
    surface = Surface(turns=True)
    liquid = PotentialLiquid(
        surface.triangles, len(surface.reference), shell=Sphere(R), degree=6, density=1000.0
    )
    assert not liquid.ritz.spun.any()


def test_the_moment_on_a_pill_is_that_of_shell_and_sheet():
    """An even acceleration a of all the liquid: p* = -rho a.x, so that M = c x F, by Gauss.

    Where the sheet is a disc, a chord short of the rim: off by (2 pi/20)^2/6, 1.6 %.
    """
    tank = Tank(radius=R, shape="pill", cylinder_length=2.0 * R)
    shell, mesh = tank.shell, disc(R, 5, 20)
    liquid = PotentialLiquid(
        mesh.triangles, len(mesh.points), shell=shell, degree=4, density=1000.0
    )
    shape, acceleration = liquid.at(mesh.points), np.array([1.0, 0.5, 0.0])
    places = np.random.default_rng(5).uniform(-R, R, (60, 3))
    values = liquid.ritz.harmonics.values(places)
    rate = np.linalg.lstsq(values, places @ acceleration, rcond=None)[0]
    sample = liquid.sample(
        mesh.points, shape, rate, 0.0 * rate, work=0.0, energy=0.0, slip=0.0
    )  # fmt: skip
    volume = shell.volume_below(0.0)
    centre = np.array([0.0, 0.0, shell.moment_below(0.0) / volume])
    force = -1000.0 * volume * acceleration
    wanted = np.cross(centre, force)
    np.testing.assert_allclose(sample.wall_pressure_force, force, atol=1e-9 * np.abs(force).max())
    np.testing.assert_allclose(
        sample.wall_pressure_moment, wanted, atol=0.03 * np.abs(wanted).max()
    )
