"""GLB with morph targets, by its own words, by trimesh and by VTK."""

import json
import struct

import numpy as np
import pytest
import trimesh
from animated import animated
from meshes import box, soup, sphere
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkGLTFReader

from apd_viewer.errors import InputError
from apd_viewer.files.animations import morph_targets
from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.animations.morph_targets import shading_normals
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.normals import vertex_normals

V, F = sphere(1)
WIDTH = {"SCALAR": 1, "VEC3": 3}
KIND = {5126: "<f4", 5125: "<u4"}


@pytest.fixture
def written(tmp_path):
    animation, shapes = animated(Mesh(V, F), tmp_path / "shapes")
    write_animation(animation, tmp_path / "a.glb")
    return tmp_path / "a.glb", shapes


def chunks(path):
    """The document of a GLB, and its accessors as arrays."""
    content = path.read_bytes()
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", content)
    assert (magic, version, length, kind) == (b"glTF", 2, len(content), b"JSON")
    document = json.loads(content[20 : 20 + size])
    rest, binary = struct.unpack_from("<I4s", content, 20 + size)
    assert binary == b"BIN\0"
    assert rest == document["buffers"][0]["byteLength"] == length - 28 - size
    assert size % 4 == rest % 4 == 0
    arrays = []
    for accessor in document["accessors"]:
        view = document["bufferViews"][accessor["bufferView"]]
        start = 28 + size + view["byteOffset"]
        X = np.frombuffer(content[start : start + view["byteLength"]], KIND[accessor["componentType"]])
        X = X.reshape(accessor["count"], WIDTH[accessor["type"]])
        if "min" in accessor:
            assert X.min(axis=0).tolist() == accessor["min"]
            assert X.max(axis=0).tolist() == accessor["max"]
        arrays.append(X)
    return document, arrays


@pytest.mark.parametrize(("unit", "metres"), [("", 1.0), ("m", 1.0), ("in", 0.0254), ("mm", 1e-3)])
def test_write_morph_targets_makes_metres_of_a_known_unit(unit, metres, tmp_path):
    animation, shapes = animated(Mesh(V, F, unit=unit), tmp_path / "shapes")
    write_animation(animation, tmp_path / "a.glb")
    np.testing.assert_allclose(open_mesh(tmp_path / "a.glb").V, metres * shapes[0], atol=1e-6 * metres)


def test_write_morph_targets_writes_each_shape_as_the_first_and_its_target(written):
    path, shapes = written
    document, arrays = chunks(path)
    (surface,) = document["meshes"][0]["primitives"]
    assert np.array_equal(arrays[surface["indices"]].reshape(-1, 3), F)
    first, normals = (arrays[surface["attributes"][name]] for name in ("POSITION", "NORMAL"))
    assert len(surface["targets"]) == len(shapes) - 1
    for U, target in zip(shapes, [None, *surface["targets"]], strict=True):
        X = first + (0.0 if target is None else arrays[target["POSITION"]])
        N = normals + (0.0 if target is None else arrays[target["NORMAL"]])
        np.testing.assert_allclose(X, U, atol=1e-6 * np.abs(U).max())
        np.testing.assert_allclose(N, vertex_normals(U, F), atol=1e-6)


def test_write_morph_targets_has_weights_lead_straight_from_shape_to_shape(written):
    path, shapes = written
    document, arrays = chunks(path)
    (sampler,) = document["animations"][0]["samplers"]
    assert document["animations"][0]["channels"] == [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]
    times, weights = arrays[sampler["input"]].ravel(), arrays[sampler["output"]].reshape(len(shapes), -1)
    np.testing.assert_allclose(times, np.arange(len(shapes)), rtol=1e-6)  # three seconds for three steps
    assert np.array_equal(weights, np.vstack([np.zeros(len(shapes) - 1), np.eye(len(shapes) - 1)]))
    assert sampler["interpolation"] == "LINEAR"


def test_write_morph_targets_plays_many_shapes_no_faster_than_24_a_second(tmp_path):
    animation, _ = animated(Mesh(V, F), tmp_path / "shapes", count=121)
    write_animation(animation, tmp_path / "a.glb")
    document, arrays = chunks(tmp_path / "a.glb")
    times = arrays[document["animations"][0]["samplers"][0]["input"]]
    assert times[-1] == pytest.approx(5.0)


def test_write_morph_targets_lets_trimesh_and_the_program_itself_read_the_first_shape(written):
    path, shapes = written
    for mesh in (trimesh.load(path, process=False, force="mesh"), open_mesh(path)):
        X, T = (mesh.vertices, mesh.faces) if isinstance(mesh, trimesh.Trimesh) else (mesh.V, mesh.F)
        np.testing.assert_allclose(X, shapes[0], atol=1e-6)
        assert np.array_equal(T, F)


