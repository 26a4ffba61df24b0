"""Wall distributions from files: tables, PLY and VTK, and sentences on those that do not fit."""

import json
import pickle
import struct
from itertools import pairwise

import numpy as np
import pytest
import pyvista
from meshes import box, grid, tube

from apd_viewer import deform
from apd_viewer.errors import InputError
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.quantities.units import NoUnitError, Unit
from apd_viewer.session.quantities.wall import WallText, parse_thickness, parse_wall, with_part_thickness
from apd_viewer.session.quantities.wall_distribution import (
    ColorScaleError,
    distribution_file,
    read_distribution,
    thickness_text,
    write_distribution,
)

V, F = tube(12, 6, height=3.0)
MESH = Mesh(V, F)
THICK = 0.02 + 0.01 * V[:, 2]
OF_TRIANGLES = THICK[F].mean(axis=1)


def written(folder, text, name="walls.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def table(heading, *columns, comma=","):
    rows = [heading, *(comma.join(map(str, row)) for row in zip(*columns, strict=True))]
    return "\n".join(rows)


def read(folder, text, unit=Unit.NONE, mesh=MESH):
    return read_distribution(written(folder, text), mesh, unit)


@pytest.mark.parametrize(
    "text",
    [
        table("vertex,thickness", range(len(V)), THICK),
        table("index,thickness", range(len(V))[::-1], THICK[::-1]),
        table("Triangle,Thickness", range(len(F)), OF_TRIANGLES),
        table("x,y,z,thickness", *V.T, THICK),
        table("z,thickness", [0.0, 3.0], [0.02, 0.05]),
        table("z;thickness", ["3,0", "0,0"], ["0,05", "0,02"], comma=";"),
        table("z\tthickness\tby", [0.0, 3.0], [0.02, 0.05], "ab", comma="\t"),
    ],
    ids=["vertex", "index", "triangle", "points", "profile", "decimal comma", "tabs"],
)
def test_read_distribution_of_a_table(tmp_path, text):
    found = read(tmp_path, text)
    assert found.thickness.triangles == pytest.approx(OF_TRIANGLES, rel=1e-9)
    assert pickle.loads(pickle.dumps(found)) == found


def test_read_distribution_has_the_unit_of_its_heading(tmp_path):
    """It stays in millimetres when the unit of the mesh is changed; a bare number does not."""
    given = written(tmp_path, table("z (cm),thickness_mm", [0.0, 3.0], [0.2, 0.5]))
    text = WallText(thickness_text(str(given), MESH, Unit.CENTIMETRE), "1.38")
    assert text.text(Unit.CENTIMETRE) == "walls.csv, 1.38\u00a0g/cm³"
    for unit in (Unit.CENTIMETRE, Unit.METRE):
        wall = parse_wall(text, unit)
        assert unit.metres * wall.thickness.triangles == pytest.approx(OF_TRIANGLES * 1e-2, rel=1e-9)
    with pytest.raises(NoUnitError):
        read_distribution(given, MESH, Unit.NONE)


@pytest.mark.parametrize(
    ("heading", "columns"),
    [
        ("z,thickness (mm),young,yield_radius (cm)", ([0.0, 3.0], [0.2, 0.5], [1.0, 4.0], [0.3, 0.6])),
        ("z,thickness_mm,Young (MPa),yield radius (mm)", ([0.0, 3.0], [0.2, 0.5], [1e3, 4e3], [3.0, 6.0])),
        ("z,thickness,young [Pa],yield_radius", ([0.0, 3.0], [0.02, 0.05], [1e9, 4e9], [0.3, 0.6])),
    ],
)
def test_read_distribution_of_modulus_and_yield_radius(tmp_path, heading, columns):
    """In their own units; a typed number replaces the mean."""
    text = read(tmp_path, table(heading, *columns), Unit.CENTIMETRE)
    height = V[:, 2][F].mean(axis=1) / 3.0
    wall = parse_wall(WallText(text), Unit.CENTIMETRE)
    assert wall.thickness.young.triangles == pytest.approx(1e9 * (1.0 + 3.0 * height), rel=1e-9)
    assert wall.thickness.yield_radius.triangles == pytest.approx(0.3 * (1.0 + height), rel=1e-9)
    assert wall.young == float(wall.thickness.young)
    assert wall.yield_radius == float(wall.thickness.yield_radius)
    assert 2.5e9 < wall.young < 4e9, "more of the wall is at the stiff end"
    typed = parse_wall(WallText(text, "", "7 MPa", "", "2 mm"), Unit.CENTIMETRE)
    assert (typed.young, typed.yield_radius) == (7e6, pytest.approx(0.2))
    write_distribution(tmp_path / "again.csv", wall.thickness)
    again = read_distribution(tmp_path / "again.csv", MESH, Unit.NONE)
    assert again.thickness.young.triangles == pytest.approx(wall.thickness.young.triangles, rel=1e-9)
    assert again.in_unit(Unit.METRE).yield_radius == again.thickness.yield_radius
    assert again.on(MESH) == again


def test_read_distribution_measures_height_above_the_bottom(tmp_path):
    X, triangles = box(2, 2, 6)
    open_box = Mesh(X + [0.0, 0.0, 7.0], triangles[X[triangles][:, :, 2].min(axis=1) < 6.0])
    found = read(tmp_path, "height,thickness\n0,0.1\n6,0.4", mesh=open_box)
    expected = 0.1 + 0.05 * (open_box.V[open_box.F][:, :, 2].mean(axis=1) - 7.0)
    assert found.thickness.triangles == pytest.approx(expected)
    with pytest.raises(InputError, match="The side on which the shape stands is not clear"):
        read(tmp_path, "height,thickness\n0,0.1\n6,0.4")


def test_read_distribution_of_measured_points_lies_between_them(tmp_path):
    some = np.random.default_rng(1).choice(len(V), 20, replace=False)
    found = read(tmp_path, table("x,y,z,thickness", *V[some].T, THICK[some]))
    assert found.thickness.triangles.min() >= THICK[some].min()
    assert found.thickness.triangles.max() <= THICK[some].max()
    assert np.abs(found.thickness.triangles - OF_TRIANGLES).max() < 0.5 * np.ptp(THICK)


def surface(folder, name):
    """A file of the mesh with its thickness as a property of vertices or faces."""
    path = folder / name
    if path.suffix == ".ply":
        head = "ply\nformat ascii 1.0\nelement vertex {}\n{}property float z\n{}"
        head += "element face {}\n{}end_header\n"
        xy, own = "property float x\nproperty float y\n", "property float thickness\n"
        faces = "property list uchar int vertex_indices\n"
        of_vertices = "vertex" in name
        rows = [[*X, *([t] if of_vertices else [])] for X, t in zip(V, THICK, strict=True)]
        rows += [[3, *T, *([] if of_vertices else [t])] for T, t in zip(F, OF_TRIANGLES, strict=True)]
        text = head.format(len(V), xy, own * of_vertices, len(F), faces + own * (not of_vertices))
        path.write_text(text + "\n".join(" ".join(map(str, row)) for row in rows) + "\n")
        return path
    data = pyvista.PolyData.from_regular_faces(V, F)
    for key, scale in (("thickness", 1.0), ("young", 10.0), ("yield_radius", 5.0)):
        data[key] = scale * (THICK if "vertex" in name else OF_TRIANGLES)
    data.save(path)
    return path


@pytest.mark.parametrize("kind", [np.uint8, np.uint16, np.int8, np.float32])
@pytest.mark.parametrize("binary", [True, False])
def test_read_distribution_reads_whole_numbers_of_any_type(kind, binary, tmp_path):
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    mesh.point_data["thickness"] = np.linspace(120, 20, len(V)).astype(kind)
    mesh.save(tmp_path / "walls.vtp", binary=binary)
    found = read_distribution(tmp_path / "walls.vtp", MESH, Unit.NONE)
    told = mesh.point_data["thickness"].astype(float)[F].mean(axis=1)
    assert found.thickness.triangles == pytest.approx(told)


def test_read_distribution_reads_files_with_a_byte_order_mark(tmp_path):
    mesh = pyvista.PolyData.from_regular_faces(V, F)
    mesh.point_data["thickness"] = THICK
    mesh.save(tmp_path / "walls.vtp", binary=False)
    text = (tmp_path / "walls.vtp").read_bytes()
    (tmp_path / "walls.vtp").write_bytes(b"\xef\xbb\xbf" + text)
    found = read_distribution(tmp_path / "walls.vtp", MESH, Unit.NONE)
    assert found.thickness.triangles == pytest.approx(OF_TRIANGLES)


@pytest.mark.parametrize("name", ["vertex.ply", "face.ply", "vertex.vtp", "face.vtp"])
def test_read_distribution_of_a_property_of_the_mesh(tmp_path, name):
    path = surface(tmp_path, name)
    found = read_distribution(path, open_mesh(path), Unit.NONE)
    assert found.thickness.triangles == pytest.approx(OF_TRIANGLES, rel=1e-6)
    if path.suffix == ".vtp":
        assert found.thickness.young.triangles == pytest.approx(1e10 * OF_TRIANGLES, rel=1e-6)
        assert found.thickness.yield_radius.triangles == pytest.approx(5.0 * OF_TRIANGLES, rel=1e-6)
    with pytest.raises(InputError, match=f"{name}: It is of another mesh"):
        read_distribution(path, Mesh(V, F[1:]), Unit.NONE)


def glb(folder, points, triangles, **attributes):
    """A GLB of a mesh with float attributes of its vertices."""
    columns = {"POSITION": points, **attributes}
    blobs = [np.asarray(each, dtype="<f4").tobytes() for each in columns.values()]
    blobs.append(np.asarray(triangles, dtype="<u4").tobytes())
    ends = np.cumsum([0, *map(len, blobs)]).tolist()
    kinds = [{1: "SCALAR", 2: f"VEC{np.shape(each)[-1]}"}[np.ndim(each)] for each in columns.values()]
    document = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [
            {
                "primitives": [
                    {"attributes": dict(zip(columns, range(9), strict=False)), "indices": len(columns)}
                ]
            }
        ],
        "accessors": [
            {"bufferView": k, "componentType": 5126, "type": kind, "count": len(points)}
            for k, kind in enumerate(kinds)
        ]
        + [{"bufferView": len(kinds), "componentType": 5125, "type": "SCALAR", "count": np.size(triangles)}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": end - start} for start, end in pairwise(ends)
        ],
        "buffers": [{"byteLength": ends[-1]}],
    }
    text, blob = json.dumps(document).encode(), b"".join(blobs)
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4s2I", b"glTF", 2, 28 + len(text) + len(blob))
    path = folder / "part.glb"
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    path.write_bytes(head + chunks)
    return path


