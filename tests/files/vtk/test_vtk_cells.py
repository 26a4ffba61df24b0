"""Cells of VTK become triangles as VTK makes them, or a sentence says what to do first."""

import time

import numpy as np
import pytest
import pyvista
from mesh_contents import BOX, CUBE, QUADS, legacy_vtk, vtp
from meshes import tube

from apd_viewer.__main__ import main
from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import dropped_contents, save_mesh, suffix_for
from apd_viewer.files.meshes import open_mesh


def area_vectors(V, F):
    return np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])


def opened(path, content):
    path.write_bytes(content)
    return open_mesh(path)


def test_read_vtp_and_read_vtk_turn_strips_as_vtk_does(tmp_path):
    ball = pyvista.PolyData.from_regular_faces(*tube(8, 5))
    stripped = ball.strip()
    assert stripped.n_strips > 1
    for name in ("in.vtp", "in.vtk"):
        stripped.save(tmp_path / name)
        mesh = open_mesh(tmp_path / name)
        own, theirs = area_vectors(mesh.V, mesh.F), stripped.triangulate()
        faces = theirs.faces.reshape(-1, 4)[:, 1:]
        expected = area_vectors(np.asarray(theirs.points, dtype=float), faces)
        np.testing.assert_allclose(own, expected, atol=1e-6)


def test_read_vtu_and_read_vtk_take_pixels_strips_and_lines_of_a_grid(tmp_path):
    points = np.array([[x, y, 0.0] for y in (0, 1) for x in (0, 1, 2, 3)])
    # A line, a pixel, a strip of three triangles, a vertex.
    cells = [2, 0, 1, 4, 0, 1, 4, 5, 5, 1, 5, 2, 6, 3, 1, 7]
    grid = pyvista.UnstructuredGrid(np.array(cells), np.array([3, 8, 6, 1]), points)
    for name in ("in.vtu", "in.vtk"):
        grid.save(tmp_path / name)
        mesh = open_mesh(tmp_path / name)
        area = area_vectors(mesh.V, mesh.F)[:, 2]
        assert len(area) == 5
        assert np.abs(area).sum() == pytest.approx(2 * (1.0 + 1.5))
        assert (area[:2] > 0).all(), "a pixel is no bow tie"
        assert (area[2:] < 0).all() or (area[2:] > 0).all()


