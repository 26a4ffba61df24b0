"""A document with its shape, the unit of undo."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import default_name
from apd_viewer.geometry.analysis.inspection import Inspection, inspect
from apd_viewer.geometry.energy.cell_bending import load_excess
from apd_viewer.geometry.energy.rest_mesh import RestMesh
from apd_viewer.geometry.linalg.threads import cores_for
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import face_areas
from apd_viewer.geometry.picking.surface_index import SurfaceIndex
from apd_viewer.geometry.pose.constraints import FREE, HANDLE
from apd_viewer.geometry.pose.frame import TARGET_ACCURACY, Frame
from apd_viewer.geometry.solver.methods import DEFAULT_METHOD, contact_by_default
from apd_viewer.geometry.solver.settings import Settings
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import goal_percentages, shared_codes
from apd_viewer.session.model.handles_and_regions import Handle
from apd_viewer.session.model.named_obstacle import carried_shifts


@dataclass(frozen=True, eq=False)
class State:
    """A document and its shape: the unit of undo.

    Attributes
    ----------
    inspection : Inspection
        Readings of the mesh at rest.
    surface_index : SurfaceIndex
        Index for drawing and picking the mesh.
    frame : Frame
        The latest shape, and its readings.
    """

    document: Document
    inspection: Inspection
    surface_index: SurfaceIndex
    frame: Frame

    @property
    def region_counts(self) -> np.ndarray:
        """Number of vertices with each region number, (256,) int array."""
        return memo.label_counts(self.document.member)

    @property
    def is_at_rest(self) -> bool:
        """True for the rest shape, with nothing moved and all percentages 100 or unset."""
        document = self.document
        asks = document.settings.is_filled
        asks |= any(percent not in (None, 100.0) for percent in document.target_percentages)
        moved = document.is_posed or any(each.shift.any() for each in document.obstacles)
        return self.frame.U is document.mesh.V and not moved and not asks

    def is_handle_moved(self, k: int) -> bool:
        """True if handle ``k`` has been moved, or holds vertices away from rest."""
        whole = self.document.relative_to_rest
        moved = whole.handles[k].is_moved
        return moved or memo.is_displaced(whole.mesh.V, whole.initial_positions, whole.labels, HANDLE + k)

    @property
    def is_contact_active(self) -> bool:
        """True if contact is on and supported by the method."""
        return self.document.settings.uses_contact

    @property
    def is_safe_from_crossing(self) -> bool:
        """True if contact prevents self-intersections of the whole shape along its path."""
        touch = self.frame.contact
        return self.is_contact_active and touch is not None and not touch.exempt

    @property
    def obstacle_shifts(self) -> np.ndarray:
        """Displacements of the obstacles reached under contact, (o, 3)."""
        obstacles, come = self.document.obstacles, self.frame.shifts
        if self.is_contact_active and len(come) == len(obstacles):
            return come
        return np.array([each.shift for each in obstacles]).reshape(-1, 3)

    @property
    def document_with_reached_obstacles(self) -> Document:
        """Document with the obstacles moved as far as contact has let them."""
        if self.frame.share_reached >= 1.0:
            return self.document
        come = zip(self.document.obstacles, self.obstacle_shifts, strict=True)
        return replace(self.document, obstacles=tuple(each.with_shift(shift) for each, shift in come))

    @property
    def load_excess(self) -> float | None:
        """Expected relative overestimate of the obstacle loads; None without stiffness."""
        return load_excess_of(self.document)

    @property
    def has_unmet_target(self) -> bool:
        """True if a target of area or volume is not met."""
        document, rest, now = self.document, self.inspection, self.frame
        within = document.settings.tolerance if document.settings.traits.has_tolerance else TARGET_ACCURACY
        filled = document.settings.effective_settings.filled_volume
        if filled is not None and now.volume is not None and abs(now.volume - filled) > within * filled:
            return True
        at_rest = rest.area, rest.volume, *document.rest_areas
        measured = zip(goal_percentages(document), at_rest, (now.area, now.volume, *now.regions), strict=True)
        return any(
            percent is not None
            and before is not None
            and value is not None
            and abs(value / before - percent / 100.0) > within * percent / 100.0
            for percent, before, value in measured
        )

    def updated(self, document: Document | None = None, frame: Frame | None = None) -> State:
        """State with another document or frame; region areas are updated."""
        before, shown = self.document, self.frame
        document, frame = document or before, frame or shown
        # Skipped for handle motions, which leave the region areas of a frame unchanged.
        same = frame is shown and document.member is before.member and document.regions is before.regions
        if frame is shown and document.obstacles is not before.obstacles:
            frame = replace(frame, shifts=carried_shifts(before.obstacles, frame.shifts, document.obstacles))
        if not same:
            frame = replace(frame, regions=document.region_areas(frame.U))
        return State(document, self.inspection, self.surface_index, frame)

    def as_unsettled(self) -> State:
        """State with its shape marked as not converged."""
        return replace(self, frame=replace(self.frame, converged=False, settled=False))


def initial_document(mesh: Mesh, labels: np.ndarray | None = None) -> Document:
    """Initial document of a mesh, with ``labels`` (n,) or without paint."""
    if labels is None:
        labels = frozen(np.full(len(mesh.V), FREE, dtype=np.uint8))
    if face_areas(mesh.V, mesh.F).sum() <= 0.0:
        raise InputError(
            tr("{name} has no area: all its faces are degenerate; export it again.").format(name=mesh.name)
        )
    count = max(1, int(labels.max()) - HANDLE + 1)
    return Document(
        mesh,
        labels,
        initial_positions=mesh.V,
        member=frozen(np.zeros(len(mesh.V), dtype=np.uint8)),
        handles=tuple(Handle(default_name(tr("Handle"), k)) for k in range(1, count + 1)),
        settings=Settings(contact=contact_by_default(DEFAULT_METHOD, len(mesh.V))),
    )


def initial_state(mesh: Mesh, labels: np.ndarray | None = None) -> State:
    """Initial state of a mesh at rest, with ``labels`` (n,) or without paint."""
    document, inspection = initial_document(mesh, labels), inspect(mesh)
    return State(document, inspection, surface_index_of(mesh), rest_frame(mesh, inspection))


def surface_index_of(mesh: Mesh) -> SurfaceIndex:
    """Surface index of a mesh, for drawing and picking."""
    return SurfaceIndex.from_triangles(
        mesh.F, len(mesh.V), mesh.joined_F, mesh.V, mesh.corner_normals, mesh.opposite_half_edges
    )


def rest_frame(mesh: Mesh, inspection: Inspection) -> Frame:
    """Converged frame of the rest shape, without regions."""
    return Frame(
        U=mesh.V,
        iteration=0,
        area=inspection.area,
        area_error=0.0,
        volume=inspection.volume,
        volume_capped=inspection.volume_capped,
        handle_drift=0.0,
        converged=True,
        stable=True,
        energy=0.0,
    )


def shape_frame(mesh: Mesh, inspection: Inspection, U: np.ndarray) -> Frame:
    """Frame of another shape ``U`` (n, 3) of the mesh, measured, without regions."""
    frame = rest_frame(mesh, inspection)
    if U is mesh.V:
        return frame
    rest = RestMesh(mesh.V, mesh.F, mesh.weld)
    with cores_for(len(mesh.weld.first)):
        found = rest.measure(U[mesh.weld.first])
    return replace(frame, U=U, stable=None, area_error=found.area / rest.area - 1.0, **found._asdict())


def welded_state(state: State) -> State:
    """State with welded seams; both sides share paint and position."""
    before, mesh = state.document, state.document.mesh.welded()

    def beside(X: np.ndarray) -> np.ndarray:
        """Positions (n, 3) with both sides of each seam at the position of the first side."""
        return X if X is mesh.V else frozen(mesh.weld.to_file_vertices(X[mesh.weld.first]))

    document = replace(
        before,
        mesh=mesh,
        labels=shared_codes(before.labels, mesh.weld, FREE),
        member=shared_codes(before.member, mesh.weld, 0),
        initial_positions=beside(before.initial_positions),
        closed_openings=tuple(mesh.weld.representative[list(before.closed_openings)].tolist()),
    )
    loose = {part.first for part in document.loose_components}
    document = replace(
        document, immobile_components=tuple(sorted(loose.intersection(document.immobile_components)))
    )
    inspection, U = inspect(mesh), beside(state.frame.U)
    frame = replace(shape_frame(mesh, inspection, U), shifts=state.frame.shifts)
    found = State(document, inspection, surface_index_of(mesh), state.frame).updated(frame=frame)
    return found if U is mesh.V else found.as_unsettled()


def load_excess_of(document: Document) -> float | None:
    """Expected relative overestimate of the obstacle loads; None without stiffness."""
    cells = memo.cell_stiffness(document.mesh.V, document.mesh.joined_F)
    return load_excess(document.settings.effective_settings.material, cells)
