"""What is no selection for the mesh is refused in a sentence."""

import io
import json
import zipfile

import numpy as np
import pytest
from meshes import box
from painted_meshes import MESH, N, painted

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection_files import (
    SELECTION_FORMATS,
    read_selection_file,
    write_selection,
)
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import FREE


@pytest.fixture
def refused(tmp_path):
    def check(suffix, content, words):
        path = tmp_path / f"a{suffix}"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(InputError, match=words) as caught:
            read_selection_file(path, MESH)
        said = str(caught.value)
        assert said.startswith(path.name)
        assert said.endswith(".")
        assert said.isprintable()
        assert len(said) < 300

    return check


@pytest.mark.parametrize("suffix", SELECTION_FORMATS)
def test_read_selection_file_refuses_files_that_cannot_be_read_at_all(suffix, tmp_path, refused):
    with pytest.raises(InputError, match=r"There is no file .*gone"):
        read_selection_file(tmp_path / f"gone{suffix}", MESH)
    (tmp_path / f"folder{suffix}").mkdir()
    with pytest.raises(InputError, match=r"folder.* name a file instead"):
        read_selection_file(tmp_path / f"folder{suffix}", MESH)
    with pytest.raises(InputError, match="cannot be read"):
        read_selection_file(tmp_path / f"{'x' * 300}{suffix}", MESH)
    for content in (
        b"",
        b"\0" * 100,
        b"\xff\xfe0\x00",
        bytes(range(256)),
        b"[" * 100_000,
        b"nan",
        b"{}",
        b"PK",
    ):
        refused(suffix, content, ".")


@pytest.mark.parametrize("suffix", SELECTION_FORMATS)
def test_read_selection_file_refuses_another_mesh(suffix, tmp_path):
    write_selection(tmp_path / f"a{suffix}", MESH, painted())
    other = Mesh(*box())
    with pytest.raises(InputError, match=rf"a mesh of {N} vertices, but this mesh has {len(other.V)}"):
        read_selection_file(tmp_path / f"a{suffix}", other)


@pytest.mark.parametrize("suffix", SELECTION_FORMATS)
def test_read_selection_file_refuses_a_file_that_ends_early_wherever_that_is(suffix, tmp_path, refused):
    write_selection(tmp_path / f"whole{suffix}", MESH, painted())
    content = (tmp_path / f"whole{suffix}").read_bytes().rstrip()
    # Of a text in one column the last number may be cut into another one.
    for end in range(0, len(content) - 4, 7):
        refused(suffix, content[:end], ".")


def test_read_json_refuses_a_file_for_other_triangles(tmp_path):
    write_selection(tmp_path / "a.json", MESH, painted())
    with pytest.raises(
        InputError, match=r"a\.json: It is for a mesh of 80 triangles, but this mesh has 79; choose"
    ):
        read_selection_file(tmp_path / "a.json", Mesh(MESH.V, MESH.F[:-1]))