def test_read_vtp_makes_one_mesh_of_several_pieces(tmp_path):
    one = vtp(CUBE, QUADS).decode()
    start, end = one.index("<Piece"), one.index("</PolyData>")
    both = one[:end] + one[start:end].replace("0.3333333333333333", "0.5") + one[end:]
    mesh = opened(tmp_path / "two.vtp", both.encode())
    assert len(mesh.V) == 2 * len(CUBE)
    assert len(mesh.F) == 4 * len(QUADS)
    assert np.array_equal(mesh.F[len(mesh.F) // 2 :] - len(CUBE), mesh.F[: len(mesh.F) // 2])
    U = mesh.V.copy()
    U[-1] += 0.25
    save_mesh(mesh, U, tmp_path / "out.vtp")
    changed = [
        (a, b)
        for a, b in zip(both.split(), (tmp_path / "out.vtp").read_text().split(), strict=True)
        if a != b
    ]
    assert changed == [("0.5", "0.75")] * 3


@pytest.mark.parametrize("form", ["ascii", "binary"])
@pytest.mark.parametrize(
    "inside", ["<InformationKey name='a'/>", "<InformationKey name='a' ></InformationKey >"]
)
@pytest.mark.parametrize("behind", [False, True])
def test_text_span_finds_values_before_or_behind_what_is_said_of_them(form, inside, behind, tmp_path):
    content = vtp(CUBE, QUADS, form)
    array = content.index(b'Name="Points"')
    place = content.index(b"</", array) if behind else content.index(b">", array) + 1
    mesh = opened(tmp_path / "in.vtp", content[:place] + inside.encode() + content[place:])
    assert np.array_equal(mesh.V, CUBE)
    save_mesh(mesh, mesh.V + 1.0, tmp_path / "out.vtp")
    assert np.array_equal(open_mesh(tmp_path / "out.vtp").V, CUBE + 1.0)
    assert inside in (tmp_path / "out.vtp").read_text()


def test_vtk_xml_file_names_a_place_of_data_that_is_none_where_it_matters(tmp_path):
    content = vtp(*BOX, "appended", compressed=True)
    layer = content.index(b'Name="layer"')
    place = content.index(b'offset="', layer) + len(b'offset="')
    mesh = opened(tmp_path / "in.vtp", content[:place] + b"x" + content[place + 1 :])
    with pytest.raises(InputError, match="opened is damaged"):
        save_mesh(mesh, mesh.V + np.pi, tmp_path / "out.vtp")
    assert not (tmp_path / "out.vtp").exists()
    save_mesh(mesh, mesh.V + np.pi, tmp_path / "out.obj")


def test_dropped_contents_names_what_another_format_loses(tmp_path, capsys):
    mesh = opened(tmp_path / "in.vtp", vtp(CUBE, QUADS))
    assert dropped_contents(mesh, "out.obj") == ("point data (heat)", "cell data (layer)")
    assert dropped_contents(mesh, "out.vtp") == ()
    assert suffix_for(mesh) == ".vtp"
    legacy = opened(tmp_path / "in.vtk", legacy_vtk(CUBE, QUADS))
    assert dropped_contents(legacy, "out.obj") == ("field data", "point data")
    assert main(["info", str(tmp_path / "in.vtp")]) == 0
    assert "in.vtp: 8 vertices, 12 triangles" in capsys.readouterr().out


REFUSED = {
    "entities.vtp": (
        vtp(CUBE, QUADS).replace(b"<VTKFile", b'<!DOCTYPE a [<!ENTITY b "c">]><VTKFile', 1),
        "declares a document type",
    ),
    "grid.vtu": (vtp(CUBE, QUADS), "rename it to end in .vtp"),
    "pieces.vtp": (b'<VTKFile type="PPolyData"><PPolyData/></VTKFile>', "holds no surface of its own"),
    "blocks.vtu": (b'<VTKFile type="vtkMultiBlockDataSet"></VTKFile>', "holds no surface of its own"),
    "page.vtp": (b"<html><body>not found</body></html>", "holds a web page and no mesh"),
    "letter.vtp": (b"To whom it may concern", "line 1 of its XML is damaged"),
    "encoding.vtp": (
        b'<?xml version="1.0" encoding="utf-9"?><VTKFile type="PolyData"/>',
        "encoding of its XML is not supported",
    ),
    "letter.vtk": (b"To whom it may concern", "does not start with a VTK header"),
    "image.vtk": (
        legacy_vtk(CUBE, QUADS).replace(b"POLYDATA", b"STRUCTURED_POINTS"),
        "extract the surface first",
    ),
    "points.vtk": (legacy_vtk(CUBE, QUADS).split(b"POLYGONS")[0], "No faces"),
    "millions.vtk": (
        legacy_vtk(CUBE, QUADS, binary=True).replace(b"POINTS 8", b"POINTS 8000000000"),
        "ends early",
    ),
    "millions text.vtk": (legacy_vtk(CUBE, QUADS).replace(b"POINTS 8", b"POINTS 800000000"), "ends early"),
    "endless number.vtk": (legacy_vtk(CUBE, QUADS).replace(b"POINTS 8", b"POINTS " + b"9" * 5000), "whole"),
    "negative.vtk": (legacy_vtk(CUBE, QUADS).replace(b"4 0 2 3 1", b"4 0 2 -3 1"), "out of range"),
    "missing.vtp": (vtp(CUBE, QUADS).replace(b"0 2 3 1", b"0 2 3 8", 1), "out of range"),
    "offsets.vtp": (vtp(CUBE, QUADS).replace(b"4 8 12", b"4 2 12"), "do not fit"),
    "fraction.vtp": (vtp(CUBE, QUADS).replace(b"0 2 3 1", b"0 2 3.5 1", 1), "fractional numbers"),
    "points.vtp": (vtp(CUBE, QUADS).replace(b'Points="8"', b'Points="9"'), "differs from what it declares"),
    "many points.vtp": (
        vtp(CUBE, QUADS).replace(b'Points="8"', b'Points="99999999999"'),
        "differs from what",
    ),
    "cut.vtp": (vtp(CUBE, QUADS, "appended")[:1000], "ends early|are missing|is missing|damaged"),
    "far.vtp": (
        vtp(CUBE, QUADS, "appended").replace(b'offset="', b'offset="99999999'),
        "ends early",
    ),
    "deep.vtp": (b"<VTKFile>" + b"<a>" * 200_000, "cannot be understood"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_open_mesh_refuses_vtk_files_of_no_surface_in_a_sentence(name, tmp_path):
    content, words = REFUSED[name]
    with pytest.raises(InputError, match=words) as refused:
        opened(tmp_path / name, content)
    assert str(refused.value).endswith(".")


def huge(content, sizes):
    """The file with other sizes at the beginning of the array of its points."""
    at = content.index(b"\n_") + 2
    offset = int(content.split(b'Name="Points"')[1].split(b'offset="')[1].split(b'"')[0])
    return content[: at + offset] + sizes + content[at + offset + len(sizes) :]


@pytest.mark.parametrize("size", [2**31, 2**32 - 1])
def test_xml_arrays_refuse_absurd_sizes_of_appended_arrays(size, tmp_path):
    word = np.uint32(size).tobytes()
    with pytest.raises(InputError, match="ends early"):
        opened(tmp_path / "a.vtp", huge(vtp(CUBE, QUADS, "appended"), word))
    packed = vtp(*BOX, "appended", compressed=True)
    for sizes, words in (
        (word, "ends early"),
        (np.uint32([1, 32768, size]).tobytes(), "at least"),
        (np.uint32([1, 32768, 96, size]).tobytes(), "ends early"),
    ):
        with pytest.raises(InputError, match=words):
            opened(tmp_path / "b.vtp", huge(packed, sizes))


def test_xml_arrays_refuse_one_array_that_is_named_a_thousand_times(tmp_path):
    for compressed, words in ((False, "overlap"), (True, "overlap|at least")):
        V = np.zeros((20_000, 3))
        V[:3] = np.eye(3)
        text = vtp(V, [[0, 1, 2]], "appended", compressed)
        start, end = text.index(b"<Piece"), text.index(b"</PolyData>")
        with pytest.raises(InputError, match=words):
            opened(tmp_path / "many.vtp", text[:end] + 1000 * text[start:end] + text[end:])


def test_open_mesh_refuses_long_vtk_files_of_nothing_in_no_time(tmp_path):
    """Patterns that look on to the end of the file from every place in it would take minutes."""
    legacy = legacy_vtk(CUBE, QUADS)
    head = legacy.split(b"FIELD")[0]
    fields = b"FIELD a 100000\n" + 100_000 * b"a 1 1 int\n1\nMETADATA\nINFORMATION 0\n\n"
    for name, content in (
        ("a.vtp", 200_000 * b"<AppendedData "),
        ("b.vtp", b"<VTKFile>" + b"<AppendedData>" + b" " * 3_000_000),
        ("c.vtk", head + fields),
        ("d.vtk", head + b"\n" * 3_000_000 + b"NAME L2_NORM_" * 200_000),
    ):
        began = time.process_time()
        with pytest.raises(InputError):
            opened(tmp_path / name, content)
        assert time.process_time() - began < 10.0


def test_check_types_says_of_volume_and_curved_cells_what_to_do_first(tmp_path):
    solid = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    curved = pyvista.UnstructuredGrid(np.array([6, 0, 1, 2, 3, 4, 5]), np.array([22]), np.eye(6, 3))
    for grid, words in ((solid, "extract its surface first"), (curved, "make triangles first")):
        for name in ("in.vtu", "in.vtk"):
            grid.save(tmp_path / name)
            with pytest.raises(InputError, match=words):
                open_mesh(tmp_path / name)


@pytest.mark.parametrize("suffix", [".pvd", ".pvtu", ".pvtp", ".vtm", ".VTM"])
def test_open_mesh_does_not_follow_files_that_refer_to_others(suffix, tmp_path):
    path = tmp_path / f"set{suffix}"
    inside = '<Collection><DataSet file="/etc/passwd"/></Collection>'
    path.write_text(f'<VTKFile type="Collection">{inside}</VTKFile>')
    with pytest.raises(InputError, match="refers to other files"):
        open_mesh(path)
