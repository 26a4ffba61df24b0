"""What is written is what is read back; a target is the old file or the new one, never a part of it."""

import errno
import os
import stat
from pathlib import Path

import numpy as np
import pytest
import trimesh
from meshes import box, rotation, soup, sphere

import apd_viewer.files.storage.atomic_file
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import WRITABLE_FORMATS, save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.mesh.operators import area

EXACT = (".obj", ".off")


def deformed(V):
    """Other positions, without a round number among them."""
    return V @ rotation((1, 2, 3), 0.7).T * [1.1, 0.9, 1.3] + [0.1, -0.2, 1 / 3]


@pytest.fixture(scope="module")
def ball():
    V, F = sphere(2)
    # A vertex without face and one that repeats another: both have to stay where they are in the order.
    V, F = np.vstack([V[:5], [[3, 3, 3]], V[5:], V[:1]]), np.where(F >= 5, F + 1, F)
    return Mesh(V, F)


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
@pytest.mark.parametrize("unit", [1e-6, 1e-3, 1, 9.999999, 10, 1e6])
def test_save_mesh_writes_what_reading_back_gives(suffix, unit, ball, tmp_path):
    U = unit * deformed(ball.V)
    path = tmp_path / f"out{suffix}"
    save_mesh(ball, U, path)
    back = open_mesh(path)
    V, F = soup(U, ball.F) if suffix == ".stl" else (U, ball.F)
    np.testing.assert_array_equal(back.F, F)
    precision = 1e-14 if suffix in EXACT else 2.0**-24
    np.testing.assert_allclose(back.V, V, rtol=0, atol=precision * np.abs(U).max())
    assert area(back.V, back.F) == pytest.approx(area(U, ball.F), rel=1e-6)


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_save_mesh_writes_what_another_program_reads_the_same(suffix, ball, tmp_path):
    U = deformed(ball.V)
    save_mesh(ball, U, tmp_path / f"out{suffix}")
    other = trimesh.load(tmp_path / f"out{suffix}", process=False, maintain_order=True, force="mesh")
    assert other.area == pytest.approx(area(U, ball.F), rel=1e-6)
    np.testing.assert_allclose(other.triangles, U[ball.F], atol=1e-6)


@pytest.mark.parametrize("suffix", EXACT)
def test_save_mesh_keeps_the_digits_of_small_parts_of_large_coordinates(suffix, tmp_path):
    """Far from the origin, as in maps, all the digits of a double are needed."""
    V, F = box(1, 1, 1)
    U = V / 3 + [4e6, -5e5, 0]
    save_mesh(Mesh(V, F), U, tmp_path / f"out{suffix}")
    np.testing.assert_allclose(open_mesh(tmp_path / f"out{suffix}").V, U, rtol=0, atol=1e-14 * 4e6)


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_save_mesh_writes_positions_that_are_all_zero(suffix, tmp_path):
    mesh = Mesh(*box(1, 1, 1))
    save_mesh(mesh, np.zeros_like(mesh.V), tmp_path / f"out{suffix}")
    assert (open_mesh(tmp_path / f"out{suffix}").V == 0).all()


@pytest.mark.parametrize("suffix", [".stl", ".glb"])
def test_save_mesh_refuses_a_format_that_is_too_coarse_far_from_the_origin(suffix, ball, tmp_path):
    with pytest.raises(InputError, match="cannot store this shape accurately"):
        save_mesh(ball, ball.V + [1e7, 0.0, 0.0], tmp_path / f"out{suffix}")
    assert not list(tmp_path.iterdir())


def test_save_mesh_keeps_a_format_that_was_as_coarse(ball, tmp_path):
    save_mesh(ball, ball.V + [1e3, 0.0, 0.0], tmp_path / "out.stl")
    mesh = open_mesh(tmp_path / "out.stl")
    save_mesh(mesh, mesh.V + [1e6, 0.0, 0.0], tmp_path / "again.stl")


def test_save_mesh_writes_a_soup_in_another_order(tmp_path):
    mesh = Mesh(np.eye(3), np.array([[0, 2, 1]]))
    save_mesh(mesh, mesh.V, tmp_path / "out.stl")
    back = open_mesh(tmp_path / "out.stl")
    np.testing.assert_array_equal(back.V[back.F], mesh.V[mesh.F])


def test_save_mesh_refuses_a_name_with_a_null_character(ball, tmp_path):
    with pytest.raises(InputError, match="null character"):
        save_mesh(ball, ball.V, tmp_path / "a\0.obj")


def test_save_mesh_takes_a_capital_suffix_for_the_same_format(ball, tmp_path):
    for suffix in WRITABLE_FORMATS:
        save_mesh(ball, ball.V, tmp_path / f"a{suffix}")
        save_mesh(ball, ball.V, tmp_path / f"Körper b{suffix.upper()}")
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"Körper b{suffix.upper()}").read_bytes()


