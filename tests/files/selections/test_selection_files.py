"""Selections that are written are read again as they were, in every format that holds them."""

import json
from dataclasses import replace

import igl
import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from painted_meshes import MESH, N, painted

from apd_viewer.__main__ import main
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.selections.selection import LEAST_AREA, MOST_AREA, Selection
from apd_viewer.files.selections.selection_files import (
    SELECTION_FORMATS,
    read_selection_file,
    write_selection,
)
from apd_viewer.files.selections.survey_formats import read_selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import BASE, FREE, HANDLE

WHOLE = (".json", ".npz")


def same(a, b):
    lists = a.handles == b.handles and a.regions == b.regions and a.areas == b.areas
    return lists and np.array_equal(a.labels, b.labels) and np.array_equal(a.member, b.member)


names = st.text(st.characters(exclude_categories=("Cc", "Cs")), min_size=1, max_size=12).filter(str.strip)
percents = st.none() | st.floats(LEAST_AREA, MOST_AREA)


@st.composite
def selections(draw):
    handles = draw(st.lists(names, min_size=1, max_size=8, unique=True))
    regions = draw(st.lists(names, max_size=8, unique=True))
    return Selection(
        draw(arrays(np.uint8, N, elements=st.integers(0, 1 + len(handles)), fill=st.integers(0, 2))),
        draw(arrays(np.uint8, N, elements=st.integers(0, len(regions)))),
        tuple(handles),
        tuple(regions),
        tuple(draw(percents) for _ in regions),
    )


