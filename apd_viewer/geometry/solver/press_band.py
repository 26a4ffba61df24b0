"""Presses of a mesh with other dents each time, and the band of their loads.

Where a thin wall gives way depends on imperfections of its shape far smaller than its thickness. One press of
the perfect mesh says nothing about that; several of dented ones do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.linear_solver import LinearSolver
from apd_viewer.geometry.mesh.arrays import checked, used_vertices
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.geometry.mesh.operators import vertex_areas
from apd_viewer.geometry.solver.pressed_mesh import Pressed

MOST_RUNS = 1000
# Depth of dents by default and the largest, in percent of the wall thickness.
DEFAULT_DENTS, DEEPEST_DENTS = 10, 1000
# Number of times the random numbers are smoothed: once leaves kinks.
_SMOOTHINGS = 2


@checked
def dented_shape(
    V: np.ndarray, F: np.ndarray, depth: float, length: float, seed: int = 0, *, weld: bool = False
) -> np.ndarray:
    """Shape with random smooth dents and bulges along its normals.

    A random number for every vertex, normally distributed with a variance inverse to its area so that the
    result does not depend on the mesh, is smoothed twice by ``(1 - length^2 Laplacian)^-1``.

    Parameters
    ----------
    V, F : (n, 3) float and (m, 3) int arrays
    depth : float
        Largest displacement, mesh units.
    length : float
        Length over which dents are smooth, mesh units; they are a few times as wide.
    seed : int
        The same one gives the same dents.
    weld : bool
        Whether the sides of seams move together.

    Returns
    -------
    (n, 3) float array

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(3)
    >>> dented = apd_viewer.dented_shape(ball.vertices, ball.faces, depth=0.01, length=0.2)
    >>> float(np.linalg.norm(dented - ball.vertices, axis=1).max().round(6))
    0.01
    """
    rest = RestMesh.from_arrays(V, F, weld)
    return rest.to_mesh_coordinates(dented_positions(rest, depth, length, seed))


def dented_positions(rest: RestMesh, depth: float, length: float, seed: int) -> np.ndarray:
    """Local positions (n, 3) of a rest mesh with dents; see :func:`dented_shape`."""
    X, corners = rest.solve_mesh.V, rest.solve_mesh.F
    areas = vertex_areas(X, corners)
    mass = np.where(areas > 0.0, areas, rest.area / len(X))
    stiffness = length**2 * rest.solve_mesh.L
    smoothing = LinearSolver((sp.diags_array(mass) + stiffness).tocsr(), X)
    height = np.random.default_rng(seed).standard_normal((len(X), 1)) / np.sqrt(mass)[:, None]
    for _ in range(_SMOOTHINGS):
        height = smoothing.solve(mass[:, None] * height)
    moved = height * vertex_normals(X, corners)
    largest = float(np.linalg.norm(moved, axis=1).max())
    return rest.V + (depth / largest * moved)[rest.weld.inverse]


@dataclass(frozen=True, eq=False)
class PressBand:
    """Presses of one mesh with other dents each time.

    Attributes
    ----------
    presses : tuple of Pressed

    Examples
    --------
    >>> import apd_viewer
    >>> import trimesh
    >>> ball = trimesh.creation.icosphere(2)
    >>> wall = dict(axis=(0, 0, 1), to=1.9, steps=2, method="wall", wall_thickness=0.02)
    >>> shapes = [apd_viewer.dented_shape(ball.vertices, ball.faces, 0.002, 0.1, seed) for seed in range(2)]
    >>> band = apd_viewer.PressBand(tuple(apd_viewer.press(V, ball.faces, **wall) for V in shapes))
    >>> band.loads([0.0, 0.05]).shape, band.yields.shape
    ((2, 2), (2, 2))
    """

    presses: tuple[Pressed, ...]

    @property
    def yields(self) -> np.ndarray:
        """Deflection and load at which each yields, (r, 2); NaN where the load only rises."""
        curves = [each.curve for each in self.presses]
        return np.array([(each.yield_deflection, each.yield_load) for each in curves], dtype=float)

    def buckle_heights(self, F: np.ndarray, axis: np.ndarray) -> np.ndarray:
        """Height of the deepest dent once each has yielded, over the extent, (r,).

        It is that of the deepest point inwards, apart from even shortening, where the load has first fallen;
        NaN where it only rises. ``F`` (m, 3) are the triangles, ``axis`` (3,) is that of the press.
        """
        axis = np.asarray(axis) / np.linalg.norm(axis)
        return np.array([_buckle_height(each, F, axis) for each in self.presses])

    def loads(self, deflections: np.ndarray) -> np.ndarray:
        """Mean loads (r, s) at ``deflections`` (s,); NaN beyond the last step."""
        rows = []
        for each in self.presses:
            x, load = np.array([(step.deflection, step.load) for step in each.steps]).T
            rows.append(np.interp(deflections, x, load, right=np.nan))
        return np.array(rows)


def _buckle_height(pressed: Pressed, F: np.ndarray, axis: np.ndarray) -> float:
    yielded = pressed.curve.yield_deflection
    if yielded is None:
        return np.nan
    first, after = (
        pressed.steps[0],
        next((step for step in pressed.steps if step.deflection > yielded), pressed.steps[-1]),
    )
    used = used_vertices(F)
    before, now = first.U @ axis, after.U @ axis
    low, extent = before[used].min(), np.ptp(before[used])
    share = (before - low) / extent
    even = now[used].min() + share * np.ptp(now[used]) - before
    moved = after.U - first.U - even[:, None] * axis
    inwards = -np.einsum("ij,ij->i", moved, vertex_normals(first.U, F))
    return float(share[used[np.argmax(inwards[used])]])
