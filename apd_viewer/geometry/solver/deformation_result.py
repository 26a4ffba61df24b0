"""Deformation of a mesh in one call, and its result."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.analysis.mesh_findings import uneven_sentence
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.energy.cell_bending import cell_stiffness, load_excess
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.goals.goals import Region, RegionReading
from apd_viewer.geometry.mesh.arrays import checked, checked_floats
from apd_viewer.geometry.mesh.operators import aspect_ratios, face_areas
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pose.held_turn import HeldTurn, pass_through_warnings
from apd_viewer.geometry.pose.surface_turns import held_turns, relative_paths
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE, Convergence, stability_text
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.held_vertices import HeldVertices
from apd_viewer.geometry.solver.loose_components import GO
from apd_viewer.geometry.solver.methods import (
    DEFAULT_AREA_STIFFNESS,
    DEFAULT_METHOD,
    DEFAULT_POISSON,
    DEFAULT_SHEAR_STIFFNESS,
    DEFAULT_TOLERANCE,
    contact_by_default,
    method_named,
    no_contact_warning,
)
from apd_viewer.geometry.solver.path_iteration import PathIteration, PathStop
from apd_viewer.language import tr


@dataclass(frozen=True, eq=False)
class Result:
    """Finished deformation, with the fields of the command line's report.

    Attributes
    ----------
    U : (n, 3) float array
        Deformed positions in the order of the file, mesh units.
    area_error : float
        ``area / area_rest - 1``.
    volume_rest, volume : float or None
        Enclosed volume; None if the surface is not closed.
    area_target, volume_target : float or None
        Targets of the total area and the volume.
    volume_capped_rest, volume_capped : float or None
        Volumes of an open surface, with flat caps over its ``openings``.
    handle_drift : float
        Distance between the requested and the actual centroid of a handle; the largest for several handles.
    regions : tuple of RegionReading
        Readings of the regions.
    local_change : float
        Largest relative change of the area of a triangle, up or down.
    largest_edge_strain : float
        Strain of the edge with the largest relative change of length: 0.1 stretched by 10 %, -0.1 shortened.
    mean_edge_strain : float
        Mean of the edges' absolute strains, weighted by the rest area of the triangles at each.
    energy : float
        ARAP energy (Eq. 1, each undirected edge counted twice) with optimal rotations.
    warnings : tuple of str
        Sentences to the user about the mesh or the result.
    convergence : Convergence
        Criteria that ended the iterations.
    stable : bool or None
        True at a minimum of the energy as far as examined, False on a saddle; None if not examined.
    stability : str
        Stability in words, with the reason if unknown.
    saddle_escapes : int
        Number of energy saddles left for a lower shape.
    share_reached : float
        Fraction of the path to the targets completed, as far as contact allows.
    least_gap : float or None
        Least distance of touching walls, mesh units; None without contact, or if nothing touches.
    pairs_in_contact : int
        Touching pairs of a vertex and a triangle, or of two edges.
    loads : (o, 3) float array
        Forces on the obstacles, energy per length, for a material of stiffness 1.
    shifts : (o, 3) float array
        Displacements of the obstacles, mesh units.
    turned : tuple of float
        Requested turn of each handle relative to the base, degrees, with whole turns; positive about the line
        from the base to the handle, or else about the largest coordinate of its axis.
    turned_held : tuple of float or None
        Turn of the surface from the base to each handle, degrees. None if not measured: if less than 5
        degrees were requested, no surface connects them, or handle or base is a line or a point.
    load_excess : float or None
        Expected overestimate of the loads by bending of the mesh's cells, 0.1 for 10 %; None without loads,
        or without stiffness, when the loads are due to the cells alone.

    Examples
    --------
    >>> import apd_viewer
    >>> V, F = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]]
    >>> result = apd_viewer.deform(V, F, [0, 1, 2], V[:3], method="arap")
    >>> result.converged, result.method, result.warnings
    (True, 'arap', ('There is no volume: the surface is open (4 boundary edges).',))
    """

    U: np.ndarray
    method: str
    iterations: int
    converged: bool
    area_rest: float
    area: float
    area_error: float
    area_target: float | None
    volume_rest: float | None
    volume: float | None
    volume_target: float | None
    volume_capped_rest: float | None
    volume_capped: float | None
    openings: int
    energy: float
    handle_drift: float
    regions: tuple[RegionReading, ...]
    local_change: float
    largest_edge_strain: float
    mean_edge_strain: float
    seconds: float
    factor_seconds: float
    seconds_per_iteration: float
    warnings: tuple[str, ...]
    convergence: Convergence
    stable: bool | None
    stability: str
    saddle_escapes: int
    share_reached: float
    least_gap: float | None
    pairs_in_contact: int
    loads: np.ndarray
    shifts: np.ndarray
    turned: tuple[float, ...]
    turned_held: tuple[float | None, ...]
    load_excess: float | None


@checked
def deform(
    V: np.ndarray,
    F: np.ndarray,
    fixed: np.ndarray,
    targets: np.ndarray,
    method: str = DEFAULT_METHOD,
    iterations: int | None = None,
    tolerance: float = DEFAULT_TOLERANCE,
    stiffness: float = 0.0,
    *,
    handle: np.ndarray | Sequence[np.ndarray] | None = None,
    area_stiffness: float = DEFAULT_AREA_STIFFNESS,
    shear_stiffness: float = DEFAULT_SHEAR_STIFFNESS,
    wall_thickness: float | np.ndarray | None = None,
    poisson: float = DEFAULT_POISSON,
    tension_field: bool = False,
    area: float | str | None = None,
    volume: float | str | None = None,
    filled_volume: float | None = None,
    regions: Sequence[Region] = (),
    loose: str | Sequence[int] | np.ndarray = GO,
    calm: bool = True,
    contact: bool | None = None,
    thickness: float | None = None,
    obstacles: Sequence[Obstacle] = (),
    shifts: np.ndarray | None = None,
    yield_radius: float | None = None,
    hardening: float = 0.0,
    gas: float | None = None,
    pressure: float | None = None,
    convergence: Convergence = DEFAULT_CONVERGENCE,
    weld: bool = False,
    progress: Callable[[Frame], None] | bool | None = None,
) -> Result:
    """Deform a mesh with its ``fixed`` vertices held at their ``targets``.

    Parameters
    ----------
    V, F, fixed, method, tolerance, stiffness, handle, area_stiffness, shear_stiffness,
    wall_thickness, poisson, tension_field
        See :class:`Deformation`.
    area, volume, filled_volume, regions, loose, calm, thickness, obstacles, yield_radius, hardening, gas,
    pressure, convergence, weld
        Also there.
    contact : bool, optional
        Whether to prevent self-intersections beyond those at rest; held vertices may be stopped by contact.
        On by default up to 40,000 vertices, for the methods "exact", "local", "wall" and "arap", unless
        iterations are plain.
    shifts : (o, 3) float array, optional
        Displacement of each obstacle, moving straight and together with the held vertices, by an equal part
        to each waypoint of a path. By default they stay.
    targets : (k, 3) or (s, k, 3) float array
        Target position of each vertex in ``fixed``, mesh units; or a path of s waypoints followed in order.
        All segments of a path count equally in ``share_reached``.
    iterations : int, optional
        Exact number of plain iterations from the rest shape, without contact; by default until convergence.
    progress : callable or bool, optional
        Called with every Frame. True shows a progress line in scripts and notebooks calling
        ``apd_viewer.deform``; this function itself prints nothing.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        If the input cannot be used; the message says why.

    Examples
    --------
    >>> import apd_viewer
    >>> import numpy as np
    >>> mesh = apd_viewer.open_mesh("bottle.obj")
    >>> base, neck = np.flatnonzero(mesh.V[:, 1] < 1.2), np.flatnonzero(mesh.V[:, 1] > 18.7)
    >>> targets = np.vstack([mesh.V[base], mesh.V[neck] + [2, 0, 0]])
    >>> result = apd_viewer.deform(mesh.V, mesh.F, np.r_[base, neck], targets, handle=neck)
    >>> bool(abs(result.area_error) < 1e-8)
    True
    """
    started, told = time.perf_counter(), progress if callable(progress) else None
    rest = RestMesh.from_arrays(V, F, weld)
    size = method, len(rest.V)
    by_default = contact is None and iterations is None
    solver = Deformation(
        V,
        F,
        fixed,
        method=method,
        handle=handle,
        tolerance=tolerance,
        stiffness=stiffness,
        area_stiffness=area_stiffness,
        shear_stiffness=shear_stiffness,
        wall_thickness=wall_thickness,
        poisson=poisson,
        tension_field=tension_field,
        area=area,
        volume=volume,
        filled_volume=filled_volume,
        regions=regions,
        loose=loose,
        calm=calm,
        contact=contact_by_default(*size) if by_default else bool(contact),
        thickness=thickness,
        obstacles=obstacles,
        yield_radius=yield_radius,
        hardening=hardening,
        gas=gas,
        pressure=pressure,
        convergence=convergence,
        plain=iterations is not None,
        rest=rest,
    )
    targets = checked_floats(targets, tr("Targets"))
    path = targets if targets.ndim == 3 and len(targets) else targets[None]
    if targets is path and iterations is not None:
        raise InputError(tr("Plain iterations follow no path; give the last targets alone."))
    walk = PathIteration(solver, [*_stops(path, shifts)])
    result = iterate_to_result(
        solver, walk, started, iterations, told, _held_turns_function(solver, handle, path)
    )
    passing = no_contact_warning(*size, tr("--contact or contact=True")) if by_default else ""
    uneven = _uneven_warning(method, solver.rest)
    more = tuple(sentence for sentence in (passing, uneven) if sentence)
    return replace(result, warnings=(*result.warnings, *more)) if more else result


def _uneven_warning(method: str, rest: RestMesh) -> str:
    if not method_named(method).needs_even_triangles:
        return ""
    areas = face_areas(rest.V, rest.F)
    return uneven_sentence(aspect_ratios(rest.V, rest.F, areas), areas)


def _stops(path: np.ndarray, shifts: np.ndarray | None) -> Iterator[PathStop]:
    """Stops of a path (s, k, 3), with obstacle shifts in equal increments."""
    whole = None if shifts is None else checked_floats(shifts, tr("Shifts"))
    for number, targets in enumerate(path, start=1):
        yield PathStop(targets, None, None if whole is None else number / len(path) * whole)


def _held_turns_function(
    solver: Deformation, handle: np.ndarray | Sequence[np.ndarray] | None, places: np.ndarray
) -> Callable[[np.ndarray], tuple[HeldTurn, ...]]:
    """Function giving the held turns of a shape, reached along ``places`` (s, k, 3)."""
    rest, held = solver.rest, HeldVertices(solver.fixed, handle, solver.rest)
    labels = np.full(len(rest.solve_mesh.V), FREE)
    labels[held.ids] = np.where(held.handle_of > 0, HANDLE - 1 + held.handle_of, BASE)
    own = labels[rest.weld.inverse[solver.fixed]]
    ways = relative_paths(rest.V[solver.fixed], places, own)
    return lambda U: held_turns(rest.solve_mesh.V, U[rest.weld.first], rest.solve_mesh.F, labels, ways)


def iterate_to_result(
    solver: Deformation,
    walk: PathIteration,
    started: float,
    iterations: int | None = None,
    progress: Callable[[Frame], None] | None = None,
    turns: Callable[[np.ndarray], tuple[HeldTurn, ...]] = lambda _: (),
) -> Result:
    """Iterate until the shape has settled, or ``iterations`` times.

    Parameters
    ----------
    solver : Deformation
    walk : PathIteration
        Of the solver.
    started : float
        Start of the work, by ``time.perf_counter()``.
    iterations, progress
        See :func:`deform`.
    turns : callable
        Gives the turns of the handles in the last shape (n, 3).
    """
    while not walk.has_arrived:
        _iterate(walk, progress)
    iterating = time.perf_counter()
    count, most = 0, iterations or solver.convergence.most_iterations
    while count < most and (iterations is not None or not solver.settled):
        _iterate(walk, progress)
        count += 1
    frame = walk.frame()
    ended = time.perf_counter()
    each = (ended - iterating) / frame.iteration
    return deformation_result(solver, frame, ended - started, each, turns(frame.U))


def _iterate(walk: PathIteration, progress: Callable[[Frame], None] | None) -> None:
    walk.iterate()
    if progress:
        progress(walk.frame())


def deformation_result(
    solver: Deformation,
    frame: Frame,
    seconds: float,
    seconds_per_iteration: float,
    turns: Sequence[HeldTurn] = (),
) -> Result:
    """Result of the iterations up to ``frame``, with the handles' turns in its shape."""
    unsettled: tuple[str, ...] = ()
    if frame.unreached:
        unsettled = (frame.unreached,)
    elif solver.missed_goals_sentence:
        unsettled = (
            tr("Targets not met after {iteration:,} iterations: {missed}.").format(
                iteration=frame.iteration, missed=solver.missed_goals_sentence
            ),
        )
    elif not frame.settled and frame.iteration == (most := solver.convergence.most_iterations):
        unsettled = (tr("The shape did not converge within {most:,} iterations.").format(most=most),)
    touch = solver.contact is not None, method_named(solver.method).may_use_contact
    return Result(
        U=frame.U,
        method=solver.method,
        iterations=frame.iteration,
        converged=frame.converged,
        area_rest=solver.rest.area,
        area=frame.area,
        area_error=frame.area_error,
        area_target=solver.target("the area"),
        volume_rest=solver.rest.volume,
        volume=frame.volume,
        volume_target=solver.target("the volume"),
        volume_capped_rest=solver.rest.volume_capped,
        volume_capped=frame.volume_capped,
        openings=solver.rest.openings,
        energy=solver.rest.energy(frame.U),
        handle_drift=frame.handle_drift,
        regions=solver.readings(frame),
        local_change=frame.local_change,
        largest_edge_strain=frame.largest_edge_strain,
        mean_edge_strain=frame.mean_edge_strain,
        seconds=seconds,
        factor_seconds=solver.factor_seconds,
        seconds_per_iteration=seconds_per_iteration,
        warnings=(
            *solver.warnings,
            *unsettled,
            *pass_through_warnings(turns, frame, solver.rest.volume, *touch),
        ),
        convergence=solver.convergence,
        stable=frame.stable,
        stability=stability_text(frame, solver.solver.progress.converged is not None),
        saddle_escapes=frame.saddle_escapes,
        share_reached=frame.share_reached,
        least_gap=None if frame.contact is None else frame.contact.least_gap,
        pairs_in_contact=0 if frame.contact is None else frame.contact.pairs,
        loads=frame.loads,
        shifts=frame.shifts,
        turned=tuple(turn.degrees[0] for turn in turns),
        turned_held=tuple(turn.degrees[1] for turn in turns),
        load_excess=_load_excess(solver) if len(frame.loads) else None,
    )


def _load_excess(solver: Deformation) -> float | None:
    """Expected overestimate of the loads on obstacles; None without stiffness."""
    assert solver.contact is not None
    shape = solver.rest.solve_mesh
    return load_excess(solver.contact.surface.material, cell_stiffness(shape.V, shape.F))
