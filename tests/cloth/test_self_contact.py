"""A sheet never passes through itself, whatever motion is asked of it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from cloth.mesh import hemisphere
from cloth.self_contact import broad_phase, planes_reference, proximity, reference
from cloth.self_contact import pairs as contact_pairs
from cloth.self_contact import planes as contact_planes
from cloth.self_contact.crossing import crossing_kernel, crossing_pairs
from cloth.self_contact.features import Features
from cloth.self_contact.proximity import EDGES, VERTEX
from cloth.self_contact.resolve import SelfContact
from cloth.self_contact.zones import translated
from cloth.shell.shell import NO_SHELL
from cloth.shell.sphere import Sphere

H = 1.8e-3


def sheet(columns: int, rows: int, size: float = 0.02) -> tuple[np.ndarray, np.ndarray]:
    """A flat rectangle in z = 0 of squares of ``size``, each cut along one diagonal."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    node = np.arange(x.size).reshape(x.shape)
    a, b = node[:-1, :-1].ravel(), node[1:, :-1].ravel()
    c, d = node[1:, 1:].ravel(), node[:-1, 1:].ravel()
    points = size * np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    return points, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def two_sheets(gap: float) -> tuple[np.ndarray, np.ndarray]:
    """The second ``gap`` [m] above the first, shifted and turned so that no nodes face."""
    points, triangles = sheet(5, 5)
    angle = 0.3
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    upper = points.copy()
    upper[:, :2] = (points[:, :2] - 0.05) @ turn.T * 0.6 + 0.053
    upper[:, 2] += gap
    return np.concatenate([points, upper]), np.concatenate([triangles, triangles + len(points)])


def folded_strip(radius: float, length: int = 14) -> tuple[np.ndarray, np.ndarray]:
    """A strip bent round a half cylinder of ``radius`` [m], both ends straight and parallel."""
    points, triangles = sheet(length, 3, 0.01)
    s = points[:, 0] - 0.5 * points[:, 0].max()
    angle = np.clip(s / radius, -0.5 * np.pi, 0.5 * np.pi)
    rest = s - angle * radius
    x = radius * np.cos(angle) - np.abs(rest)
    return np.column_stack([x, points[:, 1], radius * np.sin(angle)]), triangles


def free_on_the_way(start: np.ndarray, end: np.ndarray, triangles: np.ndarray) -> bool:
    path = (start + t * (end - start) for t in np.linspace(0.0, 1.0, 21))
    return not any(len(crossing_pairs(x, triangles)) for x in path)


def contact(triangles: np.ndarray, inverse_mass: np.ndarray | float = 1.0) -> SelfContact:
    size = int(triangles.max()) + 1
    return SelfContact(triangles, np.broadcast_to(inverse_mass, size).copy(), H)


# Crossing triangles


TRIANGLE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def crosses(other: np.ndarray) -> bool:
    both = np.concatenate([TRIANGLE, other])
    return len(crossing_pairs(both, np.arange(6).reshape(2, 3))) == 1


def test_crossing_is_a_piercing_and_nothing_less():
    needle = np.array([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [3.0, 3.0, 1.0]])
    assert crosses(needle)
    assert crosses(needle[[2, 0, 1]])
    assert not crosses(np.add(needle, [0.0, 0.0, 1.0]))  # touches with its tip
    assert not crosses(np.add(needle, [0.0, 0.0, 1.1]))
    assert not crosses(np.add(needle, [0.7, 0.0, 0.0]))  # beside it
    assert not crosses(np.add(TRIANGLE, [0.1, 0.1, 0.0]))  # coplanar
    assert not crosses(np.add(TRIANGLE, [0.1, 0.1, 1e-9]))


