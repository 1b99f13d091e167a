"""The thesis' own diaphragm: read as it was written, and its errata shown as figures.

Its states are chaotic: a perturbation of 1e-9 m of the moulded nodes gave, over 17 runs, volumes
of 0.80 to 0.83 of the tank at 1 ms, 0.67 to 0.78 at 0.5 ms and 0.44 at 0.25 ms, where 0.8 was
filled in. The bounds below hold over that spread; what is repeatable is held bit for bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial import cKDTree

from cloth.material import Diaphragm
from cloth.shell.sphere import Sphere
from cloth.thesis import grid as grid_module
from cloth.thesis import kernels, reference
from cloth.thesis.constants import COLUMNS, OFFSETS, ROWS, STRETCHING, Constants, constants
from cloth.thesis.grid import ThesisGrid, thesis_grid
from cloth.thesis.sheet import ThesisSheet

R = 0.4445
TANK = 4.0 / 3.0 * math.pi * R**3
RUBBER = Diaphragm(density=1070.0, thickness=1.778e-3, youngs_modulus=8.6e6)  # Table 5
GRAVITY = np.array([0.0, 0.0, -9.81])
ROUNDING = 1e-11  # a few hundred operations on numbers of order one, in another order


@dataclass(frozen=True)
class Datum:
    """The thesis' liquid at a fill fraction, whatever the diaphragm makes of it."""

    fill: float
    body_force: np.ndarray
    density: float = 1000.0
    volume: float | None = None
    turn: None = None

    @property
    def datum(self) -> float:
        level = float(brentq(lambda h: 0.5 + 0.75 * h - 0.25 * h**3 - self.fill, -1.0, 1.0))
        return self.density * float(np.linalg.norm(self.body_force)) * level * R


def build(size: int = 26, **options) -> ThesisSheet:
    return ThesisSheet(grid=thesis_grid(R, size), diaphragm=RUBBER, shell=Sphere(R), **options)


def advance(sheet: ThesisSheet, seconds: float, load) -> ThesisSheet:
    sheet.begin_step(seconds, load)
    sheet.solve(np.zeros_like(sheet.reference))
    sheet.accept_step()
    return sheet


def at_rest(fill: float, step: float = 1e-3, size: int = 26) -> ThesisSheet:
    """One second from the moulded shape, what the thesis takes for rest."""
    return advance(build(size, step=step), 1.0, Datum(fill, GRAVITY))


@pytest.fixture(scope="module")
def rest() -> ThesisSheet:
    return at_rest(0.8)


@pytest.fixture(scope="module")
def fixed() -> Constants:
    return constants(thesis_grid(R, 8), RUBBER, radius=R, strain=0.01)


@pytest.fixture
def crumpled() -> np.ndarray:
    """Inner nodes off their moulded places by some per cent of a cell, some beyond the shell."""
    x = thesis_grid(R, 8).points.reshape(8, 8, 3).copy()
    x[1:-1, 1:-1] += 0.005 * np.random.default_rng(1).standard_normal((6, 6, 3))
    return x


def pair_strains(sheet: ThesisSheet) -> np.ndarray:
    """Of all pairs that the thesis keeps, its own measure."""
    size = sheet.constants.rest.shape[1]
    x = sheet.state.position.reshape(size, size, 3)
    found = []
    for k, (di, dj) in enumerate(OFFSETS[:STRETCHING]):
        first, second = reference._ends(x, di, dj)
        relaxed, _ = reference._ends(sheet.constants.rest[k], di, dj)
        found.append((np.linalg.norm(second - first, axis=-1) / relaxed - 1.0).ravel())
    return np.concatenate(found)


def roundness(position: np.ndarray, triangles: np.ndarray, height: float) -> float:
    """Largest over smallest distance of a horizontal cut's outline from the axis, by rays.

    NaN where a ray meets no outline.
    """
    corner = position[triangles]
    above = corner[:, :, 2] - height
    segments = []
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        alone = (above[:, a] * above[:, b] < 0.0) & (above[:, a] * above[:, c] < 0.0)
        p, h = corner[alone], above[alone]
        ends = [
            p[:, a] + (h[:, a] / (h[:, a] - h[:, o]))[:, None] * (p[:, o] - p[:, a]) for o in (b, c)
        ]
        segments.append(np.stack(ends, axis=1)[:, :, :2])
    ends = np.concatenate(segments)
    angle = 2.0 * np.pi * (np.arange(180) + 0.5) / 180
    across = ends @ np.stack([-np.sin(angle), np.cos(angle)])
    along = ends @ np.stack([np.cos(angle), np.sin(angle)])
    cut = across[:, 0] * across[:, 1] < 0.0
    share = across[:, 0] / np.where(cut, across[:, 0] - across[:, 1], 1.0)
    distance = along[:, 0] + share * (along[:, 1] - along[:, 0])
    outline = np.where(cut, distance, -1.0).max(axis=0, initial=-1.0)
    return float(outline.max() / outline.min()) if outline.min() > 0.0 else math.nan