def test_save_mesh_takes_a_relative_name_without_folder(ball, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_mesh(ball, ball.V, "out.ply")
    assert len(open_mesh("out.ply").V) == len(ball.V)


def test_save_mesh_leaves_the_positions_alone(ball, tmp_path):
    U = deformed(ball.V)
    before = U.copy()
    U.flags.writeable = False
    for suffix in WRITABLE_FORMATS:
        save_mesh(ball, U, tmp_path / f"out{suffix}")
    np.testing.assert_array_equal(U, before)


# ---- what is refused; the target and its folder stay as they are


@pytest.fixture(params=WRITABLE_FORMATS)
def target(request, tmp_path):
    """An older file, which no failure may touch, alone in its folder."""
    path = tmp_path / f"old{request.param}"
    path.write_text("precious")
    yield path
    assert path.read_text() == "precious"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("shape", [(3, 3), (163, 3), (164, 2), (164,), (3, 164), ()])
def test_save_mesh_refuses_positions_of_another_shape(shape, ball, target):
    assert shape != ball.V.shape
    with pytest.raises(InputError, match="Give 164 positions, one for each vertex"):
        save_mesh(ball, np.ones(shape), target)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_save_mesh_refuses_positions_that_are_no_numbers(value, ball, target):
    U = ball.V.copy()
    U[7, 1] = value
    with pytest.raises(InputError, match="number"):
        save_mesh(ball, U, target)


@pytest.mark.parametrize("suffix", WRITABLE_FORMATS)
def test_save_mesh_refuses_positions_beyond_single_precision(suffix, ball, tmp_path):
    with pytest.raises(
        InputError, match=r"A position of [23](\.\d+)?e\+39 is too large; nothing was written"
    ):
        save_mesh(ball, 1e39 * ball.V, tmp_path / f"out{suffix}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["out.xyz", "out", "out.obj.bak", ".obj"])
def test_save_mesh_refuses_names_without_a_format(name, ball, tmp_path):
    with pytest.raises(InputError, match=r"does not have a supported ending; use \.obj, .*\.glb"):
        save_mesh(ball, ball.V, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_save_mesh_refuses_a_missing_folder(ball, tmp_path):
    with pytest.raises(InputError, match=r"There is no folder .*gone"):
        save_mesh(ball, ball.V, tmp_path / "gone" / "out.obj")
    assert list(tmp_path.iterdir()) == []


def test_save_mesh_refuses_a_folder_in_place_of_the_file(ball, tmp_path):
    (tmp_path / "out.obj").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        save_mesh(ball, ball.V, tmp_path / "out.obj")
    assert [path.name for path in tmp_path.iterdir()] == ["out.obj"]


def test_save_mesh_refuses_a_folder_that_may_not_be_written_to(ball, target, monkeypatch):
    def denied(*args, **kwargs):  # root may write everywhere, so permissions cannot be taken away here
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(apd_viewer.files.storage.atomic_file.tempfile, "mkstemp", denied)
    with pytest.raises(InputError, match=r"old\.\w+ cannot be written \(Permission denied\)"):
        save_mesh(ball, ball.V, target)


def test_save_mesh_changes_nothing_on_a_disk_that_is_full_when_the_file_is_flushed(ball, target, monkeypatch):
    def full(descriptor):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(InputError, match="No space left on device"):
        save_mesh(ball, ball.V, target)


def test_save_mesh_changes_nothing_on_a_disk_that_is_full_in_the_middle_of_the_file(ball, target):
    resource = pytest.importorskip("resource", reason="Windows has no limits of file sizes")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))  # the kernel refuses the 1001st byte
    try:
        with pytest.raises(InputError, match="cannot be written"):
            save_mesh(ball, ball.V, target)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


@pytest.mark.parametrize("error", [RuntimeError, MemoryError, KeyboardInterrupt])
def test_save_mesh_changes_nothing_when_a_writer_breaks_off_in_the_middle(error, ball, target, monkeypatch):
    def break_off(self, path=None, **kwargs):
        if path is not None:
            Path(path).write_bytes(b"half")
        raise error

    monkeypatch.setattr(trimesh.Trimesh, "export", break_off)
    with pytest.raises(error):
        save_mesh(ball, ball.V, target)


# ---- permissions

posix = pytest.mark.skipif(os.name != "posix", reason="POSIX permissions")


@posix
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o755])
def test_save_mesh_keeps_the_permissions_of_a_replaced_file(mode, ball, tmp_path):
    path = tmp_path / "out.obj"
    path.touch()
    path.chmod(mode)
    save_mesh(ball, ball.V, path)
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert len(open_mesh(path).V) == len(ball.V)


@posix
@pytest.mark.parametrize("umask", [0o022, 0o077, 0o002])
def test_save_mesh_gives_a_new_file_the_usual_permissions(umask, ball, tmp_path):
    before = os.umask(umask)
    try:
        save_mesh(ball, ball.V, tmp_path / "out.off")
        assert os.umask(umask) == umask  # and what is usual stays as it was
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "out.off").stat().st_mode) == 0o666 & ~umask