def test_collapsed_triangles_pierce_but_are_not_pierced():
    line = np.array([[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [0.2, 0.2, 0.3]])
    assert crosses(line)
    assert not crosses(np.full((3, 3), 0.2))
    flat = np.array([[0.0, 0.5, -1e-3], [0.4, 0.5, -1e-3], [0.8, 0.5, -1e-3]])
    assert not crosses(flat)


def test_triangles_with_a_common_node_never_count():
    x = np.concatenate([TRIANGLE, [[0.3, 0.3, -1.0], [0.3, 0.3, 1.0]]])
    assert len(crossing_pairs(x, np.array([[0, 1, 2], [0, 3, 4]]))) == 0
    with pytest.raises(ValueError, match="finite"):
        crossing_pairs(np.full((3, 3), np.nan), np.array([[0, 1, 2]]))


@pytest.mark.parametrize("noise", [0.0, 0.06, 0.1])
def test_crossing_pairs_and_boxes_match_the_reference(noise):
    mesh = hemisphere(0.4, 6)
    x = mesh.points + noise * np.random.default_rng(1).standard_normal(mesh.points.shape)
    lower, upper = broad_phase.motion_boxes(x, x, mesh.triangles, 1e-3)
    np.testing.assert_array_equal(lower, x[mesh.triangles].min(axis=1) - 1e-3)
    np.testing.assert_array_equal(upper, x[mesh.triangles].max(axis=1) + 1e-3)
    found = np.sort(broad_phase.near_boxes(lower, upper), axis=1)
    found = found[np.lexsort((found[:, 1], found[:, 0]))]
    wanted = reference.near_boxes(lower, upper)
    np.testing.assert_array_equal(found, wanted)
    crossing = reference.crossing_kernel(x, mesh.triangles, wanted, 1e-14)
    np.testing.assert_array_equal(crossing_pairs(x, mesh.triangles), crossing)
    kernel = crossing_kernel(x, mesh.triangles, wanted, 1e-14)
    np.testing.assert_array_equal(kernel, crossing)
    assert (len(crossing) > 0) == (noise > 0.0)


def test_boxes_of_unlike_sizes_are_all_found():
    rng = np.random.default_rng(5)
    lower = rng.uniform(-1.0, 1.0, (200, 3))
    upper = lower + rng.exponential(0.1, (200, 3))
    upper[0] = 1.5
    found = np.sort(broad_phase.near_boxes(lower, upper), axis=1)
    found = found[np.lexsort((found[:, 1], found[:, 0]))]
    np.testing.assert_array_equal(found, reference.near_boxes(lower, upper))


# Pairs of primitives


@pytest.mark.parametrize("kind", [VERTEX, EDGES])
@pytest.mark.parametrize("shape", ["any", "flat", "collapsed", "parallel"])
def test_nearest_matches_bounded_least_squares(kind, shape):
    rng = np.random.default_rng(7)
    for _ in range(15):
        p = rng.standard_normal((4, 3))
        if shape == "flat":
            p[:, 2] = 0.0
        elif shape == "collapsed":
            p[3] = p[2]
        elif shape == "parallel":
            p[3] = p[2] + 0.7 * (p[1] - p[0])
        w, out = np.empty(4), np.empty(3)
        distance = proximity.nearest(kind, p, w, out)
        assert distance == pytest.approx(reference.nearest(kind, p)[0], abs=1e-6)
        np.testing.assert_allclose(w @ p, out, atol=1e-12)
        assert w[w > 0.0].sum() == pytest.approx(1.0)
        assert w.sum() == pytest.approx(0.0, abs=1e-12)
        q = p + rng.standard_normal((4, 3))
        assert proximity.approach(kind, p, q) == pytest.approx(reference.approach(kind, p, q))


@pytest.mark.parametrize("kind", [VERTEX, EDGES])
def test_meeting_comes_before_any_touch(kind):
    """Sampled on the way the distance never falls below a tenth of what the step stops at."""
    rng = np.random.default_rng(8)
    w, here, out = np.empty(4), np.empty((4, 3)), np.empty(3)
    met = 0
    for _ in range(12):
        p, q = rng.standard_normal((2, 4, 3))
        stop = 0.1 * min(reference.nearest(kind, p)[0], 0.3)
        time, distance = proximity.meeting(kind, p, q, stop, w, here, out)
        met += distance <= stop
        assert distance > 0.0
        least = reference.meeting_distance(kind, p, p + time * (q - p), 40)
        assert least >= min(distance, stop) * 0.1 * (1.0 - 1e-6)
    assert 0 < met < 12


def test_meeting_time_of_a_head_on_pair():
    p = np.array([[0.2, 0.2, 1.0], *TRIANGLE])
    q = p.copy()
    q[0, 2] = -1.0
    room = np.empty(4), np.empty((4, 3)), np.empty(3)
    time, distance = proximity.meeting(VERTEX, p, q, 0.01, *room)
    assert 0.495 <= time < 0.5
    assert distance == pytest.approx(2.0 * (0.5 - time))
    together = proximity.meeting(VERTEX, p, np.add(p, [5.0, 0.0, -9.0]), 0.01, *room)
    assert together == pytest.approx((1.0, 1.0), rel=1e-14)


def test_candidates_match_the_reference():
    mesh = hemisphere(0.2, 4)
    rng = np.random.default_rng(9)
    x = mesh.points
    y = x + 0.03 * rng.standard_normal(x.shape)
    lower, upper = broad_phase.motion_boxes(x, y, mesh.triangles, 2e-3)
    near = broad_phase.near_boxes(lower, upper)
    args = (x, y, lower + upper, mesh.triangles, near, 4e-3)
    facing = contact_pairs.approaching_kernel(*args)
    np.testing.assert_array_equal(facing, reference.approaching_kernel(*args))
    pairs = Features(mesh.triangles).pairs(facing)
    assert len(np.unique(pairs, axis=0)) == len(pairs) > 0
    pairs = pairs[:: max(1, len(pairs) // 60)]
    answers = []
    for module in (reference, contact_pairs):
        gaps, kept = np.empty(len(pairs)), np.empty(len(pairs), dtype=np.bool_)
        module.candidate_kernel(x, y, pairs, 4e-3, gaps, kept)
        answers.append((gaps, kept))
    np.testing.assert_allclose(answers[1][0], answers[0][0], atol=1e-8)
    np.testing.assert_array_equal(answers[1][1], answers[0][1])
    assert 0 < answers[1][1].sum() < len(pairs)


# Steps


def test_nothing_near_is_left_alone():
    """A fast common motion, a turn and a stretch: no pair of primitives is looked at further."""
    mesh = hemisphere(0.4445, 12)
    x = mesh.points
    guard = contact(mesh.triangles)
    y = x + [0.03, -0.02, 0.01] + 0.05 * x[:, [1, 2, 0]] * [1.0, -1.0, 1.0]
    assert len(guard.candidates(x, y, guard.approaching(x, y))[0]) == 0
    result = guard.resolve(x, y)
    np.testing.assert_array_equal(result.position, y)
    assert len(result.pairs) == 0
    assert not result.near.any()
    assert result.moved == 0.0


@pytest.mark.parametrize("speed", [0.004, 0.05])
def test_a_falling_sheet_lands_on_another(speed):
    """Momentum is kept, the gap is the thickness up to the tolerated tenth, slip is measured."""
    x, triangles = two_sheets(3e-3)
    upper = np.arange(len(x)) >= len(x) // 2
    y = x + np.where(upper[:, None], [1e-3, 0.0, -speed], 0.0)
    guard = contact(triangles)
    result = guard.resolve(x, y)
    assert y[upper, 2].max() < 0.0
    assert free_on_the_way(x, result.position, triangles)
    assert result.gap.min() >= 0.89 * H
    np.testing.assert_allclose(result.position.sum(axis=0), y.sum(axis=0), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(result.normal, axis=1), 1.0)
    slip = result.node_slip()
    if speed < 0.01:  # a hard push along normals that are not quite vertical slides more
        assert np.median(slip[slip > 0.0]) == pytest.approx(1e-3, rel=0.2)
    assert np.all(slip[~result.near] == 0.0)


def test_a_fixed_sheet_holds_what_falls_on_it():
    x, triangles = two_sheets(3e-3)
    upper = np.arange(len(x)) >= len(x) // 2
    guard = contact(triangles, np.where(upper, 1.0, 0.0))
    for _ in range(5):
        y = x - np.where(upper[:, None], [0.0, 0.0, 0.02], 0.0)
        result = guard.resolve(x, y)
        assert free_on_the_way(x, result.position, triangles)
        np.testing.assert_array_equal(result.position[~upper], y[~upper])
        assert result.gap.min() >= 0.5 * H
        x = result.position


def test_a_fold_pressed_together_stays_open():
    x, triangles = folded_strip(0.008)
    guard, thickest = contact(triangles), x[:, 2].copy()
    for _ in range(8):
        y = x.copy()
        y[:, 2] -= 0.6 * thickest
        result = guard.resolve(x, y)
        assert free_on_the_way(x, result.position, triangles)
        assert not result.held.any()
        x = result.position
    assert len(result.pairs) > 0
    assert result.gap.min() >= 0.3 * H


@pytest.mark.parametrize("height", [1e-5, 2e-3, 0.05])
def test_a_vertex_does_not_pass_a_triangle(height):
    tip = np.array([[0.25, 0.25, 0.0], [0.3, 0.25, 1.0], [0.25, 0.3, 1.0]])
    x = np.concatenate([TRIANGLE, np.add(tip, [0.0, 0.0, height])])
    y = x + np.array([[0.0] * 3] * 3 + [[0.0, 0.0, -0.1]] * 3)
    triangles = np.arange(6).reshape(2, 3)
    result = contact(triangles).resolve(x, y)
    assert len(crossing_pairs(y, triangles)) == 1
    assert free_on_the_way(x, result.position, triangles)
    wanted = min(H, height + 0.05 * H)
    assert result.gap.min() >= 0.89 * wanted
    assert result.pairs[result.gap.argmin(), 0] == VERTEX


def test_an_edge_does_not_pass_an_edge():
    x = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.1, -1.0],
                  [0.0, -1.0, 0.01], [0.0, 1.0, 0.01], [0.1, 0.0, 1.0]])  # fmt: skip
    y = x + np.array([[0.0, 0.0, 0.0]] * 3 + [[0.0, 0.0, -0.05]] * 3)
    triangles = np.arange(6).reshape(2, 3)
    result = contact(triangles).resolve(x, y)
    assert len(crossing_pairs(y, triangles)) == 1
    assert free_on_the_way(x, result.position, triangles)
    assert result.pairs[result.gap.argmin(), 0] == EDGES
    assert result.gap.min() >= 0.89 * H