def test_read_distribution_of_attributes_of_a_glb(tmp_path):
    path = glb(tmp_path, V, F, _THICKNESS=THICK, _young=10.0 * THICK, _YIELD_RADIUS=5.0 * THICK)
    found = read_distribution(path, open_mesh(path), Unit.NONE).thickness
    for wall, scale in ((found, 1.0), (found.young, 1e10), (found.yield_radius, 5.0)):
        assert wall.triangles == pytest.approx(scale * OF_TRIANGLES, rel=1e-6)


@pytest.mark.parametrize("parts", [3, 4])
def test_read_distribution_of_colours_is_linear_from_black_to_white(tmp_path, parts):
    share = V[:, 2] / 3.0
    path = glb(tmp_path, V, F, COLOR_0=np.repeat(share[:, None], parts, axis=1))
    found = thickness_text(f"{path}:0.2mm..0.8mm", open_mesh(path), Unit.CENTIMETRE)
    assert str(found) == "part.glb:0.2mm..0.8mm"
    assert found.thickness.triangles == pytest.approx(0.02 + 0.06 * share[F].mean(axis=1), rel=1e-6)
    with pytest.raises(ColorScaleError, match=r"part.glb: It has colours in place of a thickness"):
        read_distribution(path, open_mesh(path), Unit.NONE)


