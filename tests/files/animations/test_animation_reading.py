"""Animations read again: what was written comes back, and what is damaged is said so."""

import json
import struct

import numpy as np
import pytest
from animated import animated
from fuzz import check_sentence
from gltf_scenes import GltfScene
from mesh_contents import binary_stl, obj
from meshes import box, sphere

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.animations.animation_reading import open_animation, read_point_cache
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

V, F = sphere(1)
TWICE = 2 * '<DataSet timestep="0" file="b.vtu"/>'


def written(folder, name, mesh=None, count=4):
    """An animation in a file, and its shapes."""
    animation, shapes = animated(mesh or Mesh(V, F), folder / "shapes", count)
    write_animation(animation, folder / name)
    return folder / name, shapes


def with_document(path, change):
    """A GLB with its document changed."""
    content = path.read_bytes()
    (size,) = struct.unpack_from("<I", content, 12)
    document = json.loads(content[20 : 20 + size])
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIII4s", b"glTF", 2, len(content) - size + len(text), len(text), b"JSON")
    path.write_bytes(head + text + content[20 + size :])


def test_open_animation_reads_a_series_to_the_bit(tmp_path):
    path, shapes = written(tmp_path, "a & b.pvd", count=12)
    mesh, read = open_animation(path)
    assert np.array_equal(mesh.F, F)
    assert mesh.path == tmp_path / "a & b" / "a & b-00.vtu"
    read = list(read)
    assert read[0] is mesh.V
    assert np.array_equal(read, shapes)


def test_open_animation_reads_a_series_in_the_order_of_time(tmp_path):
    path, shapes = written(tmp_path, "a.pvd", count=3)
    rows = path.read_text().splitlines(keepends=True)
    path.write_text("".join([*rows[:3], *rows[5:2:-1], *rows[6:]]))
    assert path.read_text().index('timestep="1.0"') < path.read_text().index('timestep="0.0"')
    assert np.array_equal(list(open_animation(path).shapes), shapes)


@pytest.mark.parametrize("unit", ["", "mm"])
def test_open_animation_reads_morph_targets_in_single_precision(tmp_path, unit):
    path, shapes = written(tmp_path, "a.glb", Mesh(V, F, unit=unit))
    mesh, read = open_animation(path)
    read = list(read)
    assert read[0] is mesh.V
    metres = 1e-3 if unit else 1.0
    for U, X in zip(read, shapes, strict=True):
        np.testing.assert_allclose(U, metres * X, atol=1e-6 * metres * np.abs(X).max())


def test_open_animation_goes_along_the_weights_whatever_leads_from_key_to_key(tmp_path):
    path, _ = written(tmp_path, "a.glb")
    shapes = list(open_animation(path).shapes)
    with_document(path, lambda d: d["animations"][0]["samplers"][0].update(interpolation="STEP"))
    assert np.array_equal(list(open_animation(path).shapes), shapes)


def test_open_animation_goes_straight_between_the_keys_of_another_node(tmp_path):
    """One goes up and down in three keys; two have keys at the ends only, one of them with tangents."""
    scene, up = GltfScene(), np.array([0.0, 0.0, 1.0])
    target = {"POSITION": scene.accessor(np.tile(up, (len(V), 1)))}
    samplers, channels = [], []
    keys = (
        ([0, 1, 2], [0, 1, 0], "LINEAR"),
        ([0, 2], [0, 1], "LINEAR"),
        ([0, 2], [7, 0, 7, 7, 1, 7], "CUBICSPLINE"),
        ([0, 2], [0, 1], "STEP"),
    )
    for k, (times, weights, kind) in enumerate(keys):
        scene.node(mesh=scene.mesh(V, F, targets=[target]))
        samplers.append(
            {"input": scene.accessor(times), "output": scene.accessor(weights), "interpolation": kind}
        )
        channels.append({"sampler": k, "target": {"node": k, "path": "weights"}})
    scene.document["animations"] = [{"samplers": samplers, "channels": channels}]
    path = scene.write(tmp_path / "a.gltf")
    rest = open_mesh(path).V
    moved = [(U - rest).reshape(4, -1, 3).mean(axis=1)[:, 2] for U in open_animation(path).shapes]
    np.testing.assert_allclose(moved, [[0, 0, 0, 0], [1, 0.5, 0.5, 0], [0, 1, 1, 1]], atol=1e-6)


