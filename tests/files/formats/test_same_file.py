"""A mesh goes back into its file: only coordinates change there, and the normals that hang on them."""

import json
import re
import struct

import numpy as np
import pytest
from mesh_contents import BOX, FILES, TWO_MATERIALS, bent, gltf_of, ply
from meshes import rotation

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh


@pytest.fixture(params=FILES)
def file(request, tmp_path):
    path = tmp_path / request.param
    path.write_bytes(FILES[request.param])
    return path


def test_save_mesh_without_a_change_writes_the_same_file(file, tmp_path):
    mesh = open_mesh(file)
    save_mesh(mesh, mesh.V, tmp_path / f"out{file.suffix}")
    assert (tmp_path / f"out{file.suffix}").read_bytes() == file.read_bytes()


def test_save_mesh_writes_what_was_asked_in_the_same_order(file, tmp_path):
    mesh = open_mesh(file)
    U = bent(mesh.V)
    out = tmp_path / f"out{file.suffix}"
    save_mesh(mesh, U, out)
    again = open_mesh(out)
    exact = file.suffix in (".obj", ".off") or file.name in ("text.ply", "text.stl", "little.ply", "big.ply")
    assert np.abs(again.V - U).max() <= (0.0 if exact and file.name != "mixed.ply" else 2e-6)
    np.testing.assert_array_equal(again.F, mesh.F)
    # And back, over the file itself.
    save_mesh(again, mesh.V, out)
    assert np.abs(open_mesh(out).V - mesh.V).max() <= (0.0 if exact else 2e-6)


def test_save_mesh_leaves_what_did_not_move_as_it_stood(file, tmp_path):
    """The lines or bytes of one vertex, and of what hangs on it, differ; nothing else."""
    mesh = open_mesh(file)
    out = tmp_path / f"out{file.suffix}"
    save_mesh(mesh, bent(mesh.V, [1]), out)
    before, after = file.read_bytes(), out.read_bytes()
    if file.suffix in (".obj", ".off") or b"ascii" in before[:40] or before.startswith(b"solid"):
        a, b = (re.split(rb"\r\n|\n|\r", content) for content in (before, after))
        assert len(a) == len(b)
        changed = [(x, y) for x, y in zip(a, b, strict=True) if x != y]
        own = {".stl": 2, ".obj": 3}.get(file.suffix, len(mesh.V) * (6 if file.name == "wrapped.ply" else 1))
        assert 1 <= len(changed) <= own
        for x, y in changed:
            number = rb"[-+]?[0-9.]+(e[-+]?[0-9]+)?"
            assert re.sub(number, b"#", x) == re.sub(number, b"#", y), "only numbers are others"
    elif file.suffix in (".ply", ".stl"):
        a, b = (np.frombuffer(content, np.uint8) for content in (before, after))
        assert len(a) == len(b)
        where = np.flatnonzero(a != b)
        start = 84 if file.suffix == ".stl" else before.index(b"end_header\n") + 11
        size = {"binary.stl": 50, "float.ply": 8 * 12, "mixed.ply": 8 * 24}.get(file.name, 8 * 41)
        assert len(where)
        assert start <= where.min() <= where.max() < start + size


def test_save_mesh_leaves_the_numbers_that_are_not_coordinates(tmp_path):
    def written(name, U_of=bent):
        (tmp_path / name).write_bytes(FILES[name])
        mesh = open_mesh(tmp_path / name)
        save_mesh(mesh, U_of(mesh.V), tmp_path / f"out {name}")
        return mesh, (tmp_path / f"out {name}").read_bytes()

    _, text = written("two materials.obj")
    assert text.count(b"\r\n") == TWO_MATERIALS.count(b"\r\n")
    assert text.count(b"\n") == TWO_MATERIALS.count(b"\n")
    assert text.count(b"0.1 0.2 0.3") == 5
    for line in TWO_MATERIALS.split(b"\r\n"):
        if not line.startswith((b"v ", b"vn ", b"v\t", b"  1.5")):
            assert line in text.split(b"\r\n")
    for order, sign in (("little", "<"), ("big", ">")):
        _, after = written(f"{order}.ply")
        before = FILES[f"{order}.ply"]
        start = before.index(b"end_header\n") + 11
        table = np.dtype(
            [("red", "u1"), ("xyz", sign + "f8", 3), ("quality", sign + "f4"), ("n", sign + "f4", 3)]
        )
        a, b = (np.frombuffer(content, table, 8, start) for content in (before, after))
        assert (a["red"] == b["red"]).all()
        assert (a["quality"] == b["quality"]).all()
        assert before[:start] == after[:start]
        assert before[start + 8 * table.itemsize :] == after[start + 8 * table.itemsize :]
    _, after = written("binary.stl")
    assert after[:84] == FILES["binary.stl"][:84]