def crumpling(x, fixed, rng, size):
    waves = rng.normal(size=(3, 3)) * rng.choice([5.0, 20.0])
    push = np.sin(x @ waves + rng.normal(size=3)) + 0.3 * rng.normal(size=x.shape)
    return np.where(fixed[:, None], x, x + size * push)


@settings(max_examples=12, deadline=None, derandomize=True)
@given(st.integers(0, 2**31), st.sampled_from([0.003, 0.02, 0.06]))
def test_random_motions_never_end_in_a_crossing(seed, size):
    """Within the shell too, the rim fixed; several steps, each from where the last one ended."""
    mesh, rng = hemisphere(0.2, 5), np.random.default_rng(seed)
    guard = contact(mesh.triangles, np.where(mesh.fixed, 0.0, 1.0))
    x, shell = mesh.points, Sphere(0.2)
    for _ in range(4):
        y = crumpling(x, mesh.fixed, rng, size)
        y *= np.minimum(1.0, 0.2 / np.linalg.norm(y, axis=1))[:, None]
        result = guard.resolve(x, y, shell)
        assert free_on_the_way(x, result.position, mesh.triangles)
        assert np.linalg.norm(result.position, axis=1).max() <= 0.2 * (1.0 + 1e-12)
        np.testing.assert_array_equal(result.position[mesh.fixed], x[mesh.fixed])
        assert len(result.failed) == 0
        x = result.position


