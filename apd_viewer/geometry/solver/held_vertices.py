"""Checked held vertices, handles and soft vertices given by a caller."""

from collections.abc import Sequence

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.mesh.arrays import check_type, checked_floats, checked_integers, checked_vectors
from apd_viewer.geometry.pose.constraints import SoftConstraints
from apd_viewer.language import tr

# Largest distance of a target, in bounding-box diagonals; farther away, squared lengths leave no digits for
# the mesh.
_FARTHEST = 1e6
# Roles of vertex ids: the array's name, and the error sentence for a missing vertex.
_SAID = {
    "held": (tr("The held vertices"), tr("A held vertex does not exist: IDs run from 0 to {last:,}.")),
    "loose": (
        tr("The vertices of parts that stay"),
        tr("A vertex of a part that stays does not exist: IDs run from 0 to {last:,}."),
    ),
    "handle": (tr("The handle vertices"), tr("A handle vertex does not exist: IDs run from 0 to {last:,}.")),
}


def vertex_ids(value: np.ndarray | Sequence[int], n: int, role: str = "held") -> np.ndarray:
    """Valid vertex ids (k,) int64 of a mesh of ``n`` vertices; raises InputError."""
    name, otherwise = _SAID[role]
    ids = checked_integers(value, name).ravel()
    if len(ids) and (ids.min() < 0 or ids.max() >= n):
        raise InputError(otherwise.format(last=n - 1))
    return ids


def handle_numbers(
    handle: np.ndarray | Sequence[np.ndarray] | None, rest: RestMesh, solve_ids: np.ndarray
) -> np.ndarray:
    """Handle number of each held vertex of the solve mesh, from 1; 0 for the base."""
    listed = isinstance(handle, Sequence) or (isinstance(handle, np.ndarray) and handle.ndim > 0)
    if handle is not None and not listed:
        raise InputError(tr("The handle must be an array of vertex IDs, or a list of such arrays."))
    several = handle is not None and len(handle) > 0 and np.ndim(handle[0]) > 0
    handles = () if handle is None else handle if several else (handle,)
    number = np.zeros(len(solve_ids), dtype=np.int64)
    for k, ids in enumerate(handles, start=1):
        ids = np.unique(rest.weld.inverse[vertex_ids(ids, len(rest.V), "handle")])
        if not np.isin(ids, solve_ids).all():
            raise InputError(
                tr("A handle vertex is not held; include the vertices of the handle in the held vertices.")
            )
        mine = np.searchsorted(solve_ids, ids)
        if (number[mine] > 0).any():
            raise InputError(tr("A vertex belongs to two handles; remove it from one."))
        number[mine] = k
    return number


def checked_shifts(value: np.ndarray | None, count: int) -> np.ndarray:
    """Checked shifts (o, 3) of ``count`` obstacles; zeros if None. Raises InputError."""
    shifts = np.zeros((count, 3)) if value is None else checked_floats(value, tr("Shifts"))
    if shifts.shape != (count, 3) or not np.isfinite(shifts).all():
        raise InputError(tr("Shifts must be {n} finite vectors, one for each obstacle.").format(n=count))
    return shifts


def check_any_free(rest: RestMesh, held: np.ndarray) -> None:
    """Raise InputError if all parts with ``held`` (h,) vertices are rigid."""
    if len(held) and rest.solve_mesh.is_connected_to(held).sum() == len(held):
        raise InputError(tr("Every vertex is held; leave some free to deform."))


