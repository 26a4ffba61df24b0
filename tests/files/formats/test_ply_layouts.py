"""PLY as programs write it: strips of triangles, wrapped text, other elements, any line ends."""

import numpy as np
import pytest
from mesh_contents import CUBE, QUADS, ply, strips_ply
from meshes import box, tube
from opened_files import opened, said_of

from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.analysis.inspection import inspect

V, F = box(2, 1, 3)
TEXT = ply(V, F)
HEAD, BODY = (part.decode() for part in TEXT.split(b"end_header\n"))
HEAD += "end_header\n"


def assert_is_the_box(mesh):
    np.testing.assert_array_equal(mesh.V, V)
    np.testing.assert_array_equal(mesh.F, F)
    assert said_of(mesh) == []


# ---- strips


def strips_of_a_tube(around=6, along=4):
    """Strips around an open tube of radius 1, their ends closed, one for each ring of its squares."""
    angle = 2 * np.pi / around * np.arange(around)
    rings = [np.column_stack([np.cos(angle), np.sin(angle), np.full(around, z)]) for z in range(along + 1)]
    strips = []
    for z in range(along):
        pairs = [(z * around + k % around, (z + 1) * around + k % around) for k in range(around + 1)]
        strips.append([k for below, above in pairs for k in (above, below)])
    return np.vstack(rings), strips


def restarted(strips):
    """All strips in one row, with -1 between them."""
    return [[k for strip in strips for k in (*strip, -1)][:-1]]


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("rows", [restarted, list, lambda strips: [[-1, *restarted(strips)[0], -1, -1]]])
def test_read_ply_makes_triangles_of_strips_that_all_look_outwards(kind, rows, tmp_path):
    X, strips = strips_of_a_tube()
    mesh = opened(tmp_path / "a.ply", strips_ply(X, rows(strips), kind))
    found = inspect(mesh)
    assert len(mesh.F) == 2 * 6 * 4
    assert [finding.kind for finding in found.findings] == ["open borders"]
    area_of_hexagon = 6 * np.sqrt(3) / 4
    assert found.volume_capped == pytest.approx(4 * area_of_hexagon)
    # As the rule of OpenGL has it, from the text of the strips.
    first = strips[0]
    np.testing.assert_array_equal(mesh.F[0], first[:3])
    assert set(mesh.F[1]) == set(first[1:4])


