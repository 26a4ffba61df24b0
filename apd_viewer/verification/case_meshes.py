"""Parametric meshes of the verification cases."""

import itertools

import numpy as np
from scipy.spatial import ConvexHull

Arrays = tuple[np.ndarray, np.ndarray]


def grid(rows: int, columns: int) -> Arrays:
    """Parameters (n, 2) from 0 to 1 and triangles of a grid, diagonals alternating.

    Vertex ``(i, j)`` has the number ``i * (columns + 1) + j``.
    """
    i, j = (k.ravel() for k in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    a = i * (columns + 1) + j
    b, c, d = a + columns + 1, a + columns + 2, a + 1
    even = np.hstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    odd = np.hstack([np.column_stack([a, b, d]), np.column_stack([b, c, d])])
    F = np.where(((i + j) % 2 == 0)[:, None], even, odd).reshape(-1, 3)
    u, v = np.meshgrid(np.linspace(0, 1, rows + 1), np.linspace(0, 1, columns + 1), indexing="ij")
    return np.column_stack([u.ravel(), v.ravel()]), F


def tube(around: int, height: float) -> Arrays:
    """Open tube of radius 1 about y, of nearly equilateral triangles.

    Ring ``j`` has the vertices ``j * around`` up to ``(j + 1) * around``.
    """
    rows = max(2, round(height / (np.sqrt(3.0) * np.pi / around)))
    j, i = (k.ravel() for k in np.meshgrid(np.arange(rows + 1), np.arange(around), indexing="ij"))
    angle = 2.0 * np.pi / around * (i + 0.5 * (j % 2))
    V = np.column_stack([np.cos(angle), height * j / rows, np.sin(angle)])
    j, i = (k.ravel() for k in np.meshgrid(np.arange(rows), np.arange(around), indexing="ij"))
    a, b = j * around + i, j * around + (i + 1) % around
    c, d = a + around, b + around
    even = np.hstack([np.column_stack([a, c, b]), np.column_stack([b, c, d])])
    odd = np.hstack([np.column_stack([a, c, d]), np.column_stack([a, d, b])])
    return V, np.where((j % 2 == 0)[:, None], even, odd).reshape(-1, 3)


def cube(cells: int) -> Arrays:
    """Closed cube [0, 1]^3 with ``cells`` along each edge."""
    uv, F = grid(cells, cells)
    sides = []
    for axis in range(3):
        for end in (0.0, 1.0):
            side = np.insert(uv, 0, end, axis=1)
            triangles = side[F] if end else side[F[:, ::-1]]
            sides.append(np.roll(triangles, axis, axis=2))
    return merged_triangles(np.concatenate(sides))


def disc(rings: int) -> Arrays:
    """Disc of radius 1 of six sectors; the last ``6 * rings`` vertices are its rim."""
    points, faces, inner = [np.zeros((1, 2))], [], np.zeros(1, dtype=int)
    for k in range(1, rings + 1):
        angle = 2.0 * np.pi * np.arange(6 * k) / (6 * k)
        outer = inner[-1] + 1 + np.arange(6 * k)
        points.append(k / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
        for sector in range(6):
            a = inner[(sector * (k - 1) + np.arange(k)) % len(inner)]
            b = outer[(sector * k + np.arange(k + 1)) % len(outer)]
            faces += [(a[i], b[i], b[i + 1]) for i in range(k)]
            faces += [(a[i], b[i + 1], a[i + 1]) for i in range(k - 1)]
        inner = outer
    return np.concatenate(points), np.array(faces)


def sewn_sheets(points: np.ndarray, F: np.ndarray, gap: float) -> Arrays:
    """Closed bag of two sheets (n, 2) with one boundary, a ``gap`` apart inside it.

    The vertices of the upper sheet come first, with the boundary among them.
    """
    edges, count = np.unique(
        np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1),
        axis=0,
        return_counts=True,
    )
    inside = np.setdiff1d(np.arange(len(points)), edges[count == 1])
    below = np.arange(len(points))
    below[inside] = len(points) + np.arange(len(inside))
    V = np.insert(np.concatenate([points, points[inside]]), 2, 0.0, axis=1)
    V[inside, 2], V[len(points) :, 2] = 0.5 * gap, -0.5 * gap
    return V, np.concatenate([F, below[F][:, ::-1]])


def lune(rings: int, sectors: int) -> Arrays:
    """Polar parameters (n, 2) and triangles of a closed lune, pole to pole.

    The first parameter is the latitude from -1 to 1, the second runs from 0 to 1 across. The number of
    triangles of a ring grows by ``sectors`` from either pole to the equator.
    """
    north = [np.array([[1.0, 0.5]])]
    north += [
        np.column_stack([np.full(sectors * k + 1, 1.0 - k / rings), np.linspace(0, 1, sectors * k + 1)])
        for k in range(1, rings + 1)
    ]
    triangles = []
    for inner, outer in itertools.pairwise(north):
        for sector in range(sectors):
            k = (len(outer) - 1) // sectors
            a = inner[sector * (k - 1) : (sector + 1) * (k - 1) + 1]
            b = outer[sector * k : (sector + 1) * k + 1]
            triangles += [(a[i], b[i], b[i + 1]) for i in range(k)]
            triangles += [(a[i], b[i + 1], a[i + 1]) for i in range(k - 1)]
    upper = np.array(triangles)
    lower = upper[:, ::-1] * [-1.0, 1.0]
    return merged_triangles(np.concatenate([upper, lower]))


def subdivided_triangles(corners: np.ndarray, cells: int) -> Arrays:
    """Triangles ``corners`` (t, 3, d), each subdivided into ``cells`` along its edges."""
    steps = [(i, j) for i in range(cells) for j in range(cells - i)]
    small = [((i, j), (i + 1, j), (i, j + 1)) for i, j in steps]
    small += [((i + 1, j), (i + 1, j + 1), (i, j + 1)) for i, j in steps if i + j < cells - 1]
    weights = np.insert(np.array(small) / cells, 0, 0.0, axis=2)
    weights[..., 0] = 1.0 - weights[..., 1:].sum(axis=2)
    return merged_triangles(np.einsum("scw,twd->tscd", weights, corners).reshape(-1, 3, corners.shape[2]))


def platonic_solid(faces: int, cells: int) -> Arrays:
    """Regular solid within the unit sphere, its faces fans of ``cells`` along an edge."""
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    oblong = np.array([[0.0, x, y * golden] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    icosahedron = np.concatenate([np.roll(oblong, k, axis=1) for k in range(3)])
    flatter = np.array([[0.0, x / golden, y * golden] for x in (-1.0, 1.0) for y in (-1.0, 1.0)])
    dodecahedron = np.concatenate([signs, *(np.roll(flatter, k, axis=1) for k in range(3))])
    tetrahedron = signs[signs.prod(axis=1) > 0.0]
    corners = {4: tetrahedron, 6: signs, 8: axes, 12: dodecahedron, 20: icosahedron}[faces]
    corners = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    hull = ConvexHull(corners)
    normals = np.unique(hull.equations.round(6), axis=0)
    triangles = []
    for *normal, offset in normals:
        face = corners[np.abs(corners @ normal + offset) < 1e-5]
        middle = face.mean(axis=0)
        x = face[0] - middle
        angle = np.arctan2((face - middle) @ np.cross(normal, x), (face - middle) @ x)
        around = face[np.argsort(angle)]
        triangles += [(middle, a, b) for a, b in zip(around, np.roll(around, -1, axis=0), strict=True)]
    return subdivided_triangles(np.array(triangles), cells)


def merged_triangles(triangles: np.ndarray) -> Arrays:
    """Vertices and faces of ``triangles`` (t, 3, d), with coincident corners merged."""
    points, faces = np.unique(triangles.reshape(-1, triangles.shape[2]).round(9), axis=0, return_inverse=True)
    return points + 0.0, faces.reshape(-1, 3)