# The compiled kernels against their definitions.


def test_geometry(crumpled):
    areas, normals = grid_module.node_areas(crumpled), reference.unit_normals(crumpled)
    np.testing.assert_allclose(kernels.node_areas(crumpled), areas, rtol=ROUNDING)
    np.testing.assert_allclose(kernels.unit_normals(crumpled), normals, atol=ROUNDING)


@pytest.mark.parametrize("k", range(len(OFFSETS)))
def test_relieve(crumpled, fixed, k):
    wanted, got = crumpled.copy(), crumpled.copy()
    arguments = (fixed.rest[k], fixed.back[k], fixed.forth[k], *OFFSETS[k])
    error = reference.relieve(wanted, *arguments)
    assert kernels.relieve(got, *arguments) == pytest.approx(error, rel=ROUNDING)
    np.testing.assert_allclose(got, wanted, atol=ROUNDING)
    assert error > 0.0


@pytest.mark.parametrize("offset", [(2, 0), (0, 2)])
def test_add_bending(crumpled, fixed, offset):
    normals = reference.unit_normals(crumpled)
    wanted, got = np.zeros((2, *crumpled.shape))
    for module, force in ((reference, wanted), (kernels, got)):
        module.add_bending(crumpled, normals, fixed.rest[4], 3.0, *offset, force)
    np.testing.assert_allclose(got, wanted, atol=ROUNDING * np.abs(wanted).max())
    assert np.abs(wanted).max() > 0.0


def test_put_inside(crumpled):
    wanted, got = crumpled.copy(), crumpled.copy()
    reference.put_inside(wanted, R)
    kernels.put_inside(got, R)
    np.testing.assert_allclose(got, wanted, atol=ROUNDING)
    assert not np.array_equal(wanted, crumpled)
    assert np.linalg.norm(wanted, axis=-1).max() < 1.001 * R * (1 + ROUNDING)


def test_advance(crumpled, fixed):
    load = (1000.0, np.array([300.0, 320.0]), np.array([[0.0, 0.0, -9.81], [2.0, 1.0, -9.81]]))
    force = 0.01 * np.random.default_rng(2).standard_normal(crumpled.shape)
    answers = []
    for module in (reference, kernels):
        x, v = crumpled.copy(), np.zeros_like(crumpled)
        error, sweeps = module.advance(x, v, fixed, *load, force, 1e-3, 3)
        answers.append((x, v, error, sweeps))
    for wanted, got in zip(*answers, strict=True):
        np.testing.assert_allclose(got, wanted, atol=1e3 * ROUNDING)  # three steps amplify it
    assert answers[0][3] >= 6  # two projections a step, one sweep each at least


# The grid.


def test_the_grid_has_its_rim_on_the_equator_and_faces_the_gas():
    grid = thesis_grid(R)
    assert grid.points.shape == (676, 3)
    np.testing.assert_allclose(np.linalg.norm(grid.points, axis=1), R, rtol=1e-14)
    assert grid.fixed.sum() == 100
    assert np.all(grid.points[grid.fixed, 2] == 0.0)
    assert np.all(grid.points[~grid.fixed, 2] < 0.0)
    corner = grid.points[grid.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert np.all(normal[:, 2] > 0.0)  # below the gas, everywhere
    edge = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)
    assert 0.02 < edge.min() < edge.max() < 0.1  # diagonals too
    # An empty tank: the triangles cut off less than h^2/8R of the radius, times 3/2 of the tank.
    assert 0.0 < build().state.volume / TANK < 1.5 * edge.max() ** 2 / (8 * R**2)


def test_erratum_10_the_thesis_has_its_rim_below_the_equator():
    grid = thesis_grid(1.0, repaired=False)
    rim = grid.points[grid.fixed, 2]
    assert (rim.min(), rim.max()) == pytest.approx((-0.0078, -0.0055), abs=5e-5)
    corner = grid.points[grid.triangles]
    cone = np.einsum("td,td->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6.0
    whole = thesis_grid(1.0)
    corner = whole.points[whole.triangles]
    repaired = np.einsum("td,td->", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])) / 6.0
    assert (cone - repaired) / (4.0 / 3.0 * np.pi) == pytest.approx(0.004, abs=0.0005)


