"""Meshes as users have them: a bar with one thing wrong each, and what should be said about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from meshes import box, rotation, soup

BASE, FREE, HANDLE = 0, 1, 2


@dataclass
class Defective:
    """A mesh with a defect.

    Attributes
    ----------
    V, F : (n, 3) float and (m, 3) int arrays
    labels : (n,) int array of BASE, FREE and HANDLE
    finding : str
        The kind of finding that names it.
    unheld : (k,) int array
        Vertices of a piece that nothing holds: they must not move at all.
    """

    V: np.ndarray
    F: np.ndarray
    labels: np.ndarray
    finding: str
    unheld: np.ndarray

    @property
    def fixed(self) -> np.ndarray:
        """The held vertices."""
        return np.flatnonzero(self.labels != FREE)

    @property
    def handle(self) -> np.ndarray:
        """Those of the handle."""
        return np.flatnonzero(self.labels == HANDLE)

    @property
    def targets(self) -> np.ndarray:
        """Where the held vertices are to be: the handle twisted, bent and pulled."""
        X = self.V[self.fixed].copy()
        mine = self.labels[self.fixed] == HANDLE
        centre, size = X[mine].mean(axis=0), np.ptp(self.V[self.labels != FREE], axis=0).max()
        R = rotation([0, 0, 1], 0.8) @ rotation([1, 0, 0], 0.4)
        X[mine] = (X[mine] - centre) @ R.T + centre + size * np.array([0.05, 0.1, 0.02])
        return X


def _bar(V: np.ndarray, F: np.ndarray, finding: str, unheld: np.ndarray | None = None) -> Defective:
    """Hold the lowest and the highest tenth of what is held."""
    unheld = np.zeros(0, dtype=int) if unheld is None else unheld
    used = np.isin(np.arange(len(V)), F)
    used[unheld] = False
    z = (V[:, 2] - V[used, 2].min()) / np.ptp(V[used, 2])
    labels = np.full(len(V), FREE)
    labels[used & (z <= 0.1)] = BASE
    labels[used & (z >= 0.9)] = HANDLE
    return Defective(V, np.asarray(F), labels, finding, unheld)


def suite() -> dict[str, Defective]:
    """All of them by name."""
    V, F = box(4, 4, 14)
    n, rng = len(V), np.random.default_rng(0)
    side = F[np.argsort(V[F].mean(axis=1)[:, 2])[len(F) // 2]]  # a triangle in the middle
    a, b = (int(i) for i in side[:2])
    middle = V[side].mean(axis=0)
    out = (middle - V.mean(axis=0)) * [1, 1, 0]
    out /= np.linalg.norm(out)
    island = middle + out + 0.3 * np.eye(3)
    flipped = F.copy()
    flipped[::7] = flipped[::7, ::-1]
    thin = V.copy()
    # A row of vertices pushed next to the row below: the triangles between are needles.
    row = V[:, 2] == 7.0
    thin[row, 2] = 6.0 + 1e-3
    # Two pyramids on the bar's side that touch in their tips only.
    tip = V[a] + 0.5 * out
    tie = np.vstack([V, tip, tip + out + 0.2 * rng.normal(size=(3, 3))])
    tie_F = np.vstack([F, [[a, b, n], [n, n + 1, n + 2], [n, n + 2, n + 3], [n, n + 3, n + 1]]])
    two, two_F = np.vstack([V, V + [9, 0, 0]]), np.vstack([F, F + n])
    return {
        "soup": _bar(*soup(V, F), "repeated vertices"),
        "unreferenced vertex": _bar(np.vstack([V, [[9.0, 9.0, 9.0]]]), F, "unreferenced vertices"),
        "index-degenerate face": _bar(V, np.vstack([F, [[a, a, b]]]), "faces without area"),
        "zero-area sliver": _bar(np.vstack([V, V[[a]]]), np.vstack([F, [[a, n, b]]]), "faces without area"),
        "free island": _bar(
            np.vstack([V, island]), np.vstack([F, [[n, n + 1, n + 2]]]), "separate pieces", n + np.arange(3)
        ),
        "non-manifold fin": _bar(np.vstack([V, middle + out]), np.vstack([F, [[a, b, n]]]), "crowded edges"),
        "one face in seven flipped": _bar(V, flipped, "flipped faces"),
        "bow-tie vertex": _bar(tie, tie_F, "bow ties"),
        "two pieces, one unheld": _bar(two, two_F, "separate pieces", n + np.arange(n)),
        "units of 1e-6": _bar(1e-6 * V, F, "tiny"),
        "1e6 from the origin": _bar(V + [1e6, -1e6, 1e6], F, "far away"),
        "needles": _bar(thin, F, "needles"),
    }
