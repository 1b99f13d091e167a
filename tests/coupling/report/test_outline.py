"""What pictures show of a shell: its outline and the level in it, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shells import pill

from cloth.shell.sphere import Sphere
from coupling.report.outline import SAMPLES, levels, outline

R = 0.4


def view(elevation: float) -> np.ndarray:
    return np.array([math.cos(elevation), 0.0, math.sin(elevation)])


def test_a_sphere_s_outline_is_a_circle_across_the_view():
    towards = view(math.radians(20.0))
    seen = outline(Sphere(R), towards)
    np.testing.assert_allclose(np.linalg.norm(seen, axis=1), R, rtol=1e-12)
    np.testing.assert_allclose(seen @ towards, 0.0, atol=1e-12)


def test_a_pill_s_outline_from_the_side_is_its_meridian():
    """From z = 0 all of it is at the azimuth across, as wide and high as the pill."""
    seen = outline(pill(R, 0.3), view(0.0))
    np.testing.assert_allclose(seen[:, 0], 0.0, atol=1e-12)
    assert np.ptp(seen[:, 1]) == pytest.approx(2.0 * R, rel=1e-12)
    assert np.ptp(seen[:, 2]) == pytest.approx(2.0 * (R + 0.3), rel=1e-12)


@pytest.mark.parametrize("fill", [0.2, 0.5, 0.8])
def test_levels_are_those_of_the_shell(fill: float):
    """Within a twentieth of the thickest slice, as thick as the meridian's steps."""
    for shell in (Sphere(R), pill(R, 0.3)):
        up = np.array([view(0.5 * math.pi), view(0.3), view(0.0), view(-1.2)])
        wanted = [shell.level_of(fill * shell.volume, one) for one in up]
        step = (shell.arc_to(shell.poles[1]) - shell.arc_to(shell.poles[0])) / (SAMPLES - 1)
        found = levels(shell, np.full(len(up), fill * shell.volume), up)
        np.testing.assert_allclose(found, wanted, atol=step / 20.0)
