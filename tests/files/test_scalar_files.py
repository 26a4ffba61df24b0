"""Scalars in files: what is read is what was written."""

import csv

import numpy as np
import pytest
from meshes import sphere

from apd_viewer.errors import InputError
from apd_viewer.files.formats.ply import read_ply
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.scalar_files import ScalarRows, write_scalars
from apd_viewer.files.selections.selection_files import read_selection_file
from apd_viewer.geometry.analysis.scalars import shape_scalars
from apd_viewer.geometry.mesh.mesh import Mesh

V, F = sphere(1)
V = np.vstack([V, [[2.0, 0.0, 0.0]]])  # a loose vertex
MESH = Mesh(V, F)
U = V * [1.0, 1.2, 0.9]
LABELS = np.where(V[:, 2] > 0.5, 2, 1).astype(np.uint8)
LABELS[V[:, 2] < -0.5] = 0
MEMBER = (V[:, 0] > 0).astype(np.uint8)


@pytest.fixture(scope="module")
def scalars():
    return shape_scalars(MESH, U, LABELS, MEMBER)


def table(path):
    with path.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


def test_write_scalars_writes_a_table_of_vertices_that_comes_back(scalars, tmp_path):
    write_scalars(tmp_path / "s.csv", MESH, U, scalars)
    read = table(tmp_path / "s.csv")
    assert np.array_equal(read.pop("vertex"), np.arange(len(V)))
    assert np.array_equal(np.column_stack([read.pop(axis) for axis in "xyz"]), U)
    assert list(read) == list(scalars.vertices)
    for name, column in scalars.vertices.items():
        np.testing.assert_array_equal(read[name], column)


def test_write_scalars_writes_a_table_of_triangles_that_comes_back(scalars, tmp_path):
    write_scalars(tmp_path / "s.csv", MESH, U, scalars, ScalarRows.TRIANGLES)
    read = table(tmp_path / "s.csv")
    assert np.array_equal(read.pop("triangle"), np.arange(len(F)))
    assert np.array_equal(np.column_stack([read.pop(corner) for corner in "abc"]), F)
    for name, column in scalars.triangles.items():
        np.testing.assert_array_equal(read[name], column)


def test_write_scalars_writes_a_ply_with_the_shape_the_selection_and_all_scalars(scalars, tmp_path):
    path = tmp_path / "s.ply"
    write_scalars(path, MESH, U, scalars)
    mesh = open_mesh(path)
    assert np.array_equal(mesh.V, U)
    assert np.array_equal(mesh.F, F)
    selection = read_selection_file(path, MESH)
    assert np.array_equal(selection.labels, LABELS)
    assert np.array_equal(selection.member, MEMBER)
    file = read_ply(path.read_bytes()).origin
    read = file.columns(0, tuple(scalars.vertices))
    np.testing.assert_array_equal(read, np.column_stack(list(scalars.vertices.values())))
    names = [name for name, _, _ in file.elements[1].properties]
    assert names == ["vertex_indices", *scalars.triangles]


def test_write_scalars_refuses_another_kind_of_file(scalars, tmp_path):
    with pytest.raises(InputError, match=r"use the ending \.csv or \.ply"):
        write_scalars(tmp_path / "s.obj", MESH, U, scalars)