def test_save_mesh_turns_normals_with_the_surface(tmp_path):
    R = rotation((1, 2, 3), 0.8)
    for name in (
        "two materials.obj",
        "text.ply",
        "little.ply",
        "normals.off",
        "textured.glb",
        "text.stl",
        "binary.stl",
    ):
        (tmp_path / name).write_bytes(FILES[name])
        mesh = open_mesh(tmp_path / name)
        save_mesh(mesh, mesh.V @ R.T, tmp_path / f"out {name}")
        before, after = (normals((tmp_path / n).read_bytes(), name) for n in (name, f"out {name}"))
        if name.endswith(".stl"):  # made anew, of the triangles
            corners = (mesh.V @ R.T)[mesh.F]
            across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            expected = across / np.linalg.norm(across, axis=1, keepdims=True)
        else:
            expected = before @ R.T
        assert np.abs(after - expected).max() < 1e-5, name


def normals(content, name):
    if name.endswith(".obj"):
        return np.array(
            [[float(w) for w in line.split()[1:4]] for line in content.splitlines() if line.startswith(b"vn")]
        )
    if name == "text.stl":
        return np.array(
            [
                [float(w) for w in line.split()[2:5]]
                for line in content.splitlines()
                if b"facet normal" in line
            ]
        )
    if name == "binary.stl":
        return np.frombuffer(content, np.dtype([("n", "<f4", 3), ("x", "<f4", 9), ("a", "<u2")]), offset=84)[
            "n"
        ].astype(float)
    if name == "normals.off":
        return np.array([[float(w) for w in line.split()[3:6]] for line in content.splitlines()[1:9]])
    if name == "text.ply":
        rows = content.split(b"end_header\n")[1].splitlines()[:8]
        return np.array([[float(w) for w in line.split()[5:8]] for line in rows])
    if name == "little.ply":
        table = np.dtype([("red", "u1"), ("xyz", "<f8", 3), ("q", "<f4"), ("n", "<f4", 3)])
        return np.frombuffer(content, table, 8, content.index(b"end_header\n") + 11)["n"].astype(float)
    (length,) = struct.unpack_from("<I", content, 12)
    count = len(BOX[0])
    local = np.ndarray((count, 3), "<f4", content, 28 + length + 12, (32, 4)).astype(float)
    world = np.array([[0.28, 0, 0.96], [0, 1, 0], [-0.96, 0, 0.28]])  # of the node
    return local @ world.T


def test_save_mesh_gives_a_glb_the_bounds_of_its_positions(tmp_path):
    (tmp_path / "a.glb").write_bytes(FILES["textured.glb"])
    mesh = open_mesh(tmp_path / "a.glb")
    save_mesh(mesh, bent(mesh.V), tmp_path / "b.glb")
    content = (tmp_path / "b.glb").read_bytes()
    (length,) = struct.unpack_from("<I", content, 12)
    document = json.loads(content[20 : 20 + length])
    stored = np.ndarray((len(mesh.V), 3), "<f4", content, 28 + length, (32, 4))
    assert np.array_equal(np.float32(document["accessors"][0]["min"]), stored.min(axis=0))
    assert np.array_equal(np.float32(document["accessors"][0]["max"]), stored.max(axis=0))
    before = json.loads(
        FILES["textured.glb"][20 : 20 + struct.unpack_from("<I", FILES["textured.glb"], 12)[0]]
    )
    for accessors in (before, document):
        del accessors["accessors"][0]["min"], accessors["accessors"][0]["max"]
    assert before == document
    assert struct.unpack_from("<I", content, 8) == (len(content),)
    assert content.endswith(b"MORE" + b"abcd")


def test_save_mesh_lets_one_mesh_in_two_places_only_move_alike(tmp_path):
    document = json.loads(gltf_of(FILES["textured.glb"]))
    document["nodes"] += [{"mesh": 0, "translation": [0, 9, 0]}]
    document["scenes"][0]["nodes"].append(2)
    path = tmp_path / "twice.gltf"
    path.write_text(json.dumps(document))
    mesh = open_mesh(path)
    n = len(BOX[0])
    assert len(mesh.V) == 2 * n
    save_mesh(mesh, mesh.V, tmp_path / "same.gltf")
    U = mesh.V.copy()
    U[0] += 0.1
    with pytest.raises(InputError, match="several places"):
        save_mesh(mesh, U, tmp_path / "other.gltf")
    assert not (tmp_path / "other.gltf").exists()
    save_mesh(mesh, U, tmp_path / "other.glb")


def test_save_mesh_cannot_make_others_of_whole_numbers(tmp_path):
    V = np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0], [0, 0, 5]])
    F = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    path = tmp_path / "whole.ply"
    path.write_bytes(ply(V, F).replace(b"double", b"int").replace(b".0", b""))
    mesh = open_mesh(path)
    with pytest.raises(InputError, match="integer coordinates"):
        save_mesh(mesh, mesh.V * 1.01, tmp_path / "out.ply")


def test_save_mesh_writes_another_format_anew(tmp_path):
    (tmp_path / "a.obj").write_bytes(TWO_MATERIALS)
    mesh = open_mesh(tmp_path / "a.obj")
    assert set(mesh.origin.extras) == {
        "texture coordinates",
        "normals",
        "materials",
        "groups",
        "smoothing groups",
        "vertex colours",
    }
    save_mesh(mesh, bent(mesh.V), tmp_path / "b.off")
    np.testing.assert_allclose(open_mesh(tmp_path / "b.off").V, bent(mesh.V), atol=1e-14)
    assert Mesh(mesh.V, mesh.F).origin is None
