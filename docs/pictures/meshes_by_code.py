"""Meshes made in code: an animal, a scan, a can, a sheet, and one that is not clean."""

from __future__ import annotations

import numpy as np
import pyvista as pv

Arrays = tuple[np.ndarray, np.ndarray]

# Ends and radii of the limbs of an animal that looks along +x and stands on y = 0, in centimetres.
_LIMBS = (
    ((-9.0, 16.0, 0.0), (8.0, 17.0, 0.0), 5.0, 4.6),  # trunk
    ((9.0, 18.0, 0.0), (15.0, 26.0, 0.0), 3.2, 2.4),  # neck
    ((14.0, 27.5, 0.0), (18.0, 27.0, 0.0), 3.1, 2.7),  # head
    ((18.0, 26.6, 0.0), (22.5, 25.0, 0.0), 2.2, 1.7),  # muzzle
    *(((13.2, 29.6, 2.2 * side), (11.6, 33.2, 3.4 * side), 1.0, 0.7) for side in (-1, 1)),  # ears
    *(((7.5, 14.0, 2.9 * side), (8.0, 7.0, 3.2 * side), 2.3, 1.6) for side in (-1, 1)),  # fore legs
    *(((8.0, 7.0, 3.2 * side), (8.2, 1.7, 3.2 * side), 1.6, 1.5) for side in (-1, 1)),
    *(((-9.5, 14.0, 2.9 * side), (-9.0, 7.5, 3.3 * side), 2.8, 1.7) for side in (-1, 1)),  # hind legs
    *(((-9.0, 7.5, 3.3 * side), (-9.8, 1.7, 3.3 * side), 1.7, 1.5) for side in (-1, 1)),
    ((-13.0, 18.0, 0.0), (-19.0, 24.0, 0.0), 1.3, 0.8),  # tail
)


def animal(step: float = 0.55) -> Arrays:
    """Closed body on four legs; ``step`` is about the length of its edges, cm."""
    low, high = np.array([-23.0, -2.0, -9.0]), np.array([27.0, 37.0, 9.0])
    grid = pv.ImageData(
        dimensions=np.ceil((high - low) / step).astype(int) + 1, spacing=(step,) * 3, origin=low
    )
    points, near = np.asarray(grid.points), 0.0
    for start, end, first, last in _LIMBS:
        a, way = np.array(start), np.subtract(end, start)
        t = np.clip((points - a) @ way / (way @ way), 0.0, 1.0)
        distance = np.linalg.norm(points - a - t[:, None] * way, axis=1) - (first + (last - first) * t)
        near = near + np.exp(-1.6 * distance)
    grid["outside"] = -np.log(np.maximum(near, 1e-300)) / 1.6
    surface = grid.contour([0.0], scalars="outside").clean().smooth_taubin(n_iter=30, pass_band=0.08)
    V, F = np.array(surface.points, dtype=float), np.array(surface.regular_faces)[:, ::-1]
    V[:, 1] -= V[:, 1].min()
    return _outward(V, F)


def ball(count: int, radius: float = 1.0) -> Arrays:
    """Sphere with about ``count`` vertices, evenly spread."""
    n = max(1, round(np.sqrt((count - 2) / 10)))
    surface = _icosphere(n)
    V, F = np.array(surface.points, dtype=float), np.array(surface.regular_faces)
    V *= radius / np.linalg.norm(V, axis=1, keepdims=True)
    return _outward(V, F)


def _icosphere(n: int) -> pv.PolyData:
    """Each triangle of an icosahedron divided into n by n."""
    base = pv.Icosahedron()
    V, F = np.array(base.points, dtype=float), np.array(base.regular_faces)
    i, j = np.array([(i, j) for i in range(n + 1) for j in range(n + 1 - i)]).T
    weights = np.column_stack([i, j, n - i - j]) / n
    place = {(a, b): k for k, (a, b) in enumerate(zip(i.tolist(), j.tolist(), strict=True))}
    small = [(place[a, b], place[a + 1, b], place[a, b + 1]) for a, b in place if a + b < n]
    small += [(place[a + 1, b], place[a + 1, b + 1], place[a, b + 1]) for a, b in place if a + b < n - 1]
    points = np.concatenate([weights @ V[face] for face in F])
    faces = np.concatenate([np.array(small) + k * len(weights) for k in range(len(F))])
    return pv.PolyData.from_regular_faces(points, faces).clean(tolerance=1e-6)


def scan(count: int = 6000) -> Arrays:
    """A stone as a scanner sees it: bumpy, noisy, open below and with holes; centimetres."""
    V, F = ball(count)
    chance = np.random.default_rng(7)
    size = np.ones(len(V))
    for _ in range(14):
        at = chance.normal(size=3)
        size += chance.uniform(-0.10, 0.14) * np.exp(-6.0 * ((V - at / np.linalg.norm(at)) ** 2).sum(axis=1))
    size += chance.normal(scale=0.004, size=len(V))
    X = 6.0 * V * size[:, None] * [0.85, 1.35, 0.8]
    middle = V[F].mean(axis=1)
    holes = np.array([[0.0, -1.0, 0.0], [0.75, 0.1, 0.65], [-0.6, 0.45, 0.66], [0.2, -0.35, 0.92]])
    holes /= np.linalg.norm(holes, axis=1, keepdims=True)
    kept = (middle @ holes.T < [0.9, 0.985, 0.992, 0.994]).all(axis=1)
    ids, G = np.unique(F[kept], return_inverse=True)
    X = X[ids]
    X[:, 1] -= X[:, 1].min()
    return X, G.reshape(-1, 3)