def test_read_ply_begins_each_strip_with_a_triangle_as_it_stands(tmp_path):
    """Also after a strip with an odd number of triangles."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    mesh = opened(tmp_path / "a.ply", strips_ply(square, [[0, 1, 2, -1, 2, 1, 3, -1, 0, 1, 2, 3]]))
    assert mesh.F.tolist()[:3] == [[0, 1, 2], [2, 1, 3], [0, 1, 2]]
    assert inspect(mesh).findings[0].kind == "doubled faces"


def test_read_ply_leaves_out_triangles_without_area_that_join_strips(tmp_path):
    X, strips = strips_of_a_tube(6, 2)
    first, second = strips
    joined = [*first, first[-1], second[0], *second]  # an even number in between keeps the sides
    mesh = opened(tmp_path / "a.ply", strips_ply(X, [joined], length="uchar"))
    assert len(mesh.F) == 2 * 6 * 2
    assert [finding.kind for finding in inspect(mesh).findings] == ["open borders"]


def test_read_ply_takes_a_strip_as_long_as_a_scan_has_it(tmp_path):
    X, F_tube = tube(12, 2)
    strip = [k for f in F_tube for k in (*f, -1)] * 400
    assert len(strip) > 1 << 16
    assert len(opened(tmp_path / "a.ply", strips_ply(X, [strip])).F) == 400 * len(F_tube)


def test_read_ply_reads_both_strips_and_faces_of_a_file(tmp_path):
    X, strips = strips_of_a_tube(6, 1)
    below, above = list(range(5, -1, -1)), list(range(6, 12))
    content = strips_ply(X, strips, "ascii", more="element face 2\nproperty list uchar int vertex_index\n")
    faces = "".join(f"6 {' '.join(map(str, face))}\n" for face in (below, above))
    found = inspect(opened(tmp_path / "a.ply", content + faces.encode()))
    assert found.volume == pytest.approx(6 * np.sqrt(3) / 4)
    assert found.findings == ()


# ---- text


def words_a_line(count):
    words = BODY.split()
    return "\n".join(" ".join(words[k : k + count]) for k in range(0, len(words), count)) + "\n"


@pytest.mark.parametrize("count", [1, 2, 3, 5, 7, 10, 10_000])
@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_read_ply_takes_a_text_for_a_stream_of_words_however_it_is_wrapped(count, line_end, tmp_path):
    content = (HEAD + words_a_line(count)).replace("\n", line_end)
    assert_is_the_box(opened(tmp_path / "a.ply", content))


def test_read_ply_passes_over_wrapped_rows_of_other_elements(tmp_path):
    head = HEAD.replace("element vertex", "element camera 1\nproperty list uchar float row\nelement vertex")
    head = head.replace("property double x", "property uchar red\nproperty double x")
    rows = "".join(f"200\n{row}\n" for row in BODY.splitlines()[: len(V)])
    faces = "\n".join(BODY.splitlines()[len(V) :])
    mesh = opened(tmp_path / "a.ply", f"{head}3 0.5\n0.5 1\n{rows}{faces}")
    assert_is_the_box(mesh)
    assert "colours" in mesh.origin.extras


def test_read_ply_shifts_nothing_by_words_beyond_what_a_line_should_have(tmp_path):
    rows = [f"{row} 255 0" for row in BODY.splitlines()[: len(V)]]
    content = HEAD + "\n".join([*rows, *BODY.splitlines()[len(V) :], ""])
    assert_is_the_box(opened(tmp_path / "a.ply", content))


@pytest.mark.parametrize("lost", [1, 2, 3, 4, 30])
def test_read_ply_refuses_a_wrapped_text_that_ends_too_early(lost, tmp_path):
    (tmp_path / "a.ply").write_text(HEAD + "\n".join(BODY.split()[:-lost]))
    with pytest.raises(InputError, match="ends before the last of its"):
        open_mesh(tmp_path / "a.ply")


# ---- headers


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("line_end", [b"\n", b"\r\n", b"\r"])
@pytest.mark.parametrize("name", ["vertex_indices", "vertex_index"])
def test_read_ply_takes_headers_with_any_line_ends_and_remarks(kind, line_end, name, tmp_path):
    head, body = ply(V, F, kind, name=name).split(b"end_header\n")
    head = head.replace(b"comment made in a test", b"comment\ncomment a word\nobj_info num_cols 512")
    content = (head + b"end_header\n").replace(b"\n", line_end) + body
    assert_is_the_box(opened(tmp_path / "a.ply", content))


def test_read_ply_lets_a_row_begin_with_the_byte_of_a_line_end(tmp_path):
    """A line feed after a header whose lines end in carriage returns is no part of the header."""
    X = np.array([[np.frombuffer(b"\n\0\0\0\0\0\xf0?")[0], 0, 0], [1, 0, 0], [0, 1, 0]])
    head, body = ply(X, [[0, 1, 2]], "binary_little_endian").split(b"end_header\n")
    path = tmp_path / "a.ply"
    path.write_bytes((head + b"end_header\n").replace(b"\n", b"\r") + body)
    np.testing.assert_array_equal(open_mesh(path).V, X)


@pytest.mark.parametrize(("tail", "kind"), [(b"tail", "ascii"), (b"\0tail\1", "binary_big_endian")])
def test_read_ply_says_and_keeps_what_stands_behind_the_last_row(tail, kind, tmp_path):
    mesh = opened(tmp_path / "a.ply", ply(3 * CUBE, QUADS, kind) + tail)
    assert inspect(mesh).volume == pytest.approx(1.0)
    (said,) = said_of(mesh)
    assert said.startswith(f"{len(tail)} bytes after the last face")


def test_read_ply_refuses_faces_that_are_all_one_corner_short(tmp_path):
    """Read across the ends of lines they would be others."""
    rows = BODY.splitlines()
    short = [row.rsplit(" ", 1)[0] for row in rows[len(V) :]]
    (tmp_path / "a.ply").write_text(HEAD + "\n".join([*rows[: len(V)], *short, ""]))
    with pytest.raises(InputError):
        open_mesh(tmp_path / "a.ply")
