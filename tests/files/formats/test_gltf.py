"""What the JSON of a glTF can say that is unusual or wrong; the fuzzer found most of it."""

import base64
import json
import struct

import numpy as np
import pytest
from mesh_contents import BOX, FILES

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh


@pytest.fixture
def document():
    return json.loads(FILES["textured.gltf"])


@pytest.fixture
def opened(tmp_path):
    def write_and_open(said):
        path = tmp_path / "a.gltf"
        path.write_text(said if isinstance(said, str) else json.dumps(said))
        return open_mesh(path)

    return write_and_open


def changed(document, value, *place):
    """Write the value at the place in the document; it is made if it is not there."""
    for key in place[:-1]:
        document = document[key]
    document[place[-1]] = value


WRONG = {
    "a node is its own child": ([1], "nodes", 1, "children", "its nodes do not form a tree"),
    "a node has no number": (["0"], "nodes", 1, "children", "missing from its nodes"),
    "a mesh from behind": (-1, "nodes", 0, "mesh", "a mesh in it is missing or out of range"),
    "no such mesh": (1, "nodes", 0, "mesh", "missing from its meshes"),
    "a matrix with holes": ([1] * 15, "nodes", 0, "matrix", "the matrix of a node does not have 16 numbers"),
    "a matrix of words": (["1"] * 16, "nodes", 0, "matrix", "something other than numbers"),
    "a scale without end": ([1e308] * 3, "nodes", 0, "scale", "something other than numbers"),
    "more than there is": (10**20, "accessors", 0, "count", "a count in it is missing or out of range"),
    "many more than there are": (10_000, "accessors", 0, "count", "it ends within an accessor"),
    "fewer than are used": (len(BOX[0]) - 1, "accessors", 0, "count", "a triangle refers to vertex"),
    "flat positions": ("VEC2", "accessors", 0, "type", "wrong type"),
    "fractions of vertices": (5126, "accessors", 3, "componentType", "wrong type|ends within"),
    "signed vertices": (5122, "accessors", 3, "componentType", "wrong type"),
    "an accessor of a list": ([], "accessors", 0, "bufferView", "missing from its bufferViews"),
    "a buffer elsewhere": (
        "no such.bin",
        "buffers",
        0,
        "uri",
        "the file no such.bin is missing from its folder",
    ),
    "a buffer of no name": ("\0", "buffers", 0, "uri", "the file .* is missing from its folder"),
    "a damaged buffer": ("data:;base64,A", "buffers", 0, "uri", "its embedded coordinates are damaged"),
    "nothing but a number": (7, "meshes", 0, "primitives", "its primitives are not a list"),
}


@pytest.mark.parametrize("name", WRONG)
def test_read_gltf_says_what_is_wrong(name, document, opened):
    value, *place, words = WRONG[name]
    changed(document, value, *place)
    with pytest.raises(InputError, match=words):
        opened(document)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[" * 100_000, "nested too deeply"),
        ('{"a": %s}' % ("9" * 5000), "number out of range"),
        ('{"a": ', "damaged at line 1, column 7"),
        ("[]", "not a glTF document"),
    ],
)
def test_read_gltf_refuses_what_is_no_document(text, words, opened):
    with pytest.raises(InputError, match=words):
        opened(text)


def test_read_gltf_lets_no_triangle_reach_into_the_next_part(document, opened):
    document["meshes"] += [json.loads(json.dumps(document["meshes"][0]))]
    document["nodes"] += [{"mesh": 1}]
    document["scenes"][0]["nodes"] += [2]
    document["accessors"] += [{**document["accessors"][0], "count": 3}]
    document["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 4
    with pytest.raises(InputError, match="a triangle refers to vertex"):
        opened(document)


def test_read_gltf_takes_positions_that_were_rounded_for_fractions_of_the_largest_number(document, opened):
    V = np.array([[0, 0, 0], [32767, 0, 0], [0, -32768, 0]], dtype="<i2")
    blob = np.pad(V, ((0, 0), (0, 1))).tobytes()
    document["buffers"] = [
        {"uri": "data:;base64," + base64.b64encode(blob).decode(), "byteLength": len(blob)}
    ]
    document["bufferViews"] = [{"buffer": 0, "byteStride": 8}]
    told = {"bufferView": 0, "componentType": 5122, "count": 3, "type": "VEC3", "normalized": True}
    document["accessors"] = [told]
    document["meshes"] = [{"primitives": [{"attributes": {"POSITION": 0}}]}]
    document["nodes"], document["scenes"] = [{"mesh": 0}], [{"nodes": [0]}]
    np.testing.assert_array_equal(opened(document).V, [[0, 0, 0], [1, 0, 0], [0, -1, 0]])


def test_read_gltf_finds_a_name_with_a_space_that_is_written_with_a_sign_for_it(document, opened, tmp_path):
    uri = document["buffers"][0]["uri"]
    (tmp_path / "a mesh.bin").write_bytes(base64.b64decode(uri.partition(",")[2]))
    document["buffers"][0]["uri"] = "a%20mesh.bin"
    assert len(opened(document).V) == len(BOX[0])


def test_read_gltf_takes_a_glb_with_its_coordinates_within_its_json(document, tmp_path):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", 4, b"BIN\0") + b"\1\2\3\4"
    path = tmp_path / "a.glb"
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    mesh = open_mesh(path)
    save_mesh(mesh, 1.5 * mesh.V, tmp_path / "b.glb")
    assert np.abs(open_mesh(tmp_path / "b.glb").V - 1.5 * mesh.V).max() < 1e-5
    assert (tmp_path / "b.glb").read_bytes().endswith(b"\1\2\3\4")


def test_gltf_file_cannot_write_what_a_node_flattens(document, opened, tmp_path):
    document["nodes"][0]["scale"] = [1, 0, 1]
    mesh = opened(document)
    save_mesh(mesh, mesh.V, tmp_path / "same.gltf")
    U = mesh.V + np.linspace(0.0, 1.0, len(mesh.V))[:, None]
    with pytest.raises(InputError, match=r"b\.gltf: A node of the file flattens a mesh"):
        save_mesh(mesh, U, tmp_path / "b.gltf")


def test_gltf_file_cannot_write_what_a_node_makes_tiny(document, opened, tmp_path):
    document["nodes"][0]["scale"] = [1e-50] * 3
    mesh = opened(document)
    with pytest.raises(InputError, match=r"b\.gltf: A node of the file scales a mesh to zero"):
        save_mesh(mesh, mesh.V + np.arange(len(mesh.V))[:, None], tmp_path / "b.gltf")


@pytest.mark.parametrize(("accessor", "words"), [(7, "missing from its accessors"), (2, "wrong type")])
def test_gltf_file_notices_normals_that_are_not_understood_when_they_have_to_turn(
    accessor, words, document, opened, tmp_path
):
    document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = accessor
    mesh = opened(document)
    with pytest.raises(InputError, match=f"normals that cannot be updated .*{words}"):
        save_mesh(mesh, 1.5 * mesh.V, tmp_path / "b.gltf")
