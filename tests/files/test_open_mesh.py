"""Meshes come out of their files vertex for vertex and face for face, whatever way they are written."""

import re

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from mesh_contents import CORNERS, POLYGONS, binary_stl, glb, obj, off, ply, rows, stl
from meshes import box, grid, soup

from apd_viewer.files.formats.polygon_mesh import Polygons
from apd_viewer.files.meshes import open_mesh
from apd_viewer.files.samples import resource_path


def fans(polygons, V=CORNERS):
    """Triangles of the polygons, in the order of the file."""
    return Polygons.from_faces(polygons).triangles(np.array(V))


@pytest.fixture
def opened(tmp_path):
    """Write the content under the name and open it."""

    def write_and_open(name, content):
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return open_mesh(path)

    return write_and_open


def assert_holds(mesh, V, F):
    assert mesh.V.dtype == np.float64
    assert mesh.F.dtype == np.int64
    np.testing.assert_array_equal(mesh.V, V)
    np.testing.assert_array_equal(mesh.F, F)


single = CORNERS.astype("f4").astype(float)  # what single precision keeps of them
WAYS = {
    "plain.obj": (obj(CORNERS, POLYGONS), CORNERS),
    "texture.obj": ("vt 0 0\n" + obj(CORNERS, POLYGONS, "{0}/1"), CORNERS),
    "normal.obj": ("vn 0 0 1\n" + obj(CORNERS, POLYGONS, "{0}//1"), CORNERS),
    "both.obj": ("vn 0 0 1\nvt 0 0\n" + obj(CORNERS, POLYGONS, "{0}/1/1"), CORNERS),
    "negative.obj": (obj(CORNERS, POLYGONS, offset=-len(CORNERS)), CORNERS),
    "negative both.obj": (obj(CORNERS, POLYGONS, "{0}/-1/-1", -len(CORNERS)), CORNERS),
    "tabs.obj": (obj(CORNERS, POLYGONS).replace(" ", "\t"), CORNERS),
    "spaces.obj": (obj(CORNERS, POLYGONS).replace(" ", "   ").replace("\n", "  \n  "), CORNERS),
    "crlf.obj": (obj(CORNERS, POLYGONS).replace("\n", "\r\n"), CORNERS),
    "no last line end.obj": (obj(CORNERS, POLYGONS).rstrip("\n"), CORNERS),
    "colours.obj": (re.sub(r"(?m)^(v .*)$", r"\1 0.5 0.25 1", obj(CORNERS, POLYGONS)), CORNERS),
    "weight.obj": (re.sub(r"(?m)^(v .*)$", r"\1 1.0", obj(CORNERS, POLYGONS)), CORNERS),
    "comments.obj": ("# v 9 9 9\n\n#\n" + obj(CORNERS, POLYGONS).replace("f", "# f 1 2 3\nf"), CORNERS),
    "comments behind.obj": (re.sub(r"(?m)$", " # 1 2 3", obj(CORNERS, POLYGONS)), CORNERS),
    "comment ends in a backslash.obj": ("# C:\\meshes\\\n" + obj(CORNERS, POLYGONS), CORNERS),
    "marked as utf-8.obj": ("\ufeff" + obj(CORNERS, POLYGONS), CORNERS),
    "latin-1.obj": (("# Körper\no Körper\n" + obj(CORNERS, POLYGONS)).encode("latin-1"), CORNERS),
    "continued.obj": (re.sub(r"(?m)^(f \S+ \S+) ", r"\1 \\\n ", obj(CORNERS, POLYGONS)), CORNERS),
    "continued vertices, crlf.obj": (
        re.sub(r"(?m)^(v \S+) ", "\\1\\\\\r\n", obj(CORNERS, POLYGONS)),
        CORNERS,
    ),
    "grouped.obj": (
        "mtllib m.mtl\no one\ng a b\ns off\n"
        + obj(CORNERS, POLYGONS).replace("f", "g next\nusemtl f\ns 1\nf")
        + "l 1 2\np 3\n",
        CORNERS,
    ),
    "plain.off": (off(CORNERS, POLYGONS), CORNERS),
    "head in one line.off": (off(CORNERS, POLYGONS, "OFF "), CORNERS),
    "comments.off": (off(CORNERS, POLYGONS, "# a\nOFF # b\n\n# c\n", " # d"), CORNERS),
    "crlf.off": (off(CORNERS, POLYGONS).replace("\n", "\r\n"), CORNERS),
    "face colours.off": (off(CORNERS, POLYGONS, tail=" 255 0 0"), CORNERS),
    "vertex colours.off": (
        "C" + re.sub(r"(?m)^(\S+\.\S+ \S+ \S+)$", r"\1 255 0 0 255", off(CORNERS, POLYGONS)),
        CORNERS,
    ),
    "ascii.ply": (ply(CORNERS, POLYGONS), CORNERS),
    "crlf.ply": (ply(CORNERS, POLYGONS).replace(b"\n", b"\r\n"), CORNERS),
    "other name.ply": (ply(CORNERS, POLYGONS, name="vertex_index"), CORNERS),
    "colours.ply": (ply(CORNERS, POLYGONS, after="red green blue alpha"), CORNERS),
    "quality first.ply": (ply(CORNERS, POLYGONS, before="quality"), CORNERS),
    "little.ply": (ply(CORNERS, POLYGONS, "binary_little_endian"), CORNERS),
    "big.ply": (ply(CORNERS, POLYGONS, "binary_big_endian"), CORNERS),
    "single.ply": (ply(CORNERS, POLYGONS, "binary_little_endian", "float", after="red green blue"), single),
    "single big.ply": (ply(CORNERS, POLYGONS, "binary_big_endian", "float", before="quality"), single),
}


