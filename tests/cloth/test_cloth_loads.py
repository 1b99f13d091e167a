"""Pressure is the gradient of what it works on; the mesh is what it says."""

from __future__ import annotations

import numpy as np
import pytest

from cloth import kernels
from cloth.material import ELASTOMERS, Diaphragm, diaphragm
from cloth.mesh import Mesh, border_nodes, hemisphere, lumped
from cloth.reference import pressure_step


def _pressure_integral(x: np.ndarray, mesh: Mesh, slope: np.ndarray) -> float:
    """Integral of slope . x over the cone from the origin, tetrahedron by tetrahedron."""
    p = x[mesh.triangles]
    volume = np.einsum("td,td->t", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
    return float(np.sum(volume * (p.sum(axis=1) @ slope) / 4.0))


def test_loads_are_gradients():
    """Virtual work: both integrals are polynomials of degree <= 4 in x, so that a Richardson
    step on central differences leaves rounding only: 1e-16 / 1e-3 relative."""
    mesh = hemisphere(1.0, 6)
    rng = np.random.default_rng(1)
    x = mesh.points + np.where(mesh.fixed[:, None], 0.0, 0.05 * rng.normal(size=mesh.points.shape))
    move = np.where(mesh.fixed[:, None], 0.0, rng.normal(size=x.shape))
    slope = np.array([200.0, 0.0, -9810.0])
    gradient, load = np.zeros((2, *x.shape))

    def volume(y: np.ndarray) -> float:
        unused = np.empty_like(y)
        return float(kernels.volume_and_gradient(y, mesh.triangles, ~mesh.fixed, unused))

    volume_of_x = kernels.volume_and_gradient(x, mesh.triangles, ~mesh.fixed, gradient)
    assert volume_of_x == pytest.approx(volume(x), rel=1e-15)
    pressure_step(x, mesh.triangles, 0.0, slope, load)  # the reference, which the kernels follow
    for energy, force in (
        (volume, gradient),
        (lambda y: _pressure_integral(y, mesh, slope), load),
    ):
        step = [(energy(x + h * move) - energy(x - h * move)) / (2.0 * h) for h in (1e-3, 2e-3)]
        wanted = (4.0 * step[0] - step[1]) / 3.0
        assert np.sum(force * move) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("rings", [2, 9, 18])
def test_hemisphere_is_a_disc_with_outward_normals(rings):
    mesh = hemisphere(2.0, rings)
    x, triangles = mesh.points, mesh.triangles
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert len(x) - len(np.unique(pairs, axis=0)) + len(triangles) == 1
    np.testing.assert_array_equal(border_nodes(triangles), np.flatnonzero(mesh.fixed))
    assert np.all(x[mesh.fixed, 2] == 0.0)
    np.testing.assert_allclose(np.linalg.norm(x, axis=1), 2.0, rtol=1e-14)
    p = x[triangles]
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    assert np.einsum("td,td->t", normal, p.mean(axis=1)).min() > 0.0
    np.testing.assert_allclose(mesh.rim_distance[0], np.pi)


def test_hemisphere_area_and_shape():
    """The polyhedron's area falls short by O(h^2); its triangles are near equilateral."""
    short = [1.0 - lumped(hemisphere(1.0, n)).sum() / (2.0 * np.pi) for n in (8, 16)]
    assert np.log2(short[0] / short[1]) == pytest.approx(2.0, abs=0.1)
    mesh = hemisphere(1.0, 18)
    p = mesh.points[mesh.triangles]
    length = np.linalg.norm(p - np.roll(p, 1, axis=1), axis=2)
    assert (length.max(axis=1) / length.min(axis=1)).max() < 1.6


def test_materials():
    sheet = diaphragm("AF-E-332", 1.778e-3)
    assert sheet.area_density == pytest.approx(1.90246)
    assert sheet.bending_stiffness == pytest.approx(8.6e6 * 1.778e-3**3 / 9.0)
    assert ELASTOMERS["SIFA-35"].youngs_modulus is None
    with pytest.raises(ValueError, match="youngs_modulus"):
        diaphragm("SIFA-35", 1e-3)
    with pytest.raises(ValueError, match="unknown elastomer"):
        diaphragm("rubber", 1e-3)
    with pytest.raises(ValueError, match="thickness"):
        Diaphragm(density=1000.0, thickness=0.0, youngs_modulus=1e6)
