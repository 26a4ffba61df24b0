"""Area-preserving deformation of 3D objects.

>>> import apd_viewer
>>> mesh = apd_viewer.open_mesh("bar.off")                                      # doctest: +SKIP
>>> result = apd_viewer.deform(mesh.V, mesh.F, fixed, targets, handle=handle)   # doctest: +SKIP
>>> apd_viewer.save_mesh(mesh, result.U, "deformed.off")                        # doctest: +SKIP
>>> apd_viewer.view(mesh)                                                       # doctest: +SKIP

Neither importing the package nor deforming without a window loads Qt or VTK.
"""

from __future__ import annotations

from typing import Any

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh, save_mesh
from apd_viewer.geometry.deform import Result, deform
from apd_viewer.geometry.deformation import Deformation, Frame
from apd_viewer.geometry.goals import Region
from apd_viewer.geometry.mesh import Mesh

__version__ = "0.1.0"
__all__ = [
    "Deformation",
    "Frame",
    "InputError",
    "Mesh",
    "Region",
    "Result",
    "deform",
    "open_mesh",
    "save_mesh",
    "view",
]


def view(mesh: Any = None) -> None:
    """Open the window on a mesh and return when it is closed.

    Parameters
    ----------
    mesh : Mesh, pyvista.PolyData, trimesh.Trimesh, path or None
        What to show; None shows the sample bottle.

    Raises
    ------
    InputError
        If the mesh cannot be used, or there is no display.
    """
    try:
        from apd_viewer.ui.application import run
    except ImportError as error:
        raise InputError(
            f"The window needs a library that is missing ({error}); "
            "the README names the system packages to install."
        ) from error
    run(mesh)