@pytest.mark.parametrize("name", WAYS)
def test_open_mesh_gives_the_vertices_and_faces_of_the_file(name, opened):
    content, V = WAYS[name]
    assert_holds(opened(name, content), V, fans(POLYGONS))


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("sides", [3, 4, 5])
def test_read_ply_reads_equal_polygons(kind, sides, opened):
    polygons = [[(k + i) % len(CORNERS) for i in range(sides)] for k in range(5)]
    assert_holds(opened("a.ply", ply(CORNERS, polygons, kind)), CORNERS, fans(polygons))


@pytest.mark.parametrize("sides", [3, 4, 5])
def test_read_off_reads_equal_polygons(sides, opened):
    polygons = [[(k + i) % len(CORNERS) for i in range(sides)] for k in range(5)]
    assert_holds(opened("a.off", off(CORNERS, polygons)), CORNERS, fans(polygons))


@pytest.mark.parametrize("suffix", ["obj", "off", "ply"])
@settings(max_examples=15)
@given(
    polygons=st.lists(
        st.lists(st.integers(0, 8), min_size=3, max_size=6, unique=True), min_size=1, max_size=9
    ),
    V=st.lists(st.tuples(*[st.floats(-1e9, 1e9)] * 3), min_size=9, max_size=9),
)
def test_open_mesh_makes_fans_of_any_polygons_in_their_order(suffix, polygons, V, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / f"any.{suffix}"
    content = {"obj": obj, "off": off, "ply": ply}[suffix](np.array(V), polygons)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert_holds(open_mesh(path), V, fans(polygons, V))


def test_read_obj_lets_objects_in_one_file_share_their_numbering(opened):
    V, F = box(1, 1, 1)
    text = "o one\n" + obj(V, F) + "o two\n" + obj(V + 5, F, offset=1 + len(V))
    assert_holds(opened("two.obj", text), np.vstack([V, V + 5]), np.vstack([F, F + len(V)]))


def test_read_obj_reads_faces_whose_corners_are_written_differently(opened):
    text = "".join(f"v {row}\n" for row in rows(CORNERS)) + "f 1/1/1 2 3/1\nf 3/1 5 6/1/1\nf 3//1 5// 6\n"
    assert_holds(opened("mixed.obj", text), CORNERS, [[0, 1, 2], [2, 4, 5], [2, 4, 5]])


def test_read_obj_counts_negative_numbers_back_from_where_they_stand(opened):
    V, F = box(1, 1, 1)
    text = "".join(obj(V + 5 * k, F, offset=-len(V)) for k in range(2))
    assert_holds(opened("two.obj", text), np.vstack([V, V + 5]), np.vstack([F, F + len(V)]))


def test_read_obj_names_a_refused_line_by_its_number_in_the_file(opened):
    text = "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 2 x3\n"
    with pytest.raises(ValueError, match=r"line 5 .*f 1 2 x3"):
        opened("bad.obj", text)


SOUPS = {
    "ascii.stl": lambda V, F: stl(V, F),
    "crlf.stl": lambda V, F: stl(V, F).replace("\n", "\r\n"),
    "capitals.stl": lambda V, F: stl(V, F).upper(),
    "no name.stl": lambda V, F: stl(V, F, ""),
    "named after a keyword.stl": lambda V, F: stl(V, F, "vertex normal facet"),
    "binary.stl": binary_stl,
    "binary that begins like text.stl": lambda V, F: binary_stl(V, F, b"solid made by a test"),
}


@pytest.mark.parametrize("name", SOUPS)
def test_read_stl_keeps_three_vertices_for_every_triangle_and_welds_for_the_solve(name, opened):
    V, F = box(1, 2, 1)
    mesh = opened(name, SOUPS[name](V, F))
    assert_holds(mesh, *soup(V, F))
    assert len(mesh.weld.first) == len(V)
    np.testing.assert_array_equal(mesh.V[mesh.weld.first][mesh.weld.inverse], mesh.V)


def test_read_stl_lets_solids_in_one_file_stand_one_after_the_other(opened):
    V, F = box(1, 1, 1)
    mesh = opened("two.stl", stl(V, F, "one") + stl(V + 5, F, "two"))
    assert_holds(mesh, np.vstack([soup(V, F)[0], soup(V + 5, F)[0]]), np.arange(6 * len(F)).reshape(-1, 3))


def test_read_stl_reads_solids_of_the_same_name(opened):
    V, F = box(1, 1, 1)
    assert len(opened("two.stl", stl(V, F, "a") + stl(V + 5, F, "a")).V) == 6 * len(F)


def test_read_gltf_keeps_unused_and_repeated_vertices_of_a_glb(opened):
    F = np.array(fans(POLYGONS))
    assert_holds(opened("a.glb", glb([(CORNERS, F)])), single, F)


def test_read_gltf_lets_parts_stand_one_after_the_other_each_where_its_node_puts_it(opened):
    F = np.array(fans(POLYGONS))
    mesh = opened("two.glb", glb([(CORNERS, F), (CORNERS, F)], [[0, 0, 0], [16, 0, -4]]))
    assert_holds(mesh, np.vstack([single, single + [16, 0, -4]]), np.vstack([F, F + len(CORNERS)]))


def test_read_ply_does_not_split_vertices_by_texture_coordinates_of_faces(opened, caplog):
    V, F = grid(1, 1)
    text = ply(V, F).decode().replace("comment made in a test", "comment TextureFile not-there.png")
    text = text.replace("end_header", "property list uchar float texcoord\nend_header")
    text = re.sub(r"(?m)^(3 \d \d \d)$", r"\1 6 0 0 0.5 1 1 0", text)
    assert_holds(opened("textured.ply", text), V, F)
    assert not caplog.records  # would be printed


def test_read_ply_reads_a_mesh_with_further_elements(opened):
    V, F = box(1, 1, 1)
    text = ply(V, F).decode()
    text = text.replace(
        "end_header", "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header"
    )
    assert_holds(opened("edges.ply", text + "0 1\n1 2\n"), V, F)


@pytest.mark.parametrize("name", ["bottle", "duck"])
def test_open_mesh_reads_a_sample_as_another_parser_does(name):
    text = resource_path(f"{name}.obj").read_text(encoding="utf-8")
    V = [[float(x) for x in row] for row in re.findall(r"(?m)^v +(\S+) +(\S+) +(\S+)", text)]
    words = re.findall(r"(?m)^f +(\S+) +(\S+) +(\S+) *$", text)
    F = [[int(re.match(r"\d+", word)[0]) - 1 for word in row] for row in words]
    assert_holds(open_mesh(resource_path(f"{name}.obj")), V, F)


def test_open_mesh_gives_arrays_that_are_read_only(opened):
    mesh = opened("a.obj", obj(*box(1, 1, 1)))
    for array in (mesh.V, mesh.F):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1


CONTENTS = {
    "obj": obj(*box(1, 1, 1)),
    "off": off(*box(1, 1, 1)),
    "ply": ply(*box(1, 1, 1)),
    "stl": binary_stl(*box(1, 1, 1)),
    "glb": glb([box(1, 1, 1)]),
}


@pytest.mark.parametrize("name", ["A.{}", "with a space.{}", "Körper 面 и.{}", "two.dots.{}", "~home.{}"])
@pytest.mark.parametrize("suffix", CONTENTS)
def test_open_mesh_takes_all_names_and_capital_suffixes(name, suffix, opened, tmp_path):
    name = name.format(suffix.upper())
    mesh = opened(name, CONTENTS[suffix])
    assert len(mesh.F) == 12
    assert mesh.path == tmp_path / name
    assert mesh.name == name


def test_open_mesh_takes_a_path_that_is_text_and_relative(tmp_path, monkeypatch):
    (tmp_path / "a.ply").write_bytes(CONTENTS["ply"])
    monkeypatch.chdir(tmp_path)
    assert len(open_mesh("a.ply").V) == 8
