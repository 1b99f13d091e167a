"""A free tank that also turns: rigid limits, the balance of moments, light tanks, going on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from test_free_tank import WATER, free

from coupling.fluids.potential.liquid import PotentialLiquid
from coupling.ports import Turn
from coupling.report.carrier_section import carrier_section
from coupling.report.files import read_run
from coupling.scene.scene import Scene
from coupling.simulation.driver import resume, run
from coupling.store.results import Results, read_results
from coupling.structure.diaphragm import diaphragm_of

MOMENT, PUSH, PUSHED = np.array([5.0, 3.0, 2.0]), 60.0, 0.2  # N m and N at the most, s
PILL = {"shape": "pill", "radius": 0.3, "cylinder_length": 0.4}


def blow(time: np.ndarray) -> np.ndarray:
    """Course of the push."""
    return np.where(time < PUSHED, np.sin(np.pi * time / PUSHED) ** 2, 0.0)


@pytest.fixture(scope="module")
def pushes(tmp_path_factory) -> str:
    """A blow along y, and a moment about all three axes."""
    time = np.linspace(0.0, 2.0, 401)
    none, size = np.zeros_like(time), blow(time)
    file = tmp_path_factory.mktemp("forces") / "push.csv"
    head = "time (s),fx (N),fy (N),fz (N),mx (N m),my (N m),mz (N m)"
    columns = [time, none, PUSH * size, none, *np.outer(MOMENT, size)]
    np.savetxt(file, np.transpose(columns), delimiter=",", header=head, comments="")
    return str(file)


INERTIA, RATES, SPRINGS = (
    np.array([4.0, 5.0, 6.0]),
    (300.0, 200.0, 100.0),
    (9000.0, 5000.0, 20000.0),
)
FORCED = {"mass": 40.0, "inertia": INERTIA.tolist(), "springs": list(SPRINGS)}


def spring_moment(ground: np.ndarray) -> np.ndarray:
    """Of the springs' energy, by its differences between small rotations of the ``ground``."""

    def energy(more: np.ndarray) -> float:
        turned = (Rotation.from_rotvec(more) * Rotation.from_matrix(ground)).as_rotvec()
        return 0.5 * float(np.array(RATES) @ turned**2)

    step = 1e-5
    return np.array([(energy(-step * e) - energy(step * e)) / (2.0 * step) for e in np.eye(3)])


