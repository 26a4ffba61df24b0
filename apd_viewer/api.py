"""Public names for scripts, also available from :mod:`apd_viewer`."""

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.hull_readings import HullReadings
from apd_viewer.geometry.analysis.volume_readings import VolumeReadings, volume_readings
from apd_viewer.geometry.contact.contact_obstacles import Obstacle, capsule, plate, sphere
from apd_viewer.geometry.goals.goals import Region
from apd_viewer.geometry.measuring.geodesics import geodesic_path
from apd_viewer.geometry.measuring.sections import plane_section
from apd_viewer.geometry.measuring.surface_point import SurfacePoint
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.frame import Frame
from apd_viewer.geometry.pressing.press_step import PressStep
from apd_viewer.geometry.pressing.pressed_mesh import Pressed, press
from apd_viewer.geometry.solver.convergence import Convergence
from apd_viewer.geometry.solver.deformation import Deformation
from apd_viewer.geometry.solver.deformation_result import Result
from apd_viewer.presentation.notebooks.notebook_deform import deform

__all__ = [
    "Convergence",
    "Deformation",
    "Frame",
    "HullReadings",
    "InputError",
    "Mesh",
    "Obstacle",
    "PressStep",
    "Pressed",
    "Region",
    "Result",
    "SurfacePoint",
    "VolumeReadings",
    "capsule",
    "deform",
    "geodesic_path",
    "open_mesh",
    "plane_section",
    "plate",
    "press",
    "save_mesh",
    "sphere",
    "volume_readings",
]
