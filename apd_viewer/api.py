"""Public names for scripts, also available from :mod:`apd_viewer`."""

from apd_viewer.errors import InputError as InputError
from apd_viewer.files.mesh_writing import save_mesh as save_mesh
from apd_viewer.files.meshes import open_mesh as open_mesh
from apd_viewer.geometry.analysis.hull_readings import HullReadings as HullReadings
from apd_viewer.geometry.analysis.volume_readings import (
    VolumeReadings as VolumeReadings,
    volume_readings as volume_readings,
)
from apd_viewer.geometry.contact.contact_obstacles import (
    Obstacle as Obstacle,
    capsule as capsule,
    plate as plate,
    sphere as sphere,
)
from apd_viewer.geometry.energy.wall_map import wall_map as wall_map
from apd_viewer.geometry.goals.goals import Region as Region
from apd_viewer.geometry.measuring.geodesics import geodesic_path as geodesic_path
from apd_viewer.geometry.measuring.sections import plane_section as plane_section
from apd_viewer.geometry.measuring.surface_point import SurfacePoint as SurfacePoint
from apd_viewer.geometry.measuring.vessel import Vessel as Vessel
from apd_viewer.geometry.mesh.mesh import Mesh as Mesh
from apd_viewer.geometry.pose.frame import Frame as Frame
from apd_viewer.geometry.solver.convergence import Convergence as Convergence
from apd_viewer.geometry.solver.deformation import Deformation as Deformation
from apd_viewer.geometry.solver.deformation_result import Result as Result
from apd_viewer.geometry.solver.linear_buckling import (
    BucklingModes as BucklingModes,
    buckling_modes as buckling_modes,
)
from apd_viewer.geometry.solver.plate_press import PressStep as PressStep
from apd_viewer.geometry.solver.press_band import PressBand as PressBand, dented_shape as dented_shape
from apd_viewer.geometry.solver.pressed_mesh import Pressed as Pressed, press as press
from apd_viewer.presentation.live_view import LiveView as LiveView, live as live
from apd_viewer.presentation.notebook_deform import deform as deform