def can(around: int = 64, along: int = 44, radius: float = 3.3, height: float = 11.5) -> Arrays:
    """Closed can with a bead around its waist, about +y; centimetres."""
    inner = np.linspace(0.0, 1.0, max(3, around // 6) + 1)[1:-1]
    heights = np.linspace(0.0, height, along)
    bulge = 1.0 - 0.03 * np.exp(-(((heights - height / 2) / (0.07 * height)) ** 2))
    rings = [(radius * r, 0.0) for r in inner] + list(zip(radius * bulge, heights, strict=True))
    rings += [(radius * r, height) for r in inner[::-1]]
    k = np.arange(around)
    V = [
        np.column_stack([r * np.cos(t), np.full(around, y), -r * np.sin(t)])
        for number, (r, y) in enumerate(rings)
        for t in [2 * np.pi / around * (k + 0.5 * (number % 2))]
    ]
    points = np.vstack([*V, [[0.0, 0.0, 0.0], [0.0, height, 0.0]]])
    F = [np.column_stack([np.full(around, len(points) - 2), (k + 1) % around, k])]
    for number in range(len(rings) - 1):
        a, b = number * around + k, number * around + (k + 1) % around
        c, d = a + around, b + around
        F += (
            [np.column_stack([a, b, c]), np.column_stack([b, d, c])]
            if number % 2 == 0
            else [np.column_stack([a, d, c]), np.column_stack([a, b, d])]
        )
    last = (len(rings) - 1) * around
    F += [np.column_stack([np.full(around, len(points) - 1), last + k, last + (k + 1) % around])]
    return _outward(points, np.vstack(F))


def sheet(count: int = 50, size: float = 20.0) -> Arrays:
    """Flat square in y = 0, of triangles that are nearly equilateral; centimetres."""
    rows = round(count / (np.sqrt(3) / 2))
    x, y = np.meshgrid(np.arange(count + 1), np.arange(rows + 1))
    inside = np.where(y % 2 == 1, np.clip(x - 0.5, 0, count), x.astype(float))
    V = np.column_stack([inside.ravel() / count, np.zeros(x.size), -y.ravel() / rows]) * size
    V += [-size / 2, 0.0, size / 2]
    a = (np.arange(rows)[:, None] * (count + 1) + np.arange(count)).ravel()
    odd = (np.arange(rows)[:, None] + np.zeros(count, dtype=int)).ravel() % 2 == 1
    b, c, d = a + 1, a + count + 1, a + count + 2
    even = np.vstack([np.column_stack([a, b, d]), np.column_stack([a, d, c])])
    other = np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])])
    both = np.concatenate([odd, odd])
    return V, np.where(both[:, None], other, even)


def unclean(count: int = 2500) -> Arrays:
    """A ball with a hole, a fin, a face that is there twice, cracks and a stray vertex; centimetres."""
    V, F = ball(count, 5.0)
    V[:, 1] *= 1.5
    V[:, 1] -= V[:, 1].min()
    middle = V[F].mean(axis=1)
    hole = np.linalg.norm(middle - [3.2, 9.5, 3.2], axis=1) < 1.5
    F = F[~hole]
    front = int(np.argmax(V[F].mean(axis=1)[:, 2]))
    a, b, _ = F[front]
    fin = V[a] + [0.0, 0.6, 1.6]
    # A crack: its upper side has vertices of its own, at the same places as those of its lower side.
    upper = V[F].mean(axis=1)[:, 1] > 11.0
    rim = np.intersect1d(F[upper], F[~upper])
    own = np.arange(len(V))
    own[rim] = len(V) + np.arange(len(rim))
    G = np.where(upper[:, None], own[F], F)
    V = np.vstack([V, V[rim], [fin, [7.0, 1.0, 0.0]]])
    G = np.vstack([G, G[front], [a, b, len(V) - 2], [a, a, b]])
    kept, H = np.unique(np.append(G.ravel(), len(V) - 1), return_inverse=True)
    return V[kept], H[:-1].reshape(-1, 3)


def _outward(V: np.ndarray, F: np.ndarray) -> Arrays:
    """The closed surface with its triangles facing outwards."""
    a, b, c = V[F].transpose(1, 0, 2)
    return (V, F) if np.einsum("ij,ij->", a, np.cross(b, c)) > 0 else (V, F[:, ::-1].copy())


def within(V: np.ndarray, low: tuple[float, float, float], high: tuple[float, float, float]) -> np.ndarray:
    """Vertices in a box."""
    return np.flatnonzero(((np.array(low) <= V) & (np.array(high) >= V)).all(axis=1))


def animal_labels(V: np.ndarray, *handles: np.ndarray) -> np.ndarray:
    """Labels (n,) with the feet as base, and each handle's vertices."""
    labels = np.ones(len(V), dtype=np.uint8)
    labels[V[:, 1] < 2.2] = 0
    for number, ids in enumerate(handles, start=2):
        labels[ids] = number
    return labels
