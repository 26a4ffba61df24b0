"""Public names for scripts, also available from :mod:`apd_viewer`."""

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.solver.deform import Result, deform
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.goals import Region

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
]
