"""Document of user input: an immutable value, replaced rather than edited."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from apd_viewer.files.mesh_location import MissingMesh
from apd_viewer.files.selections.selection import default_name
from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.contact.contact_obstacles import Obstacle
from apd_viewer.geometry.measuring.measurement import Measurement
from apd_viewer.geometry.mesh.arrays import frozen
from apd_viewer.geometry.mesh.edges_and_components import LooseComponent, loose_components
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import region_areas
from apd_viewer.geometry.pose.constraints import (
    BASE,
    FREE,
    HANDLE,
    NO_SOFT_CONSTRAINTS,
    Constraints,
    SoftConstraints,
    constraints,
)
from apd_viewer.geometry.solver.settings import DEFAULT_SETTINGS, Settings
from apd_viewer.language import tr
from apd_viewer.session.model import memo
from apd_viewer.session.model.handles_and_regions import (
    FACTORED,
    IDENTITY,
    NO_FLAGS,
    NOT_FACTORED,
    DocumentFlags,
    Handle,
    NamedPose,
    NamedRegion,
    PartFlags,
)
from apd_viewer.session.model.named_obstacle import NamedObstacle, geometric_obstacles


@dataclass(frozen=True, eq=False)
class Document:
    """User input without derived values; compared by identity, arrays read-only.

    Attributes
    ----------
    labels : (n,) uint8 array of BASE, FREE, and HANDLE + k for ``handles[k]``
    initial_positions : (n, 3) float array
        Positions when the labels were last changed, from which base and handles are moved.
    member : (n,) uint8 array
        k + 1 for the vertices of ``regions[k]``, 0 for those in none.
    handles : tuple of Handle, never empty
    immobile_components : tuple of int
        Lowest vertex of each connected part that does not move while neither base nor handle is on it.
    obstacles : tuple of NamedObstacle
        Obstacles that the surface cannot enter while contact is on.
    closed_openings : tuple of int
        A vertex at the border of each opening through which no liquid runs out.
    target_shape : TargetShape or None
        Shape of comparison, without influence on the deformation.
    missing_target_shape : MissingMesh or None
        The target shape of a session that was not found again.
    mirror_axis : int or None
        Axis along which handles are moved symmetrically, 0, 1 or 2; None moves each by itself.
    """

    mesh: Mesh = field(metadata=FACTORED)
    labels: np.ndarray = field(metadata=FACTORED)
    initial_positions: np.ndarray = field(metadata=NOT_FACTORED)
    member: np.ndarray = field(metadata=NOT_FACTORED)
    # Handles and settings declare FACTORED or NOT_FACTORED for each of their own fields.
    handles: tuple[Handle, ...] = field(
        default=(Handle(default_name(tr("Handle"), 1)),), metadata=NOT_FACTORED
    )
    regions: tuple[NamedRegion, ...] = field(default=(), metadata=NOT_FACTORED)
    settings: Settings = field(default=DEFAULT_SETTINGS, metadata=NOT_FACTORED)
    immobile_components: tuple[int, ...] = field(default=(), metadata=NOT_FACTORED)
    obstacles: tuple[NamedObstacle, ...] = field(default=(), metadata=NOT_FACTORED)
    base: PartFlags = field(default=NO_FLAGS, metadata=NOT_FACTORED)
    measurements: tuple[Measurement, ...] = field(default=(), metadata=NOT_FACTORED)
    closed_openings: tuple[int, ...] = field(default=(), metadata=NOT_FACTORED)
    target_shape: TargetShape | None = field(default=None, metadata=NOT_FACTORED)
    missing_target_shape: MissingMesh | None = field(default=None, metadata=NOT_FACTORED)
    poses: tuple[NamedPose, ...] = field(default=(), metadata=NOT_FACTORED)
    mirror_axis: int | None = field(default=None, metadata=NOT_FACTORED)

    # Derived values

    @property
    def paint_problem(self) -> str | None:
        """Sentence about missing paint needed for a motion; None if complete."""
        return memo.paint_problem(self.labels, _needs_no_handle(self))

    @property
    def has_active_obstacles(self) -> bool:
        """True if there are obstacles and contact is on."""
        return bool(self.obstacles) and self.settings.uses_contact

    @property
    def active_obstacles(self) -> tuple[Obstacle, ...]:
        """Active obstacles at their initial positions."""
        return geometric_obstacles(self.obstacles, self.mesh.V) if self.has_active_obstacles else ()

    @property
    def label_counts(self) -> np.ndarray:
        """Number of vertices with each label, (256,) int array."""
        return memo.label_counts(self.labels)

    @property
    def base_centre(self) -> np.ndarray | None:
        """Centre of the base, (3,); None if there is no base."""
        has_base = self.label_counts[BASE]
        return memo.label_centre(self.labels, self.initial_positions, BASE) if has_base else None

    def centre(self, k: int) -> np.ndarray | None:
        """Initial centre of handle ``k``, (3,); None if it has no vertices."""
        label = HANDLE + k
        has_vertices = self.label_counts[label]
        return memo.label_centre(self.labels, self.initial_positions, label) if has_vertices else None

    def pivot(self, k: int) -> np.ndarray | None:
        """Initial pivot of handle ``k``, (3,); None if it has no vertices."""
        centre, own = self.centre(k), self.handles[k].pivot
        return centre if own is None or centre is None else own

    def constraints(self) -> Constraints:
        """Held vertices and their targets; raises InputError with ``paint_problem``."""
        poses = [handle.pose for handle in self.handles]
        initial, soft = self.initial_positions, self.soft_constraints
        return constraints(self.labels, initial, poses, soft, _needs_no_handle(self))

    @property
    def soft_constraints(self) -> SoftConstraints:
        """Soft constraints of free vertices within the falloff of a handle."""
        falloffs = tuple(handle.falloff for handle in self.handles)
        if not any(falloffs):
            return NO_SOFT_CONSTRAINTS
        return memo.falloff_constraints(
            self.mesh.V, self.mesh.joined_F, self.mesh.weld, self.labels, falloffs
        )

    @property
    def loose_components(self) -> tuple[LooseComponent, ...]:
        """Connected parts with triangles but without base and handle, largest first."""
        mesh = self.mesh
        return loose_components(memo.triangle_components(mesh.joined_F), mesh.F, self.labels != FREE)

    @property
    def is_posed(self) -> bool:
        """True if any handle or active obstacle has been moved."""
        handles = any(not np.array_equal(handle.pose, IDENTITY) for handle in self.handles)
        return handles or (self.has_active_obstacles and any(each.shift.any() for each in self.obstacles))

    @property
    def has_half_turn(self) -> bool:
        """True if any handle has turned by half a turn or more."""
        return any(handle.has_half_turn for handle in self.handles)

    @property
    def target_percentages(self) -> tuple[float | None, ...]:
        """Target percentages of the area, the volume and each region."""
        return self.settings.area, self.settings.volume, *(part.area for part in self.regions)

    @property
    def rest_areas(self) -> tuple[float, ...]:
        """Area of each region at rest."""
        if not self.regions:
            return ()
        return memo.rest_areas(self.mesh.V, self.mesh.F, self.member, len(self.regions))

    def region_areas(self, U: np.ndarray) -> tuple[float, ...]:
        """Areas of the regions in shape ``U`` (n, 3), from triangles fully inside."""
        if U is self.mesh.V or not self.regions:
            return self.rest_areas
        return tuple(region_areas(U, self.mesh.F, self.member, len(self.regions)).tolist())

    @property
    def flags(self) -> DocumentFlags:
        """Locked and hidden flags of the base, the handles and the regions."""
        handles, regions = (part.flags for part in self.handles), (part.flags for part in self.regions)
        return DocumentFlags(self.base, tuple(handles), tuple(regions))

    # Modified copies

    def at_rest(self) -> Document:
        """Document with all handles reset and all target percentages at 100."""
        regions = tuple(part if part.area is None else replace(part, area=100.0) for part in self.regions)
        volume = None if self.settings.volume is None else 100.0
        settings = replace(self.settings, area=100.0, volume=volume, filled_volume=None, pressure=None)
        handles = tuple(
            replace(handle.relative_to_rest.with_pose(IDENTITY), former_twist_axis=None)
            for handle in self.handles
        )
        return replace(
            self, initial_positions=self.mesh.V, handles=handles, settings=settings, regions=regions
        )

    @property
    def relative_to_rest(self) -> Document:
        """Equivalent document with motions relative to the rest shape.

        Vertices painted on a deformed shape keep their positions there, with the motions undone.
        """
        if not any(handle.earlier_poses for handle in self.handles):
            return self
        starts = [handle.earlier_poses[-1] if handle.earlier_poses else IDENTITY for handle in self.handles]
        own = self.initial_positions
        initial = memo.initial_positions_from_rest(self.mesh.V, own, self.labels, self.mesh.weld, *starts)
        handles = tuple(handle.relative_to_rest for handle in self.handles)
        return replace(self, initial_positions=self.mesh.V if initial is None else initial, handles=handles)

    def with_settings(self, **changes: Any) -> Document:
        """Document with changed settings, given by name."""
        return replace(self, settings=replace(self.settings, **changes))

    def with_label(self, ids: np.ndarray, label: int) -> Document:
        """Document with ``ids`` and their coincident vertices labelled.

        Locked parts stay as they are.
        """
        labels = _painted_codes(
            self.labels, self.mesh.weld.with_coincident_vertices(ids), label, self.flags.locked.labels
        )
        return self if labels is self.labels else replace(self, labels=labels)

    def with_region_number(self, ids: np.ndarray, number: int) -> Document:
        """Document with ``ids`` and their coincident vertices in a region; 0 is none.

        Locked regions stay as they are.
        """
        member = _painted_codes(
            self.member, self.mesh.weld.with_coincident_vertices(ids), number, self.flags.locked.regions
        )
        return self if member is self.member else replace(self, member=member)

    def with_pose(self, k: int, pose: np.ndarray) -> Document:
        """Document with handle ``k`` at ``pose`` (4, 4), without waypoints."""
        return self.with_handle(k, self.handles[k].with_pose(pose))

    def with_handle_moved(self, k: int, pose: np.ndarray) -> Document:
        """Document with handle ``k`` moved to ``pose`` (4, 4), extending its path."""
        return self.with_handle(k, self.handles[k].moved_to(pose))

    def with_handle(self, k: int, handle: Handle) -> Document:
        """Document with handle ``k`` replaced or appended."""
        return replace(self, handles=(*self.handles[:k], handle, *self.handles[k + 1 :]))

    def with_region(self, k: int, region: NamedRegion) -> Document:
        """Document with region ``k`` replaced or appended."""
        return replace(self, regions=(*self.regions[:k], region, *self.regions[k + 1 :]))


def _painted_codes(codes: np.ndarray, ids: np.ndarray, code: int, locked: np.ndarray) -> np.ndarray:
    """Codes with ``code`` at unlocked ``ids``; the identical array if nothing changes."""
    ids = ids[~(locked[codes[ids]] | locked[code])]
    if (codes[ids] == code).all():
        return codes
    painted = codes.copy()
    painted[ids] = code
    return frozen(painted)


def _needs_no_handle(document: Document) -> bool:
    """True if obstacles, or what fills a shape with a base, move it without a handle."""
    fills = document.settings.effective_settings.is_filled and bool(document.label_counts[BASE])
    return fills or document.has_active_obstacles