class HeldVertices:
    """Held vertices of a file and of the solve mesh, with coincident vertices merged.

    Parameters
    ----------
    fixed : (k,) ints
        Of the file.
    handle
        Of the file; see :func:`handle_numbers`.
    rest : RestMesh

    Attributes
    ----------
    fixed : (k,) int array
    ids : (h,) int array
        Of the solve mesh, ascending.
    handle_of : (h,) int array
        The number of the handle of each, from 1; 0 is base.
    targets : (h, 3) float array
        Requested positions.

    Raises
    ------
    InputError
        If a vertex does not exist, or a handle is not held.
    """

    def __init__(
        self,
        fixed: np.ndarray | Sequence[int],
        handle: np.ndarray | Sequence[np.ndarray] | None,
        rest: RestMesh,
    ) -> None:
        self._rest, self.fixed = rest, vertex_ids(fixed, len(rest.V))
        self.ids, self._chosen, inverse = np.unique(
            rest.weld.inverse[self.fixed], return_index=True, return_inverse=True
        )
        self._inverse = inverse.ravel()
        self.handle_of = handle_numbers(handle, rest, self.ids)
        self._targets, self.targets = rest.V[self.fixed], rest.solve_mesh.V[self.ids]

    def set_targets(self, targets: np.ndarray) -> None:
        """Set target positions (k, 3) of the file's held vertices; raises InputError."""
        found = checked_targets(targets, self._rest, self.fixed, self._chosen, self._inverse)
        self._targets, self.targets = found

    def write_positions(self, U: np.ndarray, held: np.ndarray) -> None:
        """Write local positions of the file's held vertices into ``U`` (n, 3).

        Vertices welded with a tolerance are held exactly.
        """
        U[self.fixed] = self._targets + (held[: len(self.ids)] - self.targets)[self._inverse]

    def drift(self, held: np.ndarray) -> float:
        """Largest distance of a handle's centre from its target."""
        away = held[: len(self.ids)] - self.targets
        handles = range(1, int(self.handle_of.max(initial=0)) + 1)
        centres = [away[self.handle_of == k].mean(axis=0) for k in handles]
        return max((float(np.linalg.norm(centre)) for centre in centres), default=0.0)


def checked_rest_mesh(rest: RestMesh | None, V: np.ndarray, F: np.ndarray, weld: bool) -> RestMesh:
    """Given rest mesh, or one made from the arrays; raises InputError."""
    if rest is None:
        return RestMesh.from_arrays(V, F, weld)
    check_type("rest", rest, RestMesh)
    return rest


def soft_solve_constraints(
    soft: SoftConstraints, rest: RestMesh, solve_ids: np.ndarray
) -> tuple[SoftConstraints, tuple[np.ndarray, int]]:
    """Soft constraints of the solve mesh, their rows in ``soft``, and its length.

    Held vertices and components without any held vertex are left out.
    """
    check_type("soft", soft, SoftConstraints)
    ids, which = np.unique(rest.weld.inverse[soft.ids], return_index=True)
    piece = rest.solve_mesh.component
    free = np.isin(piece[ids], piece[solve_ids]) & ~np.isin(ids, solve_ids)
    return soft.subset(which[free])._replace(ids=ids[free]), (which[free], len(soft.ids))


def checked_soft_targets(
    value: object, rest: RestMesh, soft: SoftConstraints, places: np.ndarray, count: int
) -> np.ndarray:
    """Local targets (s, 3) of soft vertices; rest positions if ``value`` is None."""
    if value is None:
        return rest.solve_mesh.V[soft.ids]
    return rest.to_local(checked_vectors(value, count, tr("Soft targets"))[places])


def checked_targets(
    targets: np.ndarray, rest: RestMesh, fixed: np.ndarray, chosen: np.ndarray, inverse: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Checked local targets, of the held vertices of the file and of the welded mesh.

    Parameters
    ----------
    targets : (k, 3) float array
    rest : RestMesh
    fixed : (k,) int array
        Held vertices of the file.
    chosen, inverse : (h,) and (k,) int arrays
        Row of ``fixed`` for each held vertex of the welded mesh, and the inverse map.

    Raises
    ------
    InputError
        If a target is missing, not finite, too far away, or not the only one of its vertex.
    """
    targets = rest.to_local(checked_floats(targets, tr("Targets")))
    if targets.shape != (len(fixed), 3) or not np.isfinite(targets).all():
        raise InputError(
            tr("Targets must be {n} finite positions, one for each held vertex.").format(n=len(fixed))
        )
    if np.abs(targets - rest.V[fixed]).max(initial=0.0) > _FARTHEST * rest.diagonal:
        raise InputError(tr("A target position is too far from the mesh; check the unit and the transform."))
    asked = targets[chosen] - rest.weld.offset_of(fixed[chosen])
    apart = targets - rest.weld.offset_of(fixed) - asked[inverse]
    if np.abs(apart).max(initial=0.0) > rest.in_place_tolerance:
        raise InputError(tr("A vertex has two target positions; give it one."))
    return targets, asked


def checked_start(U: np.ndarray, rest: RestMesh) -> np.ndarray:
    """Checked local start positions (n, 3); raises InputError."""
    U = checked_floats(U, tr("Start positions"))
    if U.shape != rest.V.shape or not np.isfinite(U).all():
        raise InputError(tr("Start positions must be {n} finite positions.").format(n=len(rest.V)))
    return rest.to_local(U)
