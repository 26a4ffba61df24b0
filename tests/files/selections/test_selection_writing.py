"""A selection that cannot be written leaves everything as it was."""

import errno
from pathlib import Path

import numpy as np
import pytest
from meshes import box
from painted_meshes import MESH, N, painted

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import Selection
from apd_viewer.files.selections.selection_files import SELECTION_FORMATS, write_selection
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import FREE, HANDLE


@pytest.mark.parametrize("suffix", SELECTION_FORMATS)
def test_write_selection_leaves_all_as_it_was_when_it_cannot_write(suffix, tmp_path, monkeypatch):
    path = tmp_path / f"a{suffix}"
    path.write_text("old")

    def full(self, content):
        with self.open("wb") as stream:
            stream.write(content[: len(content) // 2])
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", full)
        with pytest.raises(InputError, match="No space left"):
            write_selection(path, MESH, painted())
    assert [each.read_text() for each in tmp_path.iterdir()] == ["old"]
    with pytest.raises(InputError, match="cannot be written"):
        write_selection(tmp_path / "gone" / path.name, MESH, painted())
    (tmp_path / f"b{suffix}").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        write_selection(tmp_path / f"b{suffix}", MESH, painted())
    with pytest.raises(InputError, match="has 42 vertices, but the mesh has"):
        write_selection(path, Mesh(*box()), painted())
    assert len(list(tmp_path.iterdir())) == 2


def test_write_selection_needs_a_name_that_names_a_format_and_not_the_mesh(tmp_path):
    with pytest.raises(InputError, match=r"use \.json, \.npz, \.ply, \.sel, \.dmat"):
        write_selection(tmp_path / "a.txt", MESH, painted())
    mesh = Mesh(MESH.V, MESH.F, tmp_path / "a.ply")
    write_selection(mesh.path, mesh, painted())
    with pytest.raises(InputError, match=r"a\.ply is the mesh file"):
        write_selection(mesh.path, mesh, painted())


def test_write_selection_refuses_a_handle_without_a_base_in_a_dmat_and_leaves_nothing(tmp_path):
    labels = np.full(N, FREE, dtype=np.uint8)
    labels[0] = HANDLE
    with pytest.raises(InputError, match=r"a\.dmat cannot store an empty base or handle"):
        write_selection(tmp_path / "a.dmat", MESH, Selection.with_default_names(labels))
    assert list(tmp_path.iterdir()) == []