@pytest.mark.parametrize(
    ("red", "other", "thickness"), [(1.0, 1.0, "0.8mm"), (1.0, 0.0, "0.8mm"), (0.0, 0.0, "0.2mm")]
)
def test_read_distribution_of_one_colour_is_one_thickness(tmp_path, red, other, thickness):
    path = glb(tmp_path, V, F, COLOR_0=np.tile([red, other, other], (len(V), 1)))
    found = read_distribution(path, open_mesh(path), Unit.METRE, "0.2mm..0.8mm").in_unit(Unit.METRE)
    assert set(found.triangles) == {float(found)} == {parse_thickness(thickness, Unit.METRE)}


def test_read_distribution_of_colours_of_a_ply(tmp_path):
    grey = np.round(255 * V[:, 2] / 3.0).astype(int)
    head = f"ply\nformat ascii 1.0\nelement vertex {len(V)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += "".join(f"property uchar {part}\n" for part in ("red", "green", "blue"))
    head += f"element face {len(F)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [[*X, g, g, g] for X, g in zip(V, grey, strict=True)] + [[3, *T] for T in F]
    path = written(tmp_path, head + "\n".join(" ".join(map(str, row)) for row in rows) + "\n", "grey.ply")
    found = read_distribution(path, open_mesh(path), Unit.NONE, "1..2").thickness
    assert found.triangles == pytest.approx(1.0 + grey[F].mean(axis=1) / 255.0, rel=1e-12)