PART = {"name": "A", "area": None, "vertices": [1]}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"format": "gltf"}, "its format is not"),
        ({"format": None}, "its format is not"),
        ({"version": 2}, "version is not supported"),
        ({"mesh": None}, "“mesh” is not a JSON object"),
        ({"mesh": {"vertices": N}}, "numbers of vertices and faces of its mesh are missing"),
        ({"mesh": {"vertices": True, "faces": 80}}, "numbers of vertices and faces of its mesh are missing"),
        (
            {"mesh": {"vertices": N, "faces": 80, "digest": 5}},
            "numbers of vertices and faces of its mesh are missing",
        ),
        ({"mesh": {"vertices": 10**40, "faces": 80}}, "this mesh has 42; choose the file made for this mesh"),
        ({"base": None}, "no list of vertices"),
        ({"base": {"0": 1}}, "no list of vertices"),
        ({"base": ["0"]}, "must be IDs or pairs of IDs"),
        ({"base": [0.5]}, "must be IDs"),
        ({"base": [True]}, "must be IDs"),
        ({"base": [[0, 1, 2]]}, "must be IDs"),
        ({"base": [[]]}, "must be IDs"),
        ({"base": [float("nan")]}, "must be IDs"),
        ({"base": [N]}, r"does not exist \(IDs run from 0 to 41\)"),
        ({"base": [-1]}, "does not exist"),
        ({"base": [10**400]}, "does not exist"),
        ({"base": [[3, 2]]}, "does not exist"),
        ({"base": [[0, 41]] * 100_000}, "lists a vertex twice"),
        ({"base": [1], "handles": [PART]}, "Vertex 1 is in two parts"),
        ({"regions": [PART, PART | {"name": "B"}]}, "Vertex 1 is in two parts"),
        ({"handles": PART}, "“handles” are not a list"),
        ({"handles": ["A"]}, "one of its “handles” is not a JSON object"),
        ({"handles": [{"name": "A"}]}, "no list of vertices"),
        ({"handles": [{"vertices": [1]}]}, "handles has no name"),
        ({"handles": [PART | {"name": ["A"]}]}, "handles has no name"),
        ({"handles": [PART | {"name": "a\nb"}]}, "invalid characters"),
        ({"handles": [PART | {"name": "\ud800"}]}, "invalid characters"),
        ({"handles": [PART] * 9}, "9 handles, but the limit is 8"),
        ({"regions": [PART | {"vertices": []}] * 2}, "regions have the same name"),
        ({"regions": [PART] * 9}, "9 regions, but the limit is 8"),
        ({"regions": [PART | {"area": "100"}]}, "not a percentage"),
        ({"regions": [PART | {"area": float("nan")}]}, "not a percentage"),
        ({"regions": [PART | {"area": 10**400}]}, "not a percentage"),
    ],
)
def test_read_json_refuses_a_wrong_json(change, words, refused):
    good = {"format": "apd-selection", "version": 1, "mesh": {"vertices": N, "faces": len(MESH.F)}}
    refused(".json", json.dumps(good | change), words)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("[]", "it is not a JSON object"),
        ('{"format":\n', "line 2 is not valid JSON"),
        ('{"version": ' + "9" * 5000 + "}", "not valid JSON"),
        ('{"a": ' + "[" * 100_000, "not valid JSON"),
        (b'{"format": "\xff"}', "not text in UTF-8"),
    ],
)
def test_read_json_refuses_what_is_no_json(content, words, refused):
    refused(".json", content, words)


def test_read_json_needs_no_more_than_the_mesh_of_a_file_written_by_hand(tmp_path):
    said = {"format": "apd-selection", "version": 1, "mesh": {"vertices": N, "faces": len(MESH.F)}}
    (tmp_path / "a.json").write_text("\ufeff" + json.dumps(said), encoding="utf-8")
    there = read_selection_file(tmp_path / "a.json", MESH)
    assert (there.labels == FREE).all()
    assert there.is_for_same_mesh


FREE_ALL = np.full(N, FREE)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({}, "no array “labels”"),
        ({"member": FREE_ALL}, "no array “labels”"),
        ({"labels": FREE_ALL[1:]}, "is for a mesh of 41 vertices"),
        ({"labels": FREE_ALL[:, None]}, "not have one number per vertex"),
        ({"labels": FREE_ALL.astype(str)}, "not have one number"),
        ({"labels": FREE_ALL + 9}, r"a label other than 0 \(base\), 1 \(free\) and 2 to 9"),
        ({"labels": FREE_ALL * np.nan}, "a label other than"),
        ({"labels": FREE_ALL * 1e300}, "a label other than"),
        ({"labels": FREE_ALL * 0.5}, "a label other than"),
        ({"labels": FREE_ALL + 256}, "a label other than"),
        ({"labels": FREE_ALL.astype(object)}, "not an NPZ archive, or it is damaged"),
        ({"labels": FREE_ALL, "member": FREE_ALL[1:]}, "41 vertices"),
        ({"labels": FREE_ALL, "member": FREE_ALL + 8}, r"a region other than 0 \(none\) and 1 to 8"),
        (
            {"labels": FREE_ALL, "member": FREE_ALL, "regions": np.array(["A", "A"])},
            "regions have the same name",
        ),
        ({"labels": FREE_ALL + 2, "handles": np.array(["A"])}, "handles has no name"),
        ({"labels": FREE_ALL, "handles": np.array("A")}, "“handles” are not a list of names"),
        ({"labels": FREE_ALL, "handles": np.array([1])}, "“handles” are not a list of names"),
        ({"labels": FREE_ALL, "handles": np.array([2**31 - 1], "u4").view("U1")}, "“handles” are damaged"),
        ({"labels": FREE_ALL, "handles": np.array([0x110000], ">u4").view(">U1")}, "“handles” are damaged"),
        ({"labels": FREE_ALL, "areas": np.array([100.0])}, "not a percentage"),
        ({"labels": FREE_ALL, "regions": np.array(["A"]), "areas": np.array([np.inf])}, "not a percentage"),
        ({"labels": FREE_ALL, "areas": np.array(["A"])}, "“areas” are not a list of numbers"),
        ({"labels": FREE_ALL, "digest": np.array(1)}, "“digest” is not text"),
        ({"labels": np.zeros(1 << 24)}, "would unpack to 134,217,8"),
    ],
)
def test_read_npz_refuses_wrong_arrays(arrays, words, refused):
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    refused(".npz", stream.getvalue(), words)


