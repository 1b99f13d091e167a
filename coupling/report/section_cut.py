"""The diaphragm's cut with a plane through the tank's axis, as one curve."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Ints

_OFF_THE_NODES = 1.3e-7  # of the size: a plane through nodes would cut triangles in points


def cut(position: Array, triangles: Ints, direction: Array) -> list[Array]:
    """Return the curves in which a vertical plane through the tank's axis cuts a surface.

    The plane is moved aside by 1.3e-7 of the largest coordinate, so that it meets no node.

    Parameters
    ----------
    position
        Nodes of the surface (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3).
    direction
        Vector (3,) of any length whose horizontal part lies in the plane; x where it has none.

    Returns
    -------
    list of Array
        Curves (k, 2) [m]: distance along the direction, and height z. They follow the surface from
        rim to rim, from the smaller distance to the larger.
    """
    along = horizontal(direction)
    normal = np.array([-along[1], along[0], 0.0])
    size = float(np.abs(position).max(initial=1e-300))
    distance = position @ normal + _OFF_THE_NODES * size
    plan = np.stack([position @ along, position[:, 2]], axis=1)
    links: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for triangle in triangles[np.abs(np.sign(distance[triangles]).sum(axis=1)) < 3]:
        first, second = _crossed_edges(triangle, distance)
        links.setdefault(first, []).append(second)
        links.setdefault(second, []).append(first)
    return [_points(edges, plan, distance) for edges in _chains(links)]


def horizontal(direction: Array) -> Array:
    """Return the unit vector (3,) along ``direction``'s horizontal part; x where it has none."""
    flat = np.array([direction[0], direction[1], 0.0])
    length = float(np.linalg.norm(flat))
    return flat / length if length > 0.0 else np.array([1.0, 0.0, 0.0])


def _crossed_edges(triangle: Ints, distance: Array) -> list[tuple[int, int]]:
    pairs = ((0, 1), (1, 2), (2, 0))
    nodes = [(int(triangle[a]), int(triangle[b])) for a, b in pairs]
    return [(min(a, b), max(a, b)) for a, b in nodes if distance[a] * distance[b] < 0.0]


def _chains(links: dict[tuple[int, int], list[tuple[int, int]]]) -> list[list[tuple[int, int]]]:
    """Follow the links from their ends, then round what is left."""
    chains, visited = [], set()
    ends = [edge for edge, others in links.items() if len(others) == 1]
    for start in [*ends, *links]:
        if start in visited:
            continue
        chain, here = [start], start
        visited.add(start)
        while onward := [edge for edge in links[here] if edge not in visited]:
            here = onward[0]
            visited.add(here)
            chain.append(here)
        chains.append(chain)
    return chains


def _points(edges: list[tuple[int, int]], plan: Array, distance: Array) -> Array:
    a, b = np.array(edges).T
    share = (distance[a] / (distance[a] - distance[b]))[:, None]
    points: Array = plan[a] + share * (plan[b] - plan[a])
    return points if points[0, 0] <= points[-1, 0] else points[::-1]