def test_read_distribution_finds_the_vertices_in_another_order_and_at_seams(tmp_path):
    """As exporters write it: vertices split, reordered and rounded."""
    rng = np.random.default_rng(3)
    triangles = F[rng.permutation(len(F))]
    corners = rng.permutation(triangles.size)
    soup = np.argsort(corners).reshape(-1, 3)
    path = glb(tmp_path, V[triangles.ravel()[corners]], soup, _THICKNESS=THICK[triangles.ravel()[corners]])
    found = read_distribution(path, MESH, Unit.NONE)
    assert found.thickness.triangles == pytest.approx(OF_TRIANGLES, rel=1e-6)
    with pytest.raises(InputError, match=r"part.glb: It is of another mesh"):
        read_distribution(path, Mesh(1.01 * V, F), Unit.NONE)


@pytest.mark.parametrize(
    ("colors", "scale", "said"),
    [
        (np.eye(3)[np.arange(len(V)) % 3], "1..2", "neither grey nor red"),
        (np.ones((len(V), 3)), "1", "in place of a thickness"),
        (np.zeros((len(V), 3)), "0..2", "greater than 0"),
        (None, "1..2", "no property “thickness”"),
        (np.ones((len(V), 2)), "1..2", "not a valid GLB file .*wrong type"),
    ],
)
def test_read_distribution_refuses_colours_that_say_no_thickness(tmp_path, colors, scale, said):
    path = glb(tmp_path, V, F, **({} if colors is None else {"COLOR_0": colors}))
    with pytest.raises(InputError, match=said):
        read_distribution(path, open_mesh(path), Unit.NONE, scale)


def test_read_distribution_tells_triangles_from_as_many_vertices(tmp_path):
    """A tube of one row has as many of both."""
    ring = Mesh(*tube(12, 1))
    assert len(ring.V) == len(ring.F)
    values = np.linspace(0.1, 0.5, len(ring.F))
    found = read(tmp_path, table("triangle,thickness", range(len(values)), values), mesh=ring)
    assert np.array_equal(found.thickness.triangles, values)
    assert np.array_equal(found.on(ring).thickness.triangles, values)
    found = read(tmp_path, table("vertex,thickness", range(len(values)), values), mesh=ring)
    assert found.thickness.triangles == pytest.approx(values[ring.F].mean(axis=1))


def test_read_distribution_needs_the_property(tmp_path):
    pyvista.PolyData.from_regular_faces(V, F).save(tmp_path / "bare.vtp")
    with pytest.raises(InputError, match="has no property “thickness”"):
        read_distribution(tmp_path / "bare.vtp", MESH, Unit.NONE)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            table("vertex,thickness", range(5), THICK[:5]),
            "has 5 rows, but the mesh needs each",
        ),
        (table("vertex,thickness", [0, *range(1, len(V) - 1), 1], THICK), "each number from 0 to 83 once"),
        ("z,thickness\n0,thick", "Row 2 has “thick” in place of a number"),
        ("z,thickness\n0", "Row 2 has “” in place of a number"),
        ("z,thickness\n0,1\n1,-0.2", "must be greater than 0 everywhere; number 1 is -0.2"),
        ("z,thickness\n0,nan", "number 0 is nan"),
        ("z,thickness,young\n0,1,2\n1,1,-2", "-2 GPa is out of range"),
        ("z,thickness,young\n0,1,x", "Row 2 has “x” in place of a number"),
        ("z,thickness,yield_radius\n0,1,2\n1,1,0", "yield radius must be greater than 0 everywhere"),
        ("z,thickness", "needs rows below a heading"),
        ("0,0.3\n1,0.3", "needs rows below a heading"),
        ("", "needs rows below a heading"),
        ("x,z,thickness\n0,0,1", "Points need x, y and z"),
        ("x,y,z,thickness\n100,0,0,1", r"Point 1 is 99 from the nearest vertex: it is of another mesh"),
        ("x,y,z,thickness\nnan,0,0,1", "not finite"),
    ],
)
def test_read_distribution_says_in_a_sentence_what_is_wrong(tmp_path, text, said):
    with pytest.raises(InputError, match=f"walls.csv: .*{said}"):
        read(tmp_path, text)


