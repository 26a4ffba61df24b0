"""Point caches, read again by the words of their formats alone."""

import struct

import numpy as np
import pytest
from animated import animated, read_pc2
from mesh_contents import binary_stl, obj, ply
from meshes import box, sphere

from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.meshes import open_mesh, read_mesh
from apd_viewer.geometry.mesh.mesh import Mesh

V, F = sphere(1)


def read_mdd(content):
    """Times (s,) and shapes (s, k, 3) of an MDD."""
    frames, points = struct.unpack_from(">ii", content)
    assert len(content) == 8 + 4 * frames + 12 * points * frames
    times = np.frombuffer(content, ">f4", frames, offset=8)
    return times, np.frombuffer(content, ">f4", offset=8 + 4 * frames).reshape(frames, points, 3)


def caches(animation, folder):
    """The shapes of both formats, written and read again."""
    for suffix in (".pc2", ".mdd"):
        write_animation(animation, folder / f"a{suffix}")
    times, shapes = read_mdd((folder / "a.mdd").read_bytes())
    np.testing.assert_allclose(np.diff(times), 1 / 24, rtol=1e-6)
    assert times[0] == 0.0
    return read_pc2(folder / "a.pc2"), shapes


def test_point_cache_has_each_vertex_where_it_was_in_single_precision(tmp_path):
    animation, shapes = animated(Mesh(V, F), tmp_path / "shapes")
    for read in caches(animation, tmp_path):
        assert np.array_equal(read, np.array(shapes, dtype=np.float32))


def opened(folder, name, content):
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return open_mesh(folder / name)


def test_blender_vertex_order_of_a_ply_is_its_own_though_some_vertices_coincide(tmp_path):
    twice = np.vstack([V[::-1], V])  # each place twice, half of them in no face
    mesh = opened(tmp_path, "a.ply", ply(twice, F + len(V)))
    animation, shapes = animated(mesh, tmp_path / "shapes")
    for read in caches(animation, tmp_path):
        assert np.array_equal(read, np.array(shapes, dtype=np.float32))


def test_blender_vertex_order_of_an_obj_leaves_out_vertices_without_a_face(tmp_path):
    """As Blender does; the others keep their order."""
    loose = np.vstack([[9.0, 9.0, 9.0], V[:5], [8.0, 8.0, 8.0], V[5:]])
    kept = np.setdiff1d(np.arange(len(loose)), [0, 6])
    mesh = opened(tmp_path, "a.obj", obj(loose, kept[F]))
    animation, shapes = animated(mesh, tmp_path / "shapes")
    for read in caches(animation, tmp_path):
        assert np.array_equal(read, np.array(shapes, dtype=np.float32)[:, kept])


def test_blender_vertex_order_of_an_stl_has_its_corners_joined_in_the_order_of_their_coming(tmp_path):
    V, F = box(2, 2, 2)
    mesh = opened(tmp_path, "a.stl", binary_stl(V, F))
    animation, shapes = animated(mesh, tmp_path / "shapes")
    seen = {}
    for k, corner in enumerate(mesh.V.tolist()):
        seen.setdefault(tuple(corner), k)
    assert len(seen) == len(V) < len(mesh.V)
    for read in caches(animation, tmp_path):
        assert np.array_equal(read, np.array(shapes, dtype=np.float32)[:, list(seen.values())])


def test_blender_vertex_order_of_a_baked_shape_is_that_of_its_file(tmp_path):
    V, F = box(2, 2, 2)
    mesh = opened(tmp_path, "a.stl", binary_stl(V, F))
    flat = mesh.V * [1.0, 1.0, 0.0]  # where corners coincide that do not in the file
    flat.flags.writeable = False
    animation, _ = animated(mesh.baked(flat), tmp_path / "shapes")
    assert caches(animation, tmp_path)[0].shape[1] == len(V)


def test_write_animation_leaves_what_was_there_when_it_cannot_write(tmp_path):
    animation, _ = animated(Mesh(V, F), tmp_path / "shapes")
    animation.files[2].unlink()
    for name in ("a.pc2", "a.mdd", "a.glb"):
        (tmp_path / name).write_text("old")
        with pytest.raises((InputError, FileNotFoundError)):
            write_animation(animation, tmp_path / name)
        assert (tmp_path / name).read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.glb", "a.mdd", "a.pc2", "shapes"]


def test_blender_vertex_order_of_a_mesh_without_a_file_has_all_its_vertices(tmp_path):
    loose = np.vstack([V, [[3.0, 0.0, 0.0]]])
    mesh = read_mesh(tmp_path / "a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    for each in (Mesh(loose, F), mesh):
        animation, _ = animated(each, tmp_path / "shapes")
        assert np.array_equal(animation.blender_vertex_order, np.arange(len(each.V)))
