"""Makes a scan of a run's settled diaphragm, of which every figure is known.

    python foam_cases/steady_shapes/made_scan.py RUN FILE [--seed 0]

Points all over the sheet, evenly by area, with a scanner's noise and holes, moved by 5 mm and
turned by 3 degrees in directions that the seed draws; a PLY in millimetres.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
from scipy.spatial.transform import Rotation

from coupling import read_results
from coupling.ports import Array, Ints

NOISE = 0.8e-3  # m, of each coordinate: what the source found of its scanner
SHIFT, TURN = 5e-3, 3.0  # m and degrees
HOLES, HOLE = 4, 0.06  # their number, and their radius [m]
POINTS = 6000  # before holes


@dataclass(frozen=True, kw_only=True)
class MadeScan:
    """Points (p, 3) [m] of a scan, and the motion x -> R x + t that takes it back."""

    points: Array
    rotation: Array
    shift: Array


def made_scan(
    nodes: Array,
    triangles: Ints,
    seed: int,
    *,
    number: int = POINTS,
    noise: float = NOISE,
    holes: int = HOLES,
    axis: Array | None = None,
) -> MadeScan:
    """Return a scan of the sheet with ``nodes`` (n, 3) [m] and ``triangles`` (m, 3).

    ``axis`` (3,): that of the turn, drawn if not given.
    """
    random = np.random.default_rng(seed)
    points = _spread(nodes, triangles, number, random)
    for centre in points[random.choice(number, holes, replace=False)]:
        points = points[np.linalg.norm(points - centre, axis=1) > HOLE]
    points = points + noise * random.standard_normal(points.shape)
    way, about = (_unit(random.standard_normal(3)) for _ in range(2))
    about = about if axis is None else _unit(axis)
    turn = Rotation.from_rotvec(np.radians(TURN) * about).as_matrix()
    shift = SHIFT * way
    return MadeScan(points=points @ turn.T + shift, rotation=turn.T, shift=-turn.T @ shift)


def _spread(nodes: Array, triangles: Ints, number: int, random: np.random.Generator) -> Array:
    """Points (number, 3) all over the triangles, evenly by area."""
    corner = nodes[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(normal, axis=1)
    chosen = random.choice(len(triangles), number, p=area / area.sum())
    shares = random.dirichlet(np.ones(3), number)  # even over a triangle
    return np.asarray(np.einsum("pk,pkd->pd", shares, corner[chosen]))


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def main() -> None:
    """Write the scan that is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("file", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    results = read_results(asked.run)
    scan = made_scan(results.position[0], results.triangles, asked.seed)
    meshio.Mesh(1e3 * scan.points, []).write(asked.file, file_format="ply")
    print(f"{asked.file}: {len(scan.points)} points in mm")


if __name__ == "__main__":
    main()
