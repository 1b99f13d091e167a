"""Free-surface slosh in tanks that are no spheres, against finite elements of the tests' own."""

import numpy as np
import pytest
from quadratic_elements import axisymmetric, pill_reach, three_dimensional
from shells import pill, sphere_of_arcs

from cloth.shell.sphere import Sphere, level_of_fill_fraction
from coupling.estimate.sloshing_modes import lateral_eigenvalue
from coupling.estimate.tank_modes import depth, lowest_eigenvalue

Z, X = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


def test_the_elements_give_the_sphere_s_modes():
    """McIver, J. Fluid Mech. 201 (1989), to half of his last digit and the elements' error."""
    for level, printed in ((-0.4, 1.2625), (0.0, 1.560157), (0.4, 2.1232)):
        reach = pill_reach(0.0, level, lying=False)
        assert axisymmetric(reach, 16)[0] == pytest.approx(printed, rel=4e-5)
        assert three_dimensional(reach, 6, (True, False))[0] == pytest.approx(printed, rel=3e-4)


@pytest.mark.parametrize("fill", [0.02, 0.5, 0.8])
def test_the_lowest_mode_of_a_sphere_by_its_meridian(fill: float):
    """However it lies; the polynomials' error grows with the fill."""
    shell = sphere_of_arcs(0.4)
    exact = lateral_eigenvalue(level_of_fill_fraction(fill), 1)
    for up in (Z, X, np.array([1.0, -2.0, 0.3])):
        assert lowest_eigenvalue(shell, fill * shell.volume, up) == pytest.approx(exact, rel=1e-4)
        level = depth(shell, fill * shell.volume, up) / 0.4
        assert level == pytest.approx(level_of_fill_fraction(fill), abs=2e-6)
    assert lowest_eigenvalue(Sphere(0.4), fill * shell.volume, X) == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("fill", [0.3, 0.5, 0.8])
def test_the_lowest_mode_of_a_pill_upright_and_lying(fill: float):
    """f1 of a pill of 2:1 within 0.05 % of omega^2; the elements err by 1e-4 in three dimensions.

    Lying the lowest mode is that along the axis.
    """
    shell = pill(1.0, 1.0)
    upright = axisymmetric(pill_reach(1.0, shell.level_of(fill * shell.volume, Z), lying=False), 16)
    reach = pill_reach(1.0, shell.level_of(fill * shell.volume, X), lying=True)
    lying = three_dimensional(reach, 8, (True, False))
    across = three_dimensional(reach, 8, (False, True))
    assert lying[0] < across[0]
    assert lowest_eigenvalue(shell, fill * shell.volume, Z) == pytest.approx(upright[0], rel=1e-4)
    assert lowest_eigenvalue(shell, fill * shell.volume, X) == pytest.approx(lying[0], rel=5e-4)