def test_erratum_10_the_spiral_has_no_fourfold_symmetry():
    points = thesis_grid(1.0).points
    turned = points @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    distance, _ = cKDTree(points).query(turned)
    assert distance.max() > 0.05  # over half a cell; 0 with rings
    path = grid_module._spiral(26)
    assert len({(i, j) for i, j in path.tolist()}) == 676
    assert np.all(np.abs(np.diff(path, axis=0)).sum(axis=1) == 1)  # a walk from node to node


def test_erratum_10_odd_sizes_have_no_middle():
    with pytest.raises(ValueError, match=r"cloth\.resolution.*even.*got 25"):
        thesis_grid(R, 25)


# The errata of the algorithm.


def test_erratum_6_the_moulded_shape_is_bent_and_the_mirrored_one_is_not():
    sheet = build()
    c, x = sheet.constants, sheet.reference.reshape(26, 26, 3)
    pulls = {}
    for name, shape, order in (
        ("as written", x, (COLUMNS, ROWS)),
        ("unswapped", x, (ROWS, COLUMNS)),
        ("mirrored", x * [1.0, 1.0, -1.0], (ROWS, COLUMNS)),
    ):
        force = np.zeros_like(x)
        normals = reference.unit_normals(shape)
        for k, offset in zip(order, ((2, 0), (0, 2)), strict=True):
            reference.add_bending(shape, normals, c.rest[k], c.stiffness, *offset, force)
        pulls[name] = float(np.abs(force).max())
    weight = 9.81 * sheet.mass.max()
    assert pulls["as written"] > weight
    # sqrt of rounding in rest^2 - length^2, over rest: 1e-8 of the force that holds a full bend.
    assert pulls["unswapped"] < 1e-6 * weight
    assert pulls["mirrored"] < 1e-6 * weight


def test_erratum_7_the_allowed_strain_counts_pairs_that_wrap_round():
    rest = build().constants.rest[:STRETCHING]
    real = sum(reference._ends(rest[k], *OFFSETS[k])[0].sum() for k in range(STRETCHING))
    assert rest.sum() / real == pytest.approx(1.87, abs=0.01)


def test_errata_6_and_7_strains_of_tens_of_per_cent_at_rest(rest):
    pairs = pair_strains(rest)
    assert np.abs(pairs).mean() < 0.0187 * 1.05  # allowed; the contact after it adds a little
    assert np.abs(pairs).mean() > 0.01  # nearly all of what is allowed is used
    assert pairs.max() > 0.1
    assert rest.state.strain.max() > 0.1


def test_erratum_8_the_rest_state_depends_on_the_step(rest):
    volume = [rest.state.volume / TANK]
    volume += [at_rest(0.8, step).state.volume / TANK for step in (5e-4, 2.5e-4)]
    assert 0.79 < volume[0] < 0.85
    assert volume[0] - volume[1] > 0.02
    assert volume[1] - volume[2] > volume[0] - volume[1]  # it goes apart, not together


def test_erratum_8_the_sweeps_are_a_stiffness_of_one_over_dt():
    """A small force on one node, nothing but the bending sweeps against it: deflection over dt."""
    compliance = []
    for dt in (1e-3, 5e-4, 2.5e-4):
        sheet = build(14, strain=1e9)  # no projection
        c = sheet.constants._replace(stiffness=0.0)  # no bending force
        x = sheet.reference.reshape(14, 14, 3).copy()
        v, force, still = np.zeros_like(x), np.zeros_like(x), np.zeros((2, 3))
        force[7, 7, 2] = 0.01
        kernels.advance(x, v, c, 0.0, np.zeros(2), still, force, dt, round(0.5 / dt))
        compliance.append((x[7, 7, 2] - sheet.reference[7 * 14 + 7, 2]) / dt)
    assert compliance[1] / compliance[2] == pytest.approx(1.0, abs=0.05)  # 2 if it were 1/dt^2
    assert abs(compliance[1] / compliance[2] - 1.0) < abs(compliance[0] / compliance[1] - 1.0)


def test_erratum_8_a_coarse_grid_never_everts(rest):
    assert at_rest(0.8, size=10).state.volume < 0.2 * TANK
    assert rest.state.volume > 0.75 * TANK


def test_erratum_9_nodes_at_rest_have_metres_per_second(rest):
    saved = rest.save()
    speed = np.linalg.norm(saved["velocity"], axis=1)
    sheet = build()
    sheet.restore(saved)
    moved = advance(sheet, 1e-3, Datum(0.8, GRAVITY)).state.position - saved["position"]
    assert np.sqrt(np.mean(speed**2)) > 1.0
    assert np.sqrt(np.mean(np.sum(moved**2, axis=1))) / 1e-3 < 0.3 * np.sqrt(np.mean(speed**2))