def test_write_morph_targets_lets_vtk_play_all_shapes(written):
    path, shapes = written
    reader = vtkGLTFReader()
    reader.SetFileName(str(path))
    reader.SetApplyDeformationsToGeometry(True)
    reader.UpdateInformation()
    assert reader.GetNumberOfAnimations() == 1
    reader.EnableAnimation(0)
    for time, U in enumerate(shapes):
        reader.UpdateTimeStep(float(time))
        blocks = reader.GetOutput().NewIterator()
        data = blocks.GetCurrentDataObject()
        X = vtk_to_numpy(data.GetPoints().GetData())
        np.testing.assert_allclose(X, U, atol=1e-5 * np.abs(U).max())
        corners = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        assert np.array_equal(corners, F)


def test_shading_normals_are_smooth_across_a_seam(tmp_path):
    """Vertices at one place have one normal, where the file has none."""
    X, T = soup(V, F)
    mesh = Mesh(X, T)
    U = X * [1.0, 2.0, 0.5]
    N = shading_normals(mesh, U)
    np.testing.assert_allclose(N, vertex_normals(V * [1.0, 2.0, 0.5], F)[F.ravel()], atol=1e-12)


def test_shading_normals_turn_the_creases_of_a_file_along(tmp_path):
    """A box with a normal for each face keeps them, and turned by a quarter they turn too."""
    X, T = soup(*box(1, 1, 1))
    flat = trimesh.Trimesh(
        X, T, vertex_normals=np.repeat(vertex_normals(X, T)[::3], 3, axis=0), process=False
    )
    flat.export(tmp_path / "box.glb", include_normals=True)
    mesh = open_mesh(tmp_path / "box.glb")
    assert mesh.corner_normals is not None
    R = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    faces = np.cross(*(mesh.V[mesh.F[:, k]] - mesh.V[mesh.F[:, 0]] for k in (1, 2)))
    faces = np.repeat(faces / np.linalg.norm(faces, axis=1, keepdims=True), 3, axis=0)
    np.testing.assert_allclose(shading_normals(mesh, mesh.V)[mesh.F.ravel()], faces, atol=1e-6)
    np.testing.assert_allclose(shading_normals(mesh, mesh.V @ R.T)[mesh.F.ravel()], faces @ R.T, atol=1e-6)


def test_shading_normals_have_a_direction_where_there_is_no_area(tmp_path):
    mesh = Mesh(np.vstack([V, [[5.0, 0.0, 0.0]]]), F)
    N = shading_normals(mesh, mesh.V)
    np.testing.assert_allclose(np.linalg.norm(N, axis=1), 1.0)


def test_write_morph_targets_refuses_what_is_too_long_for_the_format(tmp_path, monkeypatch):
    animation, _ = animated(Mesh(V, F), tmp_path / "shapes")
    monkeypatch.setattr(morph_targets, "LARGEST_FILE", 5_000)
    with pytest.raises(InputError, match=r"a\.glb would be longer than 4 GiB; use fewer steps"):
        write_animation(animation, tmp_path / "a.glb")
    assert not (tmp_path / "a.glb").exists()


def test_save_mesh_lets_an_animation_be_deformed_again(written, tmp_path):
    """Its mesh comes back as the same file: with its targets, which the promise of the format wants."""
    path, _ = written
    mesh = open_mesh(path)
    save_mesh(mesh, mesh.V + [1.0, 0.0, 0.0], tmp_path / "b.glb")
    (_, before), (_, after) = chunks(path), chunks(tmp_path / "b.glb")
    assert len(before) == len(after)
    np.testing.assert_allclose(after[1], before[1] + [1.0, 0.0, 0.0], atol=1e-6)


def test_write_morph_targets_writes_the_vertex_scalars_of_the_last_shape(tmp_path):
    labels = np.where(V[:, 2] > 0.5, 2, 1).astype(np.uint8)
    animation, shapes = animated(Mesh(V, F), tmp_path / "shapes", labels=labels)
    write_animation(animation, tmp_path / "a.glb")
    mesh = trimesh.load(tmp_path / "a.glb", process=False, force="mesh")
    scalars = shape_scalars(Mesh(V, F), shapes[-1], labels, animation.member).vertices
    expected = {f"_{name.upper()}": values for name, values in scalars.items()}
    assert len(expected) == 7
    assert set(mesh.vertex_attributes) == set(expected)
    for name, values in expected.items():
        found = mesh.vertex_attributes[name].reshape(values.shape)
        np.testing.assert_allclose(found, values, rtol=1e-6, atol=1e-6)
