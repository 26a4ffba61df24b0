"""Area-preserving deformation of 3D objects.

>>> import apd_viewer
>>> mesh = apd_viewer.open_mesh("bar.off")                                      # doctest: +SKIP
>>> result = apd_viewer.deform(mesh.V, mesh.F, fixed, targets, handle=handle)   # doctest: +SKIP
>>> apd_viewer.save_mesh(mesh, result.U, "deformed.off")                        # doctest: +SKIP
>>> apd_viewer.view(mesh)                                                       # doctest: +SKIP

Neither importing the package nor deforming without a window loads Qt or VTK.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

# expanduser fails without HOME and without an entry in the user database, as in containers. Modules look up
# the home folder when imported, so it is set to a path that always exists, and holds no files.
if not os.path.isabs(os.path.expanduser("~")):  # noqa: PTH111, PTH117, which raise
    os.environ["HOME"] = os.devnull

from apd_viewer.errors import InputError
from apd_viewer.language import tr

if TYPE_CHECKING:
    from apd_viewer.api import *

__version__ = "0.2.0"
__all__ = [
    "BucklingModes",
    "Convergence",
    "Deformation",
    "Frame",
    "HullReadings",
    "InputError",
    "LiveView",
    "Mesh",
    "Obstacle",
    "PressBand",
    "PressStep",
    "Pressed",
    "Region",
    "Result",
    "SurfacePoint",
    "Vessel",
    "VolumeReadings",
    "buckling_modes",
    "capsule",
    "deform",
    "dented_shape",
    "geodesic_path",
    "live",
    "open_mesh",
    "plane_section",
    "plate",
    "press",
    "save_mesh",
    "sphere",
    "view",
    "volume_readings",
    "wall_map",
]


def __getattr__(name: str) -> Any:
    """Import public names on first use, so that a window appears sooner."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    # Imported here: the api module loads numba and scipy, not needed to open a window.
    from apd_viewer import api

    return getattr(api, name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]


def view(mesh: Any = None) -> None:
    """Open the window on a mesh and return when it is closed.

    Parameters
    ----------
    mesh : Mesh, pyvista.PolyData, trimesh.Trimesh, path or None
        Mesh to show; None shows the sample bottle.

    Raises
    ------
    InputError
        If the mesh cannot be used, or there is no display.

    Examples
    --------
    >>> import apd_viewer
    >>> apd_viewer.view("bottle.obj")
    """
    show_window(mesh)


def show_window(mesh: Any, shows_errors: bool = False) -> None:
    """Open the window; ``shows_errors`` makes it report unusable files itself."""
    try:
        # Imported here: only a window needs Qt and VTK, and one of their system libraries may be missing.
        from apd_viewer import log
        from apd_viewer.ui.application import run

        with log.recording_log():
            run(mesh, shows_errors)
    except ImportError as error:
        raise InputError(
            tr(
                "A library that the window needs is missing ({error}); install the system packages "
                "listed in the README."
            ).format(error=error)
        ) from error