@pytest.mark.parametrize("zones", [4, 0])
@pytest.mark.parametrize("held", [12, 0])
def test_the_fail_safe_alone_keeps_everything_free(monkeypatch, caplog, zones, held):
    """Without any pushing: zones, then held nodes, then the whole sheet, and it is said."""
    monkeypatch.setattr("cloth.self_contact.resolve.ROUNDS", 0)
    monkeypatch.setattr("cloth.self_contact.resolve.ZONES", zones)
    monkeypatch.setattr("cloth.self_contact.resolve.HELD", held)
    mesh, rng = hemisphere(0.2, 5), np.random.default_rng(3)
    guard = contact(mesh.triangles, np.where(mesh.fixed, 0.0, 1.0))
    x, used = mesh.points, np.zeros(3, dtype=int)
    for _ in range(8):
        result = guard.resolve(x, crumpling(x, mesh.fixed, rng, 0.02))
        assert free_on_the_way(x, result.position, mesh.triangles)
        used += [result.rigid.any(), result.held.any(), result.held.all()]
        x = result.position
    assert (used[0] > 0) == (zones > 0)
    assert (used[1] > 0) == (zones == 0)
    assert used[2] == (used[1] if held == 0 else 0)
    assert sum("left where" in r.message for r in caplog.records) == used[1]


