"""What scripts work with; :mod:`apd_viewer` has it all under its own name."""

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh, save_mesh
from apd_viewer.geometry.deform import Result, deform
from apd_viewer.geometry.deformation import Deformation
from apd_viewer.geometry.frame import Frame
from apd_viewer.geometry.goals import Region
from apd_viewer.geometry.mesh import Mesh

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
