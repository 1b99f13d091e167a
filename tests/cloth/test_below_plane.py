"""Samples of a shell below a plane: volumes, and fields without divergence."""

import math

import numpy as np
import pytest
from shells import pill, sphere_of_arcs

from cloth.shell.arc_spline import ellipse
from cloth.shell.below_plane import Plane, section_samples, volume_under, wetted_samples
from cloth.shell.meridian import Meridian
from cloth.shell.sphere import Sphere

SHELLS = {
    "sphere": Sphere(0.4),
    "arcs": sphere_of_arcs(0.4),
    "pill": pill(0.4, 0.4),
    "ellipsoid": Meridian(ellipse(0.4, 0.2)),
}
UPS = [(0, 0, 1), (0, 0, -1), (1, 0, 0), (-0.3, 0.5, -0.4), (0.6, 0, 0.8)]


@pytest.mark.parametrize("name", SHELLS)
@pytest.mark.parametrize("up", UPS)
def test_shell_and_plane_enclose_the_volume_below(name: str, up: tuple[float, ...]):
    """The divergence theorem for x and for 1, and for the gradient of a harmonic polynomial.

    To the 1e-7 that Gauss's rule leaves of the kink where a plane touches a circle.
    """
    shell, way = SHELLS[name], np.array(up, dtype=float)
    way /= np.linalg.norm(way)
    for fill in (0.05, 0.8):
        plane = Plane(up=way, level=shell.level_of(fill * shell.volume, way))
        points, area = wetted_samples(shell.profile, plane, 8)
        flat, size = section_samples(shell.profile, plane, 8)
        volume = (np.sum(points * area) + plane.level * size.sum()) / 3.0
        assert volume == pytest.approx(fill * shell.volume, rel=1e-7)
        np.testing.assert_allclose(area.sum(axis=0), -size.sum() * way, atol=1e-7 * size.sum())
        np.testing.assert_allclose(flat @ way, plane.level, atol=1e-14)
        flux = np.sum(saddle(points) * area) + (saddle(flat) @ way) @ size
        assert abs(flux) < 1e-7 * np.abs(saddle(points) * area).sum()


def saddle(x: np.ndarray) -> np.ndarray:
    """Gradient (n, 3) of the harmonic polynomial Re (x + i z)^8 + 1e-3 x y z."""
    power = 8.0 * (x[:, 0] + 1j * x[:, 2]) ** 7
    bilinear = np.stack([x[:, 1] * x[:, 2], x[:, 0] * x[:, 2], x[:, 0] * x[:, 1]], axis=1)
    return np.stack([power.real, 0.0 * power.real, -power.imag], axis=1) + 1e-3 * bilinear


def test_a_plane_through_a_sampled_place_of_a_piece_cuts_it():
    """The plane meets the cylinder where a search for crossings looks, exactly."""
    shell, way = pill(0.5, 1.0), np.array([math.sqrt(0.5), 0.0, math.sqrt(0.5)])
    points, area = wetted_samples(shell.profile, Plane(up=way, level=0.0), 4)
    assert np.sum(points * area) / 3.0 == pytest.approx(0.5 * shell.volume, rel=1e-7)
    assert shell.level_of(0.5 * shell.volume, way) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.1, 0.2, 0.9), (0.0, 1e-6, -1.0)])
def test_a_sphere_s_volume_below_any_plane_is_its_cap_s(way):
    """To the rounding of some hundred nodes; by the circles that the plane cuts."""
    up, profile = np.array(way) / np.linalg.norm(way), Sphere(0.4).profile
    for level in np.linspace(-0.4, 0.4, 17):
        cap = np.pi * (0.4 + level) ** 2 * (0.8 - level) / 3.0
        assert volume_under(profile, Plane(up=up, level=level)) == pytest.approx(cap, abs=1e-14)
