"""Options of a press: material, goals, and the shape it begins from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.material import Material
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import check_argument, checked_floats
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_SHEAR_STIFFNESS,
    Method,
    method_material,
)
from apd_viewer.language import tr


@dataclass(frozen=True, eq=False)
class PressOptions:
    """Material, goals and held vertices of a mesh to press.

    Attributes
    ----------
    fixed : (k,) ints
        Vertices that are held where they are at rest; none need be.
    method, stiffness, area_stiffness, shear_stiffness, area, volume, thickness
        See :class:`~apd_viewer.geometry.solver.deformation.Deformation`.
    yield_radius : float or None
        Walls that are bent to a smaller radius than that from flat, mesh units, keep a crease; None for walls
        that spring back from everything.
    gas : float or None
        Pressure of enclosed gas times volume, at rest, in areas of the surface, openings capped; None for
        openings or holes that it leaves by.
    start : (n, 3) float array or None
        Shape to begin from, such as a twisted one; None for the shape at rest.
    """

    fixed: Sequence[int] | np.ndarray = ()
    method: str = DEFAULT_METHOD
    stiffness: float = 0.0
    area_stiffness: float = DEFAULT_AREA_STIFFNESS
    shear_stiffness: float = DEFAULT_SHEAR_STIFFNESS
    area: float | str | None = None
    volume: float | str | None = None
    thickness: float | None = None
    yield_radius: float | None = None
    start: np.ndarray | None = None
    gas: float | None = None


DEFAULT_OPTIONS = PressOptions()


def start_positions(rest: RestMesh, start: np.ndarray | None) -> np.ndarray:
    """Local start positions (k, 3) of the solve; by default the rest array itself."""
    if start is None:
        return rest.solve_mesh.V
    start = checked_floats(start, tr("Start"))
    if start.shape != rest.V.shape:
        raise InputError(
            tr("The shape to begin from must have the {count:,} vertices of the mesh.").format(
                count=len(rest.V)
            )
        )
    if not np.isfinite(start).all():
        raise InputError(tr("Every coordinate of the shape to begin from must be a number."))
    return np.ascontiguousarray(rest.to_local(start)[rest.weld.first])


def press_material(method: Method, options: PressOptions) -> Material:
    """Material with its yield curvature; raises InputError on impossible values."""
    stiffness, radius = options.stiffness, options.yield_radius
    material = method_material(method, stiffness, options.area_stiffness, options.shear_stiffness)
    check_yield_radius(radius, material.bending)
    return material if radius is None else replace(material, yield_curvature=1.0 / radius)


def check_yield_radius(radius: float | None, stiffness: float) -> None:
    """Raise InputError unless walls can yield at a radius; None means no yielding."""
    if radius is None:
        return
    check_argument("yield_radius", radius)
    if not stiffness:
        raise InputError(tr("Walls without bending stiffness keep no creases; enter a stiffness, too."))