def test_zones_move_as_one_and_stay_within():
    rng = np.random.default_rng(4)
    x = 0.3 * rng.standard_normal((6, 3))
    y = x + rng.standard_normal((6, 3))
    shell, zones = Sphere(float(np.linalg.norm(x, axis=1).max()) + 0.1), np.arange(6)
    mass = np.array([1.0, 2.0, 1.0, 1.0, 1.0, 1.0])
    inverse = np.append(1.0 / mass[:5], 0.0)
    result = translated(x, y, np.array([[0, 1, 1, 0], [4, 5, 4, 5]]), zones, inverse, shell)
    np.testing.assert_array_equal(zones, [0, 0, 2, 3, 4, 4])
    np.testing.assert_array_equal(result[2:4], y[2:4])
    np.testing.assert_array_equal(result[4:], x[4:])
    shift = result[:2] - x[:2]
    np.testing.assert_allclose(shift[0], shift[1])
    centre = mass[:2] @ (y - x)[:2] / 3.0
    np.testing.assert_allclose(np.cross(shift[0], centre), 0.0, atol=1e-12)
    assert np.linalg.norm(result[:2], axis=1).max() <= shell.radius * (1.0 + 1e-12)


def test_what_crossed_before_is_named_and_let_through():
    x = np.concatenate([TRIANGLE, [[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [3.0, 3.0, 1.0]]])
    y = x + np.array([[0.0] * 3] * 3 + [[0.0, 0.0, 1.5]] * 3)
    guard = contact(np.arange(6).reshape(2, 3))
    result = guard.resolve(x, y)
    np.testing.assert_array_equal(result.failed, [[0, 1]])
    np.testing.assert_array_equal(result.position, y)
    with pytest.raises(ValueError, match="finite"):
        guard.resolve(x, np.full_like(x, np.nan))


def test_a_hopeless_motion_is_refused(caplog):
    """Everything through one point: the sheet stays, and it is said."""
    mesh = hemisphere(0.2, 8)
    result = contact(mesh.triangles).resolve(mesh.points, -mesh.points[::-1])
    np.testing.assert_array_equal(result.position, mesh.points)
    assert result.held.all()
    assert "left where" in caplog.text


def test_a_crossing_is_named_without_any_motion():
    needle = np.array([[0.3, 0.3, -1.0], [0.3, 0.3, 1.0], [3.0, 3.0, 1.0]])
    x = np.concatenate([TRIANGLE, needle])
    result = contact(np.arange(6).reshape(2, 3)).resolve(x, x)
    np.testing.assert_array_equal(result.failed, [[0, 1]])
    assert len(result.pairs) == 0


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_planes_match_the_reference_and_hold_their_gaps(friction: float):
    x, triangles = two_sheets(2e-3)
    upper = np.arange(len(x)) >= len(x) // 2
    result = contact(triangles).resolve(x, x - np.where(upper[:, None], [0.0, 0.0, 2e-3], 0.0))
    planes = result.planes
    assert len(planes.nodes) > 0
    start = result.position - np.where(upper[:, None], [0.0, 0.0, 1e-3], 0.0)
    inverse, shell = np.ones(len(x)), Sphere(1.0)
    weight = np.where(np.arange(len(x)) % 7 > 0, 3.0, 0.0)
    before = x + np.where(upper[:, None], [1e-4, 3e-4, 0.0], 0.0)
    answers = []
    for module, shape in ((planes_reference, shell.radius), (contact_planes, shell.profile)):
        z, u, rhs = start.copy(), np.zeros_like(start), np.zeros_like(start)
        rub, pressing = np.ones_like(start), np.ones((len(start), 2))
        module.plane_step(
            planes.nodes, planes.weights, planes.normal, planes.rest,
            inverse, shape, weight, contact_planes.SWEEPS, friction, before, z, u, rub,
            pressing, rhs,
        )  # fmt: skip
        answers.append((z, u, rhs, rub, pressing))
    for wanted, got in zip(*answers, strict=True):
        np.testing.assert_allclose(got, wanted, atol=1e-14)
    assert np.any(answers[1][3]) == (friction > 0.0)
    z = answers[1][0].copy()
    for _ in range(30):
        u, rub, rhs = np.zeros((3, *z.shape))
        planes.step(inverse, shell.profile, weight, friction, before, z, u, rub, pressing, rhs)
    gap = np.einsum("ki,kid,kd->k", planes.weights, z[planes.nodes], planes.normal)
    assert np.min(gap - planes.rest) >= -1e-5


def random_planes(rng: np.random.Generator, count: int, nodes: int) -> contact_planes.Planes:
    """Of ``count`` nodes against three others each, which share many of ``nodes``."""
    normal = rng.standard_normal((count, 3))
    weights = rng.dirichlet(np.ones(3), count)
    return contact_planes.Planes(
        nodes=np.array([rng.permutation(nodes)[:4] for _ in range(count)]),
        weights=np.column_stack([np.ones(count), -weights]),
        normal=normal / np.linalg.norm(normal, axis=1)[:, None],
        rest=rng.uniform(0.0, 0.2, count),
    )


@pytest.mark.parametrize("radius", [np.inf, 1.0])
def test_planes_project_on_the_nearest_point_of_all_of_them(radius: float):
    """In the masses' metric, and of the ball as well, as a general solver finds it.

    Sweeps end at 1e-4 of the first push; the solver's own tolerance is far below.
    """
    rng = np.random.default_rng(8)
    nodes = 7
    planes, mass = random_planes(rng, 6, nodes), rng.uniform(0.5, 2.0, nodes)
    wanted = rng.standard_normal((nodes, 3))
    wanted *= 0.7 / np.linalg.norm(wanted, axis=1)[:, None]
    wanted[:3] *= 2.0  # beyond the ball
    rows = np.zeros((6, nodes, 3))
    for k in range(6):
        rows[k, planes.nodes[k]] = planes.weights[k][:, None] * planes.normal[k]
    flat = rows.reshape(6, -1)
    bounds = [{"type": "ineq", "fun": lambda x: flat @ x - planes.rest, "jac": lambda _: flat}]
    if np.isfinite(radius):
        bounds += [
            {"type": "ineq", "fun": lambda x: radius**2 - np.sum(x.reshape(-1, 3) ** 2, axis=1)}
        ]
    exact = minimize(
        lambda x: 0.5 * np.repeat(mass, 3) @ (x - wanted.ravel()) ** 2,
        np.zeros(3 * nodes), jac=lambda x: np.repeat(mass, 3) * (x - wanted.ravel()),
        constraints=bounds, method="SLSQP", options={"ftol": 1e-14, "maxiter": 500},
    )  # fmt: skip
    assert exact.success
    size = np.linalg.norm(wanted, axis=1)[:, None]
    z = wanted * np.minimum(1.0, radius / size)
    u, rhs, rub = wanted - z, np.zeros_like(z), np.zeros_like(z)
    pushed = (planes.rest - flat @ z.ravel()).max()
    shell = Sphere(radius) if np.isfinite(radius) else NO_SHELL
    planes.step(1.0 / mass, shell.profile, 3.0 * mass, 0.0, z, z, u, rub, np.zeros((nodes, 2)), rhs)
    assert pushed > 0.1
    np.testing.assert_allclose(z.ravel(), exact.x, atol=20.0 * contact_planes.PRECISION * pushed)
    np.testing.assert_allclose(z + u, wanted, atol=1e-14)


def test_planes_part_what_would_have_passed():
    """Two sheets that change sides in a step end far apart, and touch nothing."""
    x, triangles = two_sheets(6e-3)
    upper = np.arange(len(x)) >= len(x) // 2
    end = x - np.where(upper[:, None], [0.0, 0.0, 40e-3], 0.0)
    result = contact(triangles).resolve(x, end)
    planes = result.planes
    for at, kept in ((end, False), (result.position, True)):
        gap = np.einsum("ki,kid,kd->k", planes.weights, at[planes.nodes], planes.normal)
        assert np.all(gap - planes.rest >= -1e-12) == kept
    assert np.isin(np.flatnonzero(upper), planes.nodes).all()


def test_planes_join_those_of_other_pairs():
    rng = np.random.default_rng(9)
    first, second = random_planes(rng, 4, 9), random_planes(rng, 3, 9)
    newer = contact_planes.Planes(
        nodes=np.concatenate([second.nodes, first.nodes[:1]]),
        weights=np.concatenate([second.weights, first.weights[:1]]),
        normal=np.concatenate([second.normal, -first.normal[:1]]),
        rest=np.concatenate([second.rest, first.rest[:1]]),
    )
    joined = newer.joined(first)
    np.testing.assert_array_equal(joined.nodes, np.concatenate([newer.nodes, first.nodes[1:]]))
    np.testing.assert_array_equal(joined.normal, np.concatenate([newer.normal, first.normal[1:]]))