def test_read_npz_refuses_an_array_that_claims_to_be_enormous(refused):
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<i8", "fortran_order": False, "shape": (1 << 50,)})
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("labels.npy", head.getvalue() + bytes(8 * N))
    refused(".npz", stream.getvalue(), "not an NPZ archive, or it is damaged")


ONES = "\n".join(["1"] * N)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (ONES, "does not start with the numbers of columns and rows"),
        ("0 0\n", "0 columns instead of one"),
        (f"0 0\n1 {N}\n", "it has 0 numbers, but declares 42"),
        (b"0 0\n1 42\n" + bytes(8 * N - 1), "it has 41 numbers"),
        (b"0 0\n1 42\n" + bytes(8 * N + 8), "it has 43 numbers"),
        (b"0 0\n1 42\n" + b"\xff" * 8 * N, "other than -1"),
        (f"{N} 1\n{ONES}", "42 columns instead of one"),
        (f"1 43\n{ONES} 1", "for a mesh of 43 vertices"),
        (f"1 {N}\n{ONES} 1", "it has 43 numbers"),
        (f"1 {N}\n{ONES[2:]}", "it has 41 numbers"),
        (f"1 {'9' * 5000}\n{ONES}", "does not start with"),
        (f"1 -{N}\n{ONES}", "does not start with"),
        (f"1 {N}\n{ONES[2:]}\nfree", "“free” is not a number"),
        *(
            (f"1 {N}\n{ONES[2:]}\n{x}", "other than -1")
            for x in ("-2", "0.5", "nan", "inf", "1e300", "4294967296")
        ),
        (f"1 {N}\n" + "\n".join(map(str, range(N))), "42 groups, but the limit is a base and 8 handles"),
    ],
)
def test_read_dmat_refuses_a_wrong_dmat(content, words, refused):
    refused(".dmat", content, words)


def ply(properties="property int apd_label\n", rows="0 0 0 1\n" * N, n=N, axes="xyz"):
    head = "".join(f"property float {axis}\n" for axis in axes)
    return f"ply\nformat ascii 1.0\nelement vertex {n}\n{head}{properties}end_header\n{rows}"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (ply("", "0 0 0\n" * N), "no integer property “apd_label”; choose a file with a selection"),
        (ply("property float apd_label\n"), "no integer property"),
        (ply("property list uchar int apd_label\n", "0 0 0 1 1\n" * N), "no integer property"),
        (ply("property int apd_region\n"), "no integer property"),
        (ply(rows="0 0 0 10\n" * N), "a label other than"),
        (ply(rows="0 0 0 nan\n" * N), "a label other than"),
        (ply(rows="0 0 0 1e300\n" * N), "a label other than"),
        (ply(rows="0 0 0 one\n" * N), "“one” is not a number"),
        (ply("property int apd_label\nproperty int apd_region\n", "0 0 0 1 9\n" * N), "a region other than"),
        (ply(rows="0 0 0 1\n" * (N - 1)), "it ends before the last of its 42 rows of vertex"),
        (ply(n=N - 1), "is for a mesh of 41 vertices"),
        (ply(n=10**30), "it ends before the last of"),
        (ply(axes="uvw"), "its vertices have no x"),
        ("ply\nformat ascii 1.0\nend_header\n", "it has no vertices"),
        ("ply\nformat ascii 1.0\nelement vert\x1b[31m\nend_header\n", "an invalid line"),
    ],
)
def test_read_selection_ply_refuses_a_wrong_ply(content, words, refused):
    refused(".ply", content, words)