def test_open_animation_of_a_mesh_has_no_shapes(tmp_path):
    for name in ("a.glb", "a.obj"):
        save_mesh(Mesh(V, F), V, tmp_path / name)
        mesh, shapes = open_animation(tmp_path / name)
        assert len(mesh.V) == len(V)
        assert list(shapes) == []


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("no series", "not a valid PVD"),
        ("<VTKFile/>", "lists no files"),
        ('<VTKFile><DataSet timestep="x" file="b.vtu"/></VTKFile>', "not a valid PVD"),
        ('<VTKFile><DataSet file="b.vtu"/></VTKFile>', r"b\.vtu, which a\.pvd refers to, is missing"),
        ('<VTKFile><DataSet file="../b.vtu"/></VTKFile>', "outside its folder"),
        ('<VTKFile><DataSet file="a.pvd"/></VTKFile>', "refers to other files"),
        (TWICE, "not a valid PVD"),
        (f"<VTKFile>{TWICE}</VTKFile>", "several files at one time"),
    ],
)
def test_open_animation_says_what_is_wrong_with_a_series(tmp_path, content, said):
    (tmp_path / "a.pvd").write_text(content)
    with pytest.raises(InputError, match=said):
        open_animation(tmp_path / "a.pvd")


def test_open_animation_refuses_a_series_of_several_meshes(tmp_path):
    path, _ = written(tmp_path, "a.pvd", count=3)
    other, _ = written(tmp_path, "b.pvd", Mesh(*box(2, 2, 2)))
    (tmp_path / "a" / "a-1.vtu").write_bytes((other.parent / "b" / "b-1.vtu").read_bytes())
    with pytest.raises(InputError, match=r"a-1\.vtu in a\.pvd has other triangles"):
        list(open_animation(path).shapes)


def test_open_animation_refuses_a_series_with_other_numbers_of_vertices(tmp_path):
    """One that no triangle has may be in some files only."""
    for name, points in (("a", "0 0 0 1 0 0 0 1 0 5 5 5"), ("b", "0 0 0 1 0 0 0 1 0")):
        rows = f"<Points><DataArray type='Float64' NumberOfComponents='3'>{points}</DataArray></Points>"
        cells = "".join(
            f"<DataArray type='Int64' Name='{key}'>{values}</DataArray>"
            for key, values in (("connectivity", "0 1 2"), ("offsets", "3"))
        )
        count = len(points.split()) // 3
        (tmp_path / f"{name}.vtp").write_text(
            f"<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='{count}' NumberOfPolys='1'>"
            f"{rows}<Polys>{cells}</Polys></Piece></PolyData></VTKFile>"
        )
    series = "".join(f"<DataSet timestep='{k}' file='{name}.vtp'/>" for k, name in enumerate("ab"))
    (tmp_path / "s.pvd").write_text(f"<VTKFile><Collection>{series}</Collection></VTKFile>")
    with pytest.raises(InputError, match=r"b\.vtp in s\.pvd has other triangles"):
        list(open_animation(tmp_path / "s.pvd").shapes)


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d["animations"][0]["samplers"].clear(),
        lambda d: d["animations"][0]["samplers"][0].update(interpolation="CUBICSPLINE"),
        lambda d: d["animations"][0]["samplers"][0].update(input=99),
        lambda d: d["animations"][0]["channels"][0]["target"].update(node=7),
    ],
)
def test_open_animation_says_that_the_keys_of_a_glb_are_damaged(tmp_path, change):
    path, _ = written(tmp_path, "a.glb", count=5)
    with_document(path, change)
    with pytest.raises(InputError, match="not a valid GLB file"):
        list(open_animation(path).shapes)


@pytest.mark.parametrize("suffix", [".pc2", ".mdd"])
def test_read_point_cache_brings_the_shapes_of_every_format_back(tmp_path, suffix):
    loose = np.vstack([[9.0, 9.0, 9.0], V])
    for name, content in (("a.stl", binary_stl(V, F)), ("a.obj", obj(loose, F + 1).encode())):
        (tmp_path / name).write_bytes(content)
        mesh = open_mesh(tmp_path / name)
        path, shapes = written(tmp_path, f"a{suffix}", mesh)
        used = np.unique(mesh.F)
        for U, X in zip(read_point_cache(path, mesh), shapes, strict=True):
            np.testing.assert_allclose(U[used], X[used], rtol=1e-6, atol=1e-6)
            assert np.array_equal(np.delete(U, used, axis=0), np.delete(mesh.V, used, axis=0))


def test_read_point_cache_refuses_another_mesh_and_damaged_files(tmp_path):
    for suffix in (".pc2", ".mdd"):
        path, _ = written(tmp_path, f"a{suffix}")
        with pytest.raises(InputError, match=r"42 points, and .* open the mesh that it was written of"):
            list(read_point_cache(path, Mesh(*box(1, 1, 1))))
        content = path.read_bytes()
        for damaged in (content[:-1], content[:7], b"", bytes(len(content))):
            path.write_bytes(damaged)
            with pytest.raises(InputError, match="is not a valid") as refused:
                list(read_point_cache(path, Mesh(V, F)))
            check_sentence(refused.value)
