"""Normals of the corners, read from each format that has them."""

import numpy as np
import pytest
import trimesh
from meshes import box

from apd_viewer.files.meshes import open_mesh

V, F = box()


def drawn_at_rest(mesh):
    """Normals of the corners, (m, 3, 3), of a mesh at rest."""
    a, b, c = mesh.V[mesh.F].transpose(1, 0, 2)
    along, normal = b - a, np.cross(b - a, c - a)
    along, normal = (X / np.linalg.norm(X, axis=1, keepdims=True) for X in (along, normal))
    frames = np.stack([along, np.cross(normal, along), normal], axis=1)
    return np.einsum("tji,tcj->tci", frames, mesh.corner_normals.local)


@pytest.mark.parametrize("corner", ["{v}//{n}", "{v}/{v}/{n}", "-{back}//{n}"])
def test_obj_file_has_normals_by_corner(tmp_path, corner):
    N = np.random.default_rng(0).standard_normal((len(F), 3))
    rows = [f"v {x} {y} {z}" for x, y, z in V] + [f"vt {x} {y}" for x, y, _ in V]
    rows += [f"vn {x} {y} {z}" for x, y, z in N]
    for n, face in enumerate(F, start=1):
        rows.append("f " + " ".join(corner.format(v=v + 1, n=n, back=len(V) - v) for v in face))
    path = tmp_path / "box.obj"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    expected = np.repeat((N / np.linalg.norm(N, axis=1, keepdims=True))[:, None], 3, axis=1)
    np.testing.assert_allclose(drawn_at_rest(open_mesh(path)), expected, atol=1e-6)


@pytest.mark.parametrize("suffix", ["ply", "glb"])
def test_open_mesh_reads_normals_by_vertex_from_ply_and_gltf_files(tmp_path, suffix):
    N = np.random.default_rng(1).standard_normal(V.shape)
    N /= np.linalg.norm(N, axis=1, keepdims=True)
    path = tmp_path / f"box.{suffix}"
    made = trimesh.Trimesh(V, F, vertex_normals=N, process=False)
    path.write_bytes(made.export(file_type=suffix, **{"vertex_normal": True} if suffix == "ply" else {}))
    mesh = open_mesh(path)
    np.testing.assert_allclose(drawn_at_rest(mesh), N[mesh.F], atol=1e-5)
    moved = mesh.baked(mesh.V * 2.0)
    assert moved.corner_normals is mesh.corner_normals


@pytest.mark.parametrize("words", ["", "vn 0 0 0\n", "vn nan 0 1\n", "vn 0 0 x\n"])
def test_corner_normals_that_are_unusable_are_none(tmp_path, words):
    path = tmp_path / "one.obj"
    corner = "{0}//1" if words else "{0}"
    face = " ".join(corner.format(k) for k in (1, 2, 3))
    path.write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\n{words}f {face}\n", encoding="utf-8")
    assert open_mesh(path).corner_normals is None