def test_the_rounded_square(rest):
    """Section 5.3.2; a level surface in a round shell is cut in circles."""
    moulded = build()
    assert roundness(moulded.reference, moulded.triangles, -0.4 * R) < 1.02
    cuts = [roundness(rest.state.position, rest.triangles, h * R) for h in (0.3, 0.35, 0.4, 0.45)]
    cuts += [roundness(rest.state.position, rest.triangles, 0.5 * R)]
    assert np.nanmax(cuts) > 1.2  # 1.35 to 3.4 over the perturbed runs
    half = at_rest(0.5).state
    assert roundness(half.position, rest.triangles, 0.05 * R) > 1.1


def test_errata_4_and_7_volume_and_strain_in_pad_sway(rest):
    """1.25 Hz and 0.25 m from centre to peak, Table 5: three periods."""
    sheet, omega = build(), 2.0 * math.pi * 1.25
    sheet.restore(rest.save())
    volume, strain, mean = [], [], []
    for step in range(1, 481):
        shaking = 0.25 * omega**2 * math.sin(omega * 0.005 * step)  # less the tank's acceleration
        advance(sheet, 0.005, Datum(0.8, np.array([shaking, 0.0, -9.81])))
        pairs = pair_strains(sheet)
        volume.append(sheet.state.volume / (0.8 * TANK) - 1.0)
        strain.append(pairs.max())
        mean.append(np.abs(pairs).mean())
    assert 0.05 < max(volume) < 0.1
    assert -0.02 < min(volume) < 0.03
    assert max(strain) > 0.2
    assert 0.01 < np.mean(mean) < 0.0187 * 1.05


# One step as the driver uses it.


def test_a_step_is_repeatable_and_leaves_the_state_alone():
    sheet = advance(build(8), 0.05, Datum(0.5, GRAVITY))
    before = sheet.save()
    sheet.begin_step(0.005, Datum(0.5, np.array([3.0, 0.0, -9.81])))
    force = np.zeros_like(sheet.reference)
    first = sheet.solve(force)
    assert sheet.iterations >= 10  # five steps of two projections
    force[27, 2] = 5.0
    pushed = sheet.solve(force)
    assert pushed[27, 2] > first[27, 2]
    np.testing.assert_array_equal(sheet.solve(np.zeros_like(force)), first)
    for name, value in sheet.save().items():
        np.testing.assert_array_equal(value, before[name])
    sheet.accept_step()
    np.testing.assert_array_equal(sheet.state.position, first)


def test_a_restart_goes_on_bit_for_bit():
    def steps(sheet: ThesisSheet, first: int, last: int) -> None:
        for k in range(first, last):
            advance(sheet, 0.005, Datum(0.7, np.array([math.sin(k), 0.1 * k, -9.81])))

    straight, stopped, resumed = build(10), build(10), build(10)
    steps(straight, 0, 60)
    steps(stopped, 0, 30)
    resumed.restore(stopped.save())
    steps(resumed, 30, 60)
    for name, value in straight.save().items():
        np.testing.assert_array_equal(resumed.save()[name], value)


def test_a_step_is_made_of_the_thesis_own():
    load = Datum(0.5, GRAVITY)
    whole, parts = advance(build(8), 0.001, load), advance(build(8), 0.001, load)
    advance(whole, 0.005, load)
    for _ in range(5):
        advance(parts, 0.001, load)
    np.testing.assert_allclose(whole.state.position, parts.state.position, atol=1e3 * ROUNDING)


def test_held():
    sheet = build(8, held=True)
    advance(sheet, 0.01, Datum(0.8, GRAVITY))
    np.testing.assert_array_equal(sheet.state.position, sheet.reference)


def test_refuses_what_the_thesis_does_not_have():
    sheet = build(8)
    with pytest.raises(ValueError, match="no volume constraint"):
        sheet.begin_step(0.005, replace(Datum(0.5, GRAVITY), volume=0.1))
    with pytest.raises(ValueError, match="liquid inertia"):
        sheet.begin_step(0.005, Datum(0.5, GRAVITY), np.ones((1, 64, 3)))
    with pytest.raises(RuntimeError, match="begin_step comes first"):
        sheet.solve(np.zeros((64, 3)))
    with pytest.raises(ValueError, match="position needs shape"):
        sheet.restore(build(10).save())


def test_says_when_a_projection_finds_no_end():
    sheet = build(8, strain=0.0)
    sheet.begin_step(0.001, Datum(0.8, GRAVITY))
    with pytest.raises(ArithmeticError, match="after 5000 sweeps"):
        sheet.solve(np.zeros_like(sheet.reference))


def test_the_grid_is_of_one_piece():
    grid: ThesisGrid = thesis_grid(1.0, 4)
    assert set(grid.triangles.ravel().tolist()) == set(range(16))
    assert grid.fixed.sum() == 12
