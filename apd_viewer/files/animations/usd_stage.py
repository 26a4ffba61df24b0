"""USD stage of a mesh with a time sample for each shape, by the extra ``usd``.

Shape k is at time code k; the stage plays them in 3 s or more. Vertices and triangles are those of the mesh.
"""

import errno
import re
import tempfile
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdUtils, Vt

from apd_viewer.files.animations.animation_shapes import Animation
from apd_viewer.files.animations.morph_targets import shading_normals, shapes_per_second
from apd_viewer.files.storage.atomic_file import replacing_file

_STAGED_AXES: dict[tuple[float, ...], str] = {(0.0, 1.0, 0.0): "Y", (0.0, 0.0, 1.0): "Z"}  # USD has no others


def write_usd(animation: Animation, path: Path) -> None:
    """Write the shapes as a USD stage of the kind of the suffix, in single precision.

    Points and triangles have the scalars of :class:`apd_viewer.geometry.analysis.scalars.Scalars` as
    primvars; the names of those of triangles begin with ``triangle_``.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    with replacing_file(path) as scratch, tempfile.TemporaryDirectory(prefix="apd-usd-") as folder:
        staged = str(Path(folder, "mesh.usdc"))
        try:
            _write_stage(animation, staged)
            if path.suffix.lower() == ".usdz":
                UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(staged), str(scratch))
            else:
                Sdf.Layer.FindOrOpen(staged).Export(str(scratch))
        except RuntimeError as error:  # raised by the library for all that fails, with a text for developers
            reasons = re.findall(r": '(.+)'", str(error)) or [str(error)]
            raise OSError(errno.EIO, reasons[0]) from error


def _write_stage(animation: Animation, path: str) -> None:
    stage = Usd.Stage.CreateNew(path)
    surface = _empty_surface(animation, stage)
    api = UsdGeom.PrimvarsAPI(surface)
    for k, U in enumerate(animation):
        X, N = _vectors(U), _vectors(shading_normals(animation.mesh, U))
        surface.GetPointsAttr().Set(X, k)
        surface.GetNormalsAttr().Set(N, k)
        surface.GetExtentAttr().Set(UsdGeom.PointBased.ComputeExtent(X), k)
        scalars = animation.scalars(U)
        vertices = scalars.vertices | {"displacement": U - animation.mesh.V}
        for name, values in vertices.items():
            _set_primvar(api, name, "vertex", values, k)
        for name, values in scalars.triangles.items():
            _set_primvar(api, f"triangle_{name}", "uniform", values, k)
        stage.Save()  # what is saved is no longer in memory


def _empty_surface(animation: Animation, stage: Usd.Stage) -> UsdGeom.Mesh:
    """Mesh of a stage without points, upright and in its unit."""
    mesh, frame, last = animation.mesh, animation.up_frame, len(animation) - 1
    axis = _STAGED_AXES.get(tuple(frame[1].tolist()))
    UsdGeom.SetStageMetersPerUnit(stage, animation.metres)
    UsdGeom.SetStageUpAxis(stage, axis or "Y")
    rate = shapes_per_second(len(animation))
    stage.SetTimeCodesPerSecond(rate)
    stage.SetFramesPerSecond(rate)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(last)
    surface = UsdGeom.Mesh.Define(stage, f"/{Tf.MakeValidIdentifier(mesh.stem)}")
    stage.SetDefaultPrim(surface.GetPrim())
    surface.CreateFaceVertexCountsAttr(Vt.IntArray(len(mesh.F), 3))
    surface.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(mesh.F.ravel().astype(np.int32)))
    surface.CreateSubdivisionSchemeAttr("none")
    surface.CreateDoubleSidedAttr(True)
    surface.SetNormalsInterpolation("vertex")
    if axis is None:
        surface.AddTransformOp().Set(Gf.Matrix4d(Gf.Matrix3d(*frame.T.ravel().tolist()), Gf.Vec3d(0.0)))
    return surface


def _set_primvar(api: UsdGeom.PrimvarsAPI, name: str, interpolation: str, values: np.ndarray, k: int) -> None:
    if values.ndim > 1:
        kind, array = Sdf.ValueTypeNames.Vector3fArray, _vectors(values)
    elif np.issubdtype(values.dtype, np.integer):
        kind, array = Sdf.ValueTypeNames.IntArray, Vt.IntArray.FromNumpy(values.astype(np.int32))
    else:
        kind, array = Sdf.ValueTypeNames.FloatArray, Vt.FloatArray.FromNumpy(values.astype(np.float32))
    api.CreatePrimvar(name, kind, interpolation).Set(array, k)


def _vectors(X: np.ndarray) -> object:
    return Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(X, dtype=np.float32))