def test_with_part_thickness_makes_a_folding_line():
    """A sheet whose ends are pushed together folds on its thin line, and without it bends in the middle."""
    X, triangles = grid(40, 6, 1 / 40, 1 / 40)
    sheet, x = Mesh(X, triangles), X[:, 0]
    base, end = np.flatnonzero(x < 0.04), np.flatnonzero(x > 0.96)
    plain = WallText("0.01")
    line = with_part_thickness(plain, "0.002", np.abs(x - 0.3) < 1e-9, sheet, Unit.NONE)
    assert str(line.thickness) == "0.002 – 0.01"
    thicker = with_part_thickness(line, "0.003", np.abs(x - 0.3) < 1e-9, sheet, Unit.NONE)
    assert str(thicker.thickness) == "0.003 – 0.01"
    same = with_part_thickness(plain, "0.01mm", x < 2.0, sheet, Unit.MILLIMETRE)
    assert str(same.thickness) == "0.01\N{NO-BREAK SPACE}mm"
    along = np.flatnonzero(X[:, 1] == X[3, 1])
    along = along[np.argsort(x[along])]
    folds = []
    for wall in (plain, line):
        held, there = np.r_[base, end], np.vstack([X[base], X[end] - [0.2, 0.0, 0.0]])
        thickness = parse_wall(wall, Unit.NONE).thickness
        found = deform(X, triangles, held, there, handle=end, method="wall", wall_thickness=thickness)
        run = np.diff(found.U[along], axis=0)
        turns = np.abs(np.diff(np.arctan2(run[:, 2], run[:, 0])))
        folds.append((x[along][1:-1][turns.argmax()], turns.max()))
    assert folds[0] == (pytest.approx(0.5, abs=0.06), pytest.approx(0.15, abs=0.03))
    assert folds[1] == (pytest.approx(0.3, abs=1e-9), pytest.approx(2.2, abs=0.5))


def test_with_part_thickness_keeps_what_else_differs_from_place_to_place(tmp_path):
    text = read(tmp_path, "z,thickness,young,yield_radius\n0,0.02,1,3\n3,0.05,4,5\n")
    inside = V[:, 2] > 1.4
    wall = with_part_thickness(WallText(text), "0.01", inside, MESH, Unit.NONE).thickness.thickness
    part = inside[F].sum(axis=1) >= 2
    assert (wall.triangles[part] == 0.01).all()
    assert np.array_equal(wall.triangles[~part], text.thickness.triangles[~part])
    assert np.array_equal(wall.young.triangles, text.thickness.young.triangles)
    assert np.array_equal(wall.yield_radius.triangles, text.thickness.yield_radius.triangles)
    with pytest.raises(InputError, match="Enter a wall thickness"):
        with_part_thickness(WallText(), "0.01", inside, MESH, Unit.NONE)


def test_thickness_text_leaves_a_length_as_typed():
    assert thickness_text("0.3mm", MESH, Unit.NONE) == "0.3mm"
    with pytest.raises(InputError, match=r"There is no file .*walls\.csv"):
        thickness_text("walls.csv", MESH, Unit.NONE)


@pytest.mark.parametrize(
    ("typed", "scale"),
    [
        ("walls.csv", ""),
        (r"C:\parts\..\walls.csv", ""),
        ("C:/parts/../walls.csv", ""),
        ("a:b/../walls.csv", ""),
    ]
    + [("part.glb:0.2mm..0.8mm", "0.2mm..0.8mm"), (r"C:\parts\part.glb:1..2", "1..2")],
)
def test_distribution_file_is_told_from_the_scale_of_its_colours(typed, scale):
    path, found = distribution_file(typed)
    assert found == scale
    assert str(path) == typed.removesuffix(f":{scale}")