def rigid_body(scene: Scene, points: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Rotation vectors (T, 3) [rad] of a tank whose diaphragm is held at ``points``, by fine steps.

    The liquid's angular momentum is J omega, T = omega.J omega/2 the kinetic energy that walls and
    diaphragm give an irrotational liquid by turning as one; its momentum is that of its centre.
    """
    cloth = diaphragm_of(scene)
    liquid = PotentialLiquid(
        cloth.triangles, len(points), shell=scene.tank.shell, degree=scene.potential.degree,
        density=WATER,
    )  # fmt: skip
    shape, apparent = liquid.at(points), np.empty((3, 3))
    axes = np.eye(3)
    turns = [
        Turn(attitude=axes, last=axes, before=axes, rate=axis, acceleration=np.zeros(3))
        for axis in axes
    ]
    sources = [shape.source(np.cross(turn.rate, points), turn) for turn in turns]
    apparent = WATER * np.array([[a @ shape.inverse @ shape.inverse.T @ b for a in sources]
                                 for b in sources])  # fmt: skip
    second = points.T @ (cloth.mass[:, None] * points)
    inertia = np.diag(INERTIA) + np.trace(second) * axes - second + apparent
    cone = np.einsum("tx,tx->t", points[cloth.triangles[:, 0]], shape.area) / 3.0
    volume = cone.sum() + scene.tank.shell.volume_below(0.0)
    weight = cloth.mass @ points
    weight = weight + WATER * cone @ points[cloth.triangles].sum(axis=1) / 4.0
    weight[2] += WATER * scene.tank.shell.moment_below(0.0)
    mass = FORCED["mass"] + cloth.mass.sum() + WATER * volume
    gravity, held = np.array(scene.gravity), -np.cross(weight, scene.gravity)

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        place, speed, omega = state[:3], state[3:6], state[6:9]
        ground = state[9:].reshape(3, 3)
        size = float(blow(np.array(time)))
        force = np.array([0.0, PUSH * size, 0.0]) - np.array(SPRINGS) * place
        moment = held + MOMENT * size + spring_moment(ground)
        # M a + R (alpha x Q + omega x (omega x Q)) = F, and of moments in the tank's axes
        # I alpha + omega x I omega = N + Q x R^T (g - a).
        lever = np.cross(weight, axes).T  # Q x
        spun = np.cross(omega, np.cross(omega, weight))
        matrix = np.block([[mass * axes, -ground @ lever], [lever @ ground.T, inertia]])
        right = np.concatenate([
            force - ground @ spun,
            ground.T @ moment + lever @ ground.T @ gravity - np.cross(omega, inertia @ omega),
        ])  # fmt: skip
        found = np.linalg.solve(matrix, right)
        spin = ground @ np.cross(omega, axes).T
        return np.concatenate([speed, found, spin.ravel()])

    start = np.concatenate([np.zeros(9), axes.ravel()])
    found = solve_ivp(rate, (0.0, times[-1]), start, t_eval=times, rtol=1e-9, atol=1e-12)
    return Rotation.from_matrix(found.y[9:].T.reshape(-1, 3, 3)).as_rotvec()


@pytest.mark.parametrize("tank", [{}, PILL])
def test_filled_and_held_it_is_a_rigid_body_with_its_liquid(tank, pushes, tmp_path):
    """Springs, a blow and moments about three axes, with the square of the step."""
    errors = []
    for steps in (50, 100):
        scene = free(
            model={"fluid": "potential"}, diaphragm={"held": True},
            liquid={"fill_fraction": 0.95, "viscosity": 1e-12},
            carrier=FORCED | {"rotational_springs": list(RATES), "force_file": pushes}, tank=tank,
            time={"duration": 0.6, "step": 1.0 / steps},
        )  # fmt: skip
        run(scene, tmp_path / str(steps))
        found = read_results(tmp_path / str(steps))
        exact = rigid_body(scene, found.position[0], found.time)
        errors.append(np.abs(found.tank_rotation - exact).max(axis=0) / np.abs(exact).max())
    assert errors[1].max() < 0.02
    assert np.log2(errors[0].max() / errors[1].max()) == pytest.approx(2.0, abs=0.35)


def unbalanced(scene: Scene, results: Results) -> float:
    """Rms moment that the tank's turn leaves over the one of its contents, by differences in time.

    The liquid's moment is that of its pressure on shell and sheet, which the step has not used.
    """
    time, sheet = results.time, diaphragm_of(scene).mass
    turned, step = Rotation.from_rotvec(results.tank_rotation), scene.time.step
    place = np.stack([turned[k].apply(points) for k, points in enumerate(results.position)])
    speed = np.gradient(place, step, axis=0)
    own = turned.apply(results.tank_rate * np.array(scene.carrier.inertia))
    spin = np.einsum("n,tnx->tx", sheet, np.cross(place, speed))
    hangs = np.einsum("n,tnx->tx", sheet, place)
    contents = turned.apply(results.moment) - np.gradient(spin, step, axis=0)
    contents = contents + np.cross(hangs, np.array(scene.gravity) - results.tank_acceleration)
    weight = hangs[0] + WATER * results.volume[0] * results.liquid_cg[0]
    given = np.outer(blow(time), MOMENT) - np.cross(weight, scene.gravity)
    left = np.gradient(own, step, axis=0) - given - contents
    inner = slice(5, -3)  # differences at the ends are one-sided
    return float(np.sqrt(np.mean(left[inner] ** 2) / np.mean(contents[inner] ** 2)))


@pytest.mark.parametrize("tank", [{}, PILL])
def test_moments_of_tank_and_contents_balance(tank, pushes, tmp_path):
    """Newton's law by what the run has written, off by the square of the step."""
    left, rest = [], []
    for steps in (50, 100):
        scene = free(
            model={"fluid": "potential"}, tank=tank,
            carrier={"mass": 20.0, "inertia": [1.0, 1.0, 1.0], "force_file": pushes},
            time={"duration": 0.6, "step": 1.0 / steps},
        )  # fmt: skip
        folder = tmp_path / str(steps)
        found = run(scene, folder)["carrier"]
        left.append(unbalanced(scene, read_results(folder)))
        rest.append(abs(found["rest_J"]) / found["work_J"])
    assert left[1] < 0.03
    assert left[0] / left[1] > 2.5  # 4 but for what the differences in time leave
    assert rest[1] < 0.01
    assert rest[0] / rest[1] > 3.5


@pytest.mark.parametrize("fluid", ["potential", "hydrostatic"])
def test_tank_of_hardly_any_inertia_is_not_shaken_by_its_sheet(fluid, pushes, tmp_path):
    """1e-4 kg m^2, where sheet and water have 0.3 and more: whole steps, momentum to rounding."""
    scene = free(
        model={"fluid": fluid}, time={"duration": 0.6},
        carrier={"mass": 20.0, "inertia": [1e-4] * 3, "force_file": pushes},
    )  # fmt: skip
    summary = run(scene, tmp_path / "run")
    assert summary["status"] == "completed"
    assert summary["halved_steps"] == 0
    assert summary["cloth"]["unconverged_steps"] == 0
    results = read_results(tmp_path / "run")
    assert 0.01 < np.abs(results.tank_rotation).max() < 0.5
    section = carrier_section(read_run(tmp_path / "run"))
    assert section is not None
    assert len(section.pictures) == 2
    assert "Largest rotation (°)" in [row[0] for table in section.tables for row in table.rows]
    sheet = diaphragm_of(scene).mass
    moment = np.einsum("n,tnx->tx", sheet, results.position)
    if fluid == "potential":  # the liquid of the other rests in the tank as far as it knows
        moment = moment + WATER * results.volume[:, None] * results.liquid_cg
    turned = Rotation.from_rotvec(results.tank_rotation)
    mass = scene.carrier.mass + sheet.sum() + WATER * scene.liquid_volume
    whole = mass * results.tank_displacement + turned.apply(moment)
    momentum = np.diff(whole, axis=0) / scene.time.step
    late = results.time[1:] > PUSHED + 26 * scene.time.step  # 3^-25 is 1e-12
    assert np.abs(momentum[late] - [0.0, 0.5 * PUSHED * PUSH, 0.0]).max() < 1e-9 * PUSH


def test_held_by_much_inertia_it_moves_as_a_tank_that_cannot_turn(pushes, tmp_path):
    """A million times its contents' inertia: what is left is the moment over that."""
    heavy, held = (
        free(
            model={"fluid": "potential"}, time={"duration": 0.2},
            carrier={"mass": 20.0, "force_file": file} | more,
        )
        for file, more in (
            (pushes, {"inertia": [1e7] * 3}), (forces_alone(pushes, tmp_path), {}),
        )
    )  # fmt: skip
    ends = []
    for number, scene in enumerate((heavy, held)):
        run(scene, tmp_path / str(number))
        ends.append(read_results(tmp_path / str(number)))
    assert np.abs(ends[0].tank_rotation).max() < 1e-6
    way = np.abs(ends[1].tank_displacement).max()
    assert np.abs(ends[0].tank_displacement - ends[1].tank_displacement).max() < 1e-4 * way


def forces_alone(pushes: str, folder: Path) -> str:
    """The table without its moments."""
    lines = [line.split(",")[:4] for line in Path(pushes).read_text().splitlines()]
    file = folder / "forces.csv"
    file.write_text("\n".join(",".join(line) for line in lines) + "\n")
    return str(file)


@pytest.mark.parametrize("inertia", [None, [1.0] * 3])
@pytest.mark.parametrize("fill", [0.6, 0.7])
def test_lying_it_rests(inertia, fill, tmp_path):
    """A light tank on its side, where pressures push most along what would change the volume."""
    held = {} if inertia is None else {"inertia": inertia}
    scene = free(
        model={"fluid": "potential"}, liquid={"fill_fraction": fill}, gravity=[9.81, 0.0, 0.0],
        carrier={"mass": 2.0} | held, time={"duration": 0.1, "settle_tolerance": 0.02},
    )  # fmt: skip
    summary = run(scene, tmp_path / "run")
    assert summary["status"] == "completed"
    found = read_results(tmp_path / "run")
    assert np.abs(found.tank_displacement).max() < 1e-4 * scene.tank.radius
    assert np.abs(found.tank_rotation).max() < 1e-4


def test_unequal_springs_keep_the_energy(tmp_path):
    """Far turned about three axes: what is left is the step's, and falls with its square."""
    time = np.linspace(0.0, 1.2, 241)
    size = np.where(time < 0.3, np.sin(np.pi * time / 0.3) ** 2, 0.0)
    file = tmp_path / "twist.csv"
    head = "time (s),fx (N),fy (N),fz (N),mx (N m),my (N m),mz (N m)"
    moments = np.outer(size, [60.0, 45.0, 30.0])
    columns = np.c_[time, np.zeros((len(time), 3)), moments]
    np.savetxt(file, columns, delimiter=",", header=head, comments="")
    left = []
    for steps in (100, 200):
        scene = free(
            model={"fluid": "hydrostatic"}, diaphragm={"held": True}, gravity=[0.0, 0.0, -1e-3],
            carrier={
                "mass": 20.0, "inertia": [3.0] * 3, "rotational_springs": [120.0, 60.0, 30.0],
                "force_file": str(file),
            },
            time={"duration": 1.0, "step": 1.0 / steps},
        )  # fmt: skip
        found = run(scene, tmp_path / str(steps))["carrier"]
        assert max(found["rotation_max_deg"]) > 25.0
        left.append(abs(found["rest_J"]) / found["work_J"])
    assert left[1] < 0.01
    assert left[0] / left[1] > 3.0


def test_half_a_turn_on_springs_ends_the_run(tmp_path):
    """Their rotation vector would point the other way; without springs it may turn as it likes."""
    file = tmp_path / "twist.csv"
    file.write_text("time (s),fx (N),fy (N),fz (N),mx (N m),my (N m),mz (N m)\n"
                    "0,0,0,0,0,0,40\n2,0,0,0,0,0,40\n")  # fmt: skip
    turned = []
    for springs in ([0.0] * 3, [0.0, 0.0, 1.0]):
        scene = free(
            model={"fluid": "hydrostatic"}, diaphragm={"held": True},
            carrier={
                "mass": 20.0, "inertia": [3.0] * 3, "rotational_springs": springs,
                "force_file": str(file),
            },
            time={"duration": 0.9},
        )  # fmt: skip
        folder = tmp_path / str(springs[2])
        summary = run(scene, folder)
        assert summary["status"] == ("failed" if any(springs) else "completed")
        assert not any(springs) or "turned by half a revolution" in summary["error"]
        turned.append(read_results(folder).steps.tank_rotation[:, 2])
    # 40 N m on less than 4 kg m^2: more than 4 rad, of which the rotation vector says 2 pi less.
    assert turned[0].min() < 0.0 < 2.8 < turned[0].max()
    assert 2.8 < turned[1].max() <= np.pi


def test_interrupted_it_goes_on_bit_for_bit(pushes, tmp_path):
    changes = {
        "model": {"fluid": "potential"},
        "carrier": {"mass": 20.0, "inertia": [0.5] * 3, "force_file": pushes},
    }
    ends = {"whole": 0.16, "first": 0.08}
    for name, duration in ends.items():
        run(free(**changes, time={"duration": duration}), tmp_path / name)
    resume(tmp_path / "first", scene=free(**changes, time={"duration": ends["whole"]}))
    one, other = (read_results(tmp_path / name) for name in ends)
    assert np.array_equal(one.tank_rotation, other.tank_rotation)
    assert np.array_equal(one.position, other.position)
    for name, values in one.steps.metrics.items():
        assert np.array_equal(values, other.steps.metrics[name], equal_nan=True), name
    assert np.abs(one.tank_rotation).max() > 1e-4
