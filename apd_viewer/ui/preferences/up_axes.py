"""Up axis of each mesh, remembered by file."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from apd_viewer.files.storage.atomic_file import resolved_path
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.ui.preferences.preferences import user_file

if TYPE_CHECKING:
    from apd_viewer.geometry.mesh.mesh import Mesh
    from apd_viewer.ui.preferences.preferences import Preferences


class UpAxes:
    """Chosen up axes; those of samples last as long as the mesh.

    Parameters
    ----------
    preferences : Preferences
    default_axis : callable
        Up axis of a mesh whose format prescribes none, unless it is a sample.
    """

    def __init__(
        self, preferences: Preferences, default_axis: Callable[[], UpAxis] = lambda: UpAxis.PLUS_Y
    ) -> None:
        self._memory = preferences
        self._usual = default_axis
        self._chosen: WeakKeyDictionary[Mesh, UpAxis] = WeakKeyDictionary()

    def up_axis_of(self, mesh: Mesh) -> UpAxis:
        """Chosen up axis of a mesh, or the one of its format."""
        path = user_file(mesh)
        known = {} if path is None else self._memory.up_axes
        is_sample = mesh.path is not None and path is None
        suffix = "" if mesh.path is None else mesh.path.suffix
        default = UpAxis.from_suffix(suffix, UpAxis.PLUS_Y if is_sample else self._usual())
        return self._chosen.get(mesh) or (
            default if path is None else known.get(resolved_path(path), default)
        )

    def choose(self, mesh: Mesh, axis: UpAxis) -> None:
        """Remember an up axis for a mesh and its file."""
        self._chosen[mesh] = axis
        path = user_file(mesh)
        if path is not None:
            self._memory.remember_up_axis(path, axis)
