"""USD stages with time samples, opened again by the library of the extra."""

import tempfile
from contextlib import nullcontext

import numpy as np
import pytest
from animated import animated
from meshes import sphere

from apd_viewer.errors import InputError
from apd_viewer.files.animations import animation_files
from apd_viewer.files.animations.animation_files import USD_FORMATS, check_animation, write_animation
from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import vertex_normals
from apd_viewer.session.model.up_axis import UpAxis

V, F = sphere(1)
LABELS = np.where(V[:, 2] > 0.5, 2, 1).astype(np.uint8)
MEMBER = (V[:, 0] > 0).astype(np.uint8)


def stage_of(path):
    from pxr import Usd

    return Usd.Stage.Open(str(path))


def written(folder, suffix=".usdc", unit="mm", up_axis=UpAxis.PLUS_Y, count=4):
    animation, shapes = animated(Mesh(V, F, unit=unit), folder / "shapes", count, LABELS, MEMBER)
    object.__setattr__(animation, "up_frame", up_axis.frame)
    write_animation(animation, folder / f"a{suffix}")
    return stage_of(folder / f"a{suffix}"), shapes


@pytest.mark.parametrize("suffix", USD_FORMATS)
def test_check_animation_names_the_extra_of_usd_where_it_is_missing(suffix, tmp_path, monkeypatch):
    monkeypatch.setattr(animation_files, "find_spec", {}.get)
    with pytest.raises(InputError, match=r'USD files need more libraries: pip install "apd-viewer\[usd\]"'):
        check_animation(tmp_path / f"a{suffix}")


@pytest.mark.extra
@pytest.mark.parametrize("suffix", USD_FORMATS)
def test_write_usd_writes_each_shape_at_a_time_code_of_its_own(suffix, tmp_path):
    from pxr import UsdGeom

    stage, shapes = written(tmp_path, suffix)
    surface = UsdGeom.Mesh(stage.GetDefaultPrim())
    assert np.array_equal(np.reshape(surface.GetFaceVertexIndicesAttr().Get(), (-1, 3)), F)
    assert set(surface.GetFaceVertexCountsAttr().Get()) == {3}
    assert surface.GetSubdivisionSchemeAttr().Get() == "none"
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 3)
    assert stage.GetTimeCodesPerSecond() == 1.0  # three seconds for three steps
    assert surface.GetPointsAttr().GetTimeSamples() == [0, 1, 2, 3]
    for k, U in enumerate(shapes):
        assert np.array_equal(surface.GetPointsAttr().Get(k), U.astype(np.float32))
        np.testing.assert_allclose(surface.GetNormalsAttr().Get(k), vertex_normals(U, F), atol=1e-6)
        np.testing.assert_allclose(surface.GetExtentAttr().Get(k), [U.min(axis=0), U.max(axis=0)], rtol=1e-6)
    between = np.mean(shapes[1:3], axis=0)
    np.testing.assert_allclose(surface.GetPointsAttr().Get(1.5), between, atol=1e-6)


@pytest.mark.extra
def test_write_usd_writes_the_scalars_of_each_shape_as_primvars(tmp_path):
    from pxr import UsdGeom

    stage, shapes = written(tmp_path)
    api = UsdGeom.PrimvarsAPI(stage.GetDefaultPrim())
    primvars = {each.GetPrimvarName(): each for each in api.GetPrimvarsWithAuthoredValues()}
    for k, U in enumerate(shapes):
        scalars = shape_scalars(Mesh(V, F), U, LABELS, MEMBER)
        vertices = scalars.vertices | {"displacement": U - V}
        triangles = {f"triangle_{name}": values for name, values in scalars.triangles.items()}
        assert set(primvars) - {"normals"} == set(vertices) | set(triangles)
        for name, values in (vertices | triangles).items():
            np.testing.assert_allclose(primvars[name].Get(k), values, rtol=1e-6, atol=1e-6)
            assert primvars[name].GetInterpolation() == ("vertex" if name in vertices else "uniform")


@pytest.mark.extra
@pytest.mark.parametrize("up_axis", UpAxis)
def test_write_usd_stands_upright_by_every_axis(up_axis, tmp_path):
    from pxr import UsdGeom

    stage, _ = written(tmp_path, up_axis=up_axis)
    place = np.array(UsdGeom.Xformable(stage.GetDefaultPrim()).ComputeLocalToWorldTransform(0.0))
    assert np.linalg.det(place) == pytest.approx(1.0)
    up = {"Y": [0, 1, 0], "Z": [0, 0, 1]}[UsdGeom.GetStageUpAxis(stage)]
    np.testing.assert_array_equal(up_axis.direction @ place[:3, :3], up)
    assert (up_axis.value[1] in "YZ" and up_axis.sign > 0) == np.array_equal(place, np.eye(4))


@pytest.mark.extra
@pytest.mark.parametrize(("unit", "metres"), [("", 1.0), ("m", 1.0), ("in", 0.0254), ("mm", 1e-3)])
def test_write_usd_states_a_known_unit(unit, metres, tmp_path):
    from pxr import UsdGeom

    stage, _ = written(tmp_path, unit=unit, count=2)
    assert UsdGeom.GetStageMetersPerUnit(stage) == pytest.approx(metres)


@pytest.mark.extra
def test_write_usd_plays_many_shapes_no_faster_than_24_a_second(tmp_path):
    assert written(tmp_path, count=121)[0].GetTimeCodesPerSecond() == 24.0


@pytest.mark.extra
@pytest.mark.parametrize("suffix", USD_FORMATS)
def test_write_usd_is_valid_by_the_rules_of_its_library(suffix, tmp_path):
    from pxr import UsdValidation

    stage, _ = written(tmp_path, suffix)
    rules = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(rules) > 10
    found = UsdValidation.ValidationContext(rules).Validate(stage)
    assert [each.GetErrorAsString() for each in found] == []


@pytest.mark.extra
def test_write_usd_says_why_a_stage_cannot_be_written_and_keeps_the_file(tmp_path, monkeypatch):
    (tmp_path / "a.usdc").write_bytes(b"before")
    # A folder that is a file, so that nothing can be written into it.
    monkeypatch.setattr(tempfile, "TemporaryDirectory", lambda **_: nullcontext(tmp_path / "a.usdc"))
    animation, _ = animated(Mesh(V, F), tmp_path / "shapes")
    with pytest.raises(InputError, match=r"a\.usdc cannot be written \(.+\); choose another location"):
        write_animation(animation, tmp_path / "a.usdc")
    assert (tmp_path / "a.usdc").read_bytes() == b"before"