@pytest.mark.parametrize("suffix", WHOLE)
@given(selection=selections())
def test_read_selection_file_brings_everything_back(suffix, selection, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / f"any{suffix}"
    assert write_selection(path, MESH, selection) == ()
    there = read_selection_file(path, MESH)
    assert same(there, selection)
    assert there.is_for_same_mesh
    assert there.labels.dtype == there.member.dtype == np.uint8
    assert not there.labels.flags.writeable
    assert not there.member.flags.writeable


@given(selection=selections())
def test_write_selection_keeps_the_paint_in_a_ply(selection, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "any.ply"
    dropped = write_selection(path, MESH, selection)
    there = read_selection_file(path, MESH)
    np.testing.assert_array_equal(there.labels, selection.labels)
    np.testing.assert_array_equal(there.member, selection.member)
    assert ("region targets" in dropped) == (there.areas != selection.areas[: len(there.areas)])
    assert (dropped == ()) == same(there, selection)
    mesh = open_mesh(path)
    np.testing.assert_array_equal(mesh.V, MESH.V)
    np.testing.assert_array_equal(mesh.F, MESH.F)


@given(selection=selections())
def test_write_selection_keeps_the_labels_in_a_sel(selection, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "any.sel"
    dropped = write_selection(path, MESH, selection)
    np.testing.assert_array_equal(read_selection_file(path, MESH).labels, selection.labels)
    np.testing.assert_array_equal(read_selection(path, N), selection.labels)
    assert ("regions" in dropped) == selection.member.any()


@given(labels=arrays(np.uint8, N, elements=st.integers(0, 4)))
def test_write_selection_keeps_the_labels_in_a_dmat_or_refuses(labels, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "any.dmat"
    held = set(labels[labels != FREE].tolist())
    if held <= {BASE, 2, 3, 4} and sorted(held) == [BASE, 2, 3, 4][: len(held)]:
        assert write_selection(path, MESH, Selection.with_default_names(labels)) == ()
        np.testing.assert_array_equal(read_selection_file(path, MESH).labels, labels)
    else:
        with pytest.raises(InputError, match="labels would change"):
            write_selection(path, MESH, Selection.with_default_names(labels))


@pytest.mark.parametrize(
    ("suffix", "dropped"),
    [
        (".json", ()),
        (".NPZ", ()),
        (".ply", ("handle names", "region names", "region targets")),
        (".sel", ("handle names", "regions")),
        (".dmat", ("handle names", "regions")),
    ],
)
def test_write_selection_says_what_is_left_out(suffix, dropped, tmp_path):
    assert write_selection(tmp_path / f"a{suffix}", MESH, painted()) == dropped
    plain = Selection.with_default_names(painted().labels)
    assert write_selection(tmp_path / f"a{suffix}", MESH, plain) == ()
    spare = replace(plain, handles=("Handle 1", "Handle 2", "Handle 3"))
    without = () if suffix in (".json", ".NPZ") else ("empty handles",)
    assert write_selection(tmp_path / f"a{suffix}", MESH, spare) == without


@pytest.mark.parametrize("suffix", SELECTION_FORMATS)
def test_read_selection_file_brings_back_a_selection_in_which_nothing_is_painted(suffix, tmp_path):
    nothing = Selection.with_default_names(np.full(N, FREE, dtype=np.uint8))
    assert write_selection(tmp_path / f"a{suffix}", MESH, nothing) == ()
    assert same(read_selection_file(tmp_path / f"a{suffix}", MESH), nothing)
    assert nothing.handles == ("Handle 1",)


def test_selection_to_json_is_short_and_says_what_it_is(tmp_path):
    write_selection(tmp_path / "a.json", MESH, painted())
    said = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert said == {
        "format": "apd-selection",
        "version": 1,
        "mesh": {"vertices": N, "faces": len(MESH.F), "digest": MESH.digest},
        "base": [[0, 4], 7],
        "handles": [
            {"name": "Arm", "vertices": [[20, 29]]},
            {"name": "Left leg", "vertices": [31, 33]},
        ],
        "regions": [
            {"name": "Label", "area": 100.0, "vertices": [[3, 8]]},
            {"name": "Größe 👩‍🚀", "area": None, "vertices": [[40, N - 1]]},
        ],
    }


@pytest.mark.parametrize("suffix", WHOLE)
def test_read_selection_file_gives_a_deformed_copy_the_selection_and_knows_that_it_is_one(suffix, tmp_path):
    write_selection(tmp_path / f"a{suffix}", MESH, painted())
    there = read_selection_file(tmp_path / f"a{suffix}", Mesh(2.0 * MESH.V, MESH.F))
    assert same(there, painted())
    assert not there.is_for_same_mesh


def test_selection_dmat_is_what_libigl_reads_and_writes(tmp_path):
    path, groups = tmp_path / "a.dmat", painted().labels.astype(int) - 1
    groups[painted().labels == BASE], groups[painted().labels == FREE] = 0, -1
    write_selection(path, MESH, painted())
    np.testing.assert_array_equal(igl.readDMAT(str(path)).ravel(), groups)
    for ascii_ in (True, False):
        igl.writeDMAT(str(path), groups[:, None].astype(float), ascii_)
        np.testing.assert_array_equal(read_selection_file(path, MESH).labels, painted().labels)


def test_read_dmat_takes_groups_of_others_for_base_and_handles_in_order(tmp_path):
    groups = np.full(N, -1)
    groups[3], groups[4], groups[9] = 2, 7, 5
    (tmp_path / "a.dmat").write_text(f"1 {N}\n" + "\n".join(map(str, groups)))
    labels = read_selection_file(tmp_path / "a.dmat", MESH).labels
    assert labels[[3, 4, 9]].tolist() == [BASE, HANDLE + 1, HANDLE]
    assert (np.delete(labels, [3, 4, 9]) == FREE).all()


PLY = "ply\nformat {} 1.0\nelement vertex 4\nproperty int apd_label\nproperty float x\nproperty float y\n"
PLY += "property float z\nproperty short apd_region\nend_header\n"


@pytest.mark.parametrize("order", ["", "<", ">"])
def test_read_selection_ply_takes_points_of_others(order, tmp_path):
    rows = [(0, 0, 0, 0, 1), (1, 1, 0, 0, 0), (1, 0, 1, 0, 2), (4, 0, 0, 1, 2)]
    kind = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}[order]
    body = "\n".join(" ".join(map(str, row)) for row in rows).encode()
    if order:
        columns = [
            (name, order + kind) for name, kind in zip("lxyzr", ("i4", *3 * ["f4"], "i2"), strict=True)
        ]
        body = np.array(rows, dtype=columns).tobytes()
    (tmp_path / "a.ply").write_bytes(PLY.format(kind).encode() + body)
    tetrahedron = Mesh(np.eye(4, 3), np.array([[0, 1, 2], [0, 2, 3]]))
    there = read_selection_file(tmp_path / "a.ply", tetrahedron)
    assert there.labels.tolist() == [0, 1, 1, 4]
    assert there.member.tolist() == [1, 0, 2, 2]
    assert there.handles == ("Handle 1", "Handle 2", "Handle 3")
    assert (there.regions, there.areas) == (("Region 1", "Region 2"), (None, None))


@pytest.mark.parametrize("suffix", SELECTION_FORMATS)
def test_deform_takes_a_selection_of_every_format(suffix, tmp_path, capsys):
    save_mesh(MESH, MESH.V, tmp_path / "mesh.off")
    mesh = open_mesh(tmp_path / "mesh.off")
    labels = np.where(mesh.V[:, 2] < -0.8, BASE, np.where(mesh.V[:, 2] > 0.8, HANDLE, FREE)).astype(np.uint8)
    write_selection(tmp_path / f"s{suffix}", mesh, Selection.with_default_names(labels))
    (tmp_path / "t.def").write_text("1 0 0 0  0 1 0 0  0 0 1 0.5  0 0 0 1")
    words = [str(tmp_path / name) for name in ("mesh.off", f"s{suffix}", "t.def", "out.off")]
    options = ["--selection", words[1], "--transform", words[2], "-o", words[3]]
    assert main(["deform", words[0], *options, "--method", "arap", "--iterations", "1"]) == 0
    moved = open_mesh(words[3]).V - mesh.V
    np.testing.assert_allclose(moved[labels == HANDLE], [[0, 0, 0.5]] * (labels == HANDLE).sum(), atol=1e-12)
    np.testing.assert_allclose(moved[labels == BASE], 0.0, atol=1e-12)


def test_read_selection_file_takes_any_other_name_for_one_of_the_survey(tmp_path):
    (tmp_path / "labels.txt").write_text("\n".join(map(str, painted().labels)))
    np.testing.assert_array_equal(read_selection_file(tmp_path / "labels.txt", MESH).labels, painted().labels)
