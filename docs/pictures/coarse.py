"""The same state with fewer triangles, where only the driving of a window matters."""

from __future__ import annotations

from dataclasses import replace

from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.decimation import decimated_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import State, initial_state


def coarser(state: State, count: int) -> State:
    """A state at rest with about ``count`` vertices: its paint, regions and settings."""
    document = state.document
    if len(document.mesh.V) <= count:
        return state
    ids, F = decimated_mesh(document.mesh.V, document.mesh.F, count)
    mesh = Mesh(document.mesh.V[ids], F)
    fewer = initial_state(mesh, frozen(document.labels[ids].copy()))
    said = replace(
        document,
        mesh=mesh,
        labels=fewer.document.labels,
        initial_positions=mesh.V,
        member=frozen(document.member[ids].copy()),
        measurements=(),
    )
    return fewer.updated(said)
