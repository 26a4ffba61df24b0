"""3MF packages as they are meant: parts with numbers of their own, mirrors, units, and what has no triangles.

Every object is a box of volume 4, so volumes are sums of determinants.
"""

import io
import zipfile

import numpy as np
import pytest
from meshes import box

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh
from apd_viewer.geometry.mesh.operators import volume

V, F = box(1, 2, 2)
VOLUME = 4.0
MS = "http://schemas.microsoft.com/3dmanufacturing"
SPACES = f'xmlns="{MS}/core/2015/02" xmlns:p="{MS}/production/2015/06"'
SPACES += (
    f' xmlns:b="{MS}/beamlattice/2017/02" xmlns:s="{MS}/slice/2015/07" xmlns:t="{MS}/trianglesets/2021/07"'
)
START = f"{MS}/2013/01/3dmodel"
MIRROR = "-1 0 0 0 1 0 0 0 1 0 0 0"


def shape(V, F=F, more=""):
    vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in np.asarray(V).tolist())
    triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in F)
    return f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles>{more}</mesh>"


def model(objects, build, told='unit="millimeter"', spaces=SPACES):
    """A model part of objects (number, content) and of items, each the attributes of an element."""
    said = "".join(f'<object id="{number}" type="model">{content}</object>' for number, content in objects)
    items = "".join(f"<item {item}/>" for item in build)
    inside = f"<resources>{said}</resources><build>{items}</build>"
    return f'<?xml version="1.0"?><model {told} {spaces}>{inside}</model>'


def components(*each):
    return "<components>" + "".join(f"<component {told}/>" for told in each) + "</components>"


def relations(*targets):
    said = "".join(
        f'<Relationship Id="r{k}" Type="{kind}" Target="{to}"/>' for k, (kind, to) in enumerate(targets)
    )
    return f'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">{said}</Relationships>'


@pytest.fixture
def opened(tmp_path):
    def pack_and_open(main, place="3D/3dmodel.model", **more):
        content = io.BytesIO()
        with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, part in {place: main, **more.pop("parts", {})}.items():
                archive.writestr(name, part)
        (tmp_path / "a.3mf").write_bytes(content.getvalue())
        return open_mesh(tmp_path / "a.3mf")

    return pack_and_open


ONE = ("1", shape(V))
NESTED = (
    "3",
    components(f'objectid="2" transform="{MIRROR}"', 'objectid="1" transform="1 0 0 0 1 0 0 0 2 9 0 0"'),
)
PLACED = {
    "item": ([ONE], [f'objectid="1" transform="{MIRROR}"'], 1),
    "component": (
        [ONE, ("2", components(f'objectid="1" transform="{MIRROR}"', 'objectid="1"'))],
        ['objectid="2"'],
        2,
    ),
    "one of two": ([ONE], ['objectid="1"', 'objectid="1" transform="0 2 0 1 0 0 0 0 1 9 0 0"'], 3),
    "twice": (
        [ONE, ("2", components(f'objectid="1" transform="{MIRROR}"'))],
        ['objectid="2" transform="1 0 0 0 -1 0 0 0 1 0 0 0"'],
        1,
    ),
    "nested": ([ONE, ("2", components('objectid="1"')), NESTED], ['objectid="3"'], 3),
    "nested in a mirror": (
        [ONE, ("2", components('objectid="1"')), NESTED],
        [f'objectid="3" transform="{MIRROR}"'],
        3,
    ),
}


@pytest.mark.parametrize("name", PLACED)
def test_read_3mf_lets_a_mirrored_object_face_outwards(name, opened, tmp_path):
    objects, build, boxes = PLACED[name]
    mesh = opened(model(objects, build))
    assert volume(mesh.V, mesh.F) == pytest.approx(boxes * VOLUME)
    save_mesh(mesh, mesh.V, tmp_path / "b.obj")
    again = open_mesh(tmp_path / "b.obj")
    np.testing.assert_array_equal(again.F, mesh.F)
    assert volume(again.V, again.F) == pytest.approx(boxes * VOLUME)


def test_read_3mf_multiplies_rows_by_a_transform_from_the_right(opened):
    mesh = opened(model([ONE], ['objectid="1" transform="0 1 0 -1 0 0 0 0 1 5 6 7"']))
    np.testing.assert_array_equal(mesh.V, np.column_stack([5 - V[:, 1], 6 + V[:, 0], 7 + V[:, 2]]))


PART = model([("1", shape(2 * V))], [])
OTHER = model([("1", shape(V + 50)), ("2", components('objectid="1"'))], [])
PARTS = {"3D/Objects/one.model": PART, "3D/Objects/two.model": OTHER}
IN_PARTS = {
    "components": (
        [
            (
                "1",
                components(
                    'objectid="1" p:path="/3D/Objects/one.model"',
                    'objectid="1" p:path="/3D/Objects/two.model"',
                ),
            )
        ],
        ['objectid="1"'],
        9,
    ),
    "items": ([ONE], ['objectid="1"', 'objectid="1" p:path="/3D/Objects/one.model"'], 9),
    "components of a part": ([ONE], ['objectid="2" p:path="/3D/Objects/two.model"'], 1),
    "another spelling": ([ONE], ['objectid="1" p:path="/3D/objects/%6Fne.MODEL"'], 8),
    "not in small parts": ([ONE, ("2", shape(3 * V))], ['objectid="2"'], 27),
}


@pytest.mark.parametrize("name", IN_PARTS)
def test_read_3mf_lets_numbers_hold_within_their_part(name, opened):
    objects, build, boxes = IN_PARTS[name]
    mesh = opened(model(objects, build, 'unit="millimeter" requiredextensions="p"'), parts=PARTS)
    assert volume(mesh.V, mesh.F) == pytest.approx(boxes * VOLUME)


@pytest.mark.parametrize("target", ["/3D/part-7.model", "3D/part-7.model", "/3d/Part%2D7.model"])
@pytest.mark.parametrize("decoy", [False, True])
def test_read_3mf_takes_the_main_part_that_the_package_names(target, decoy, opened):
    parts = {"_rels/.rels": relations(("http://example.com/thumbnail", "/Metadata/a.png"), (START, target))}
    if decoy:
        parts["3D/3dmodel.model"] = PART
    mesh = opened(model([ONE], ['objectid="1"']), "3D/part-7.model", parts=parts)
    assert volume(mesh.V, mesh.F) == pytest.approx(VOLUME)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("prefix", ["", "core:"])
def test_read_3mf_reads_any_prefix_and_encoding(encoding, prefix, opened):
    said = model([ONE], ['objectid="1"'], spaces=SPACES).replace(
        'version="1.0"', f'version="1.0" encoding="{encoding}"'
    )
    if prefix:
        said = said.replace("xmlns=", "xmlns:core=").replace("</", "</core:")
        for name in (
            "model",
            "resources",
            "object ",
            "mesh",
            "vertices",
            "vertex ",
            "triangles",
            "triangle ",
            "build",
            "item ",
        ):
            said = said.replace(f"<{name}", f"<core:{name}")
    assert len(opened(said.encode(encoding)).F) == len(F)


BEAMS = '<b:beamlattice minlength="1" radius="1"><b:beams><b:beam v1="0" v2="1"/></b:beams></b:beamlattice>'
SLICES = '<s:slice ztop="1"><s:vertices><s:vertex x="0" y="0"/></s:vertices></s:slice>'
SLICES = f'<s:slicestack id="9">{SLICES}</s:slicestack>'


def test_read_3mf_says_beams_beside_triangles(opened):
    mesh = opened(model([("1", shape(V, more=BEAMS))], ['objectid="1"'], 'requiredextensions="b"'))
    assert volume(mesh.V, mesh.F) == pytest.approx(VOLUME)
    assert "beam lattices" in mesh.remarks[0]


def test_read_3mf_leaves_no_loose_vertices_of_an_object_of_beams(opened):
    mesh = opened(model([ONE, ("2", shape(V + 9, [], BEAMS))], ['objectid="1"', 'objectid="2"']))
    assert len(mesh.V) == len(V)
    assert "beam lattices" in mesh.remarks[0]


def test_read_3mf_says_slices_beside_triangles(opened):
    said = model([ONE], ['objectid="1"']).replace("<resources>", f"<resources>{SLICES}")
    mesh = opened(said.replace('id="1"', 'id="1" s:slicestackid="9"', 1))
    assert len(mesh.V) == len(V)
    assert "slices" in mesh.remarks[0]
    assert not opened(said).remarks  # which no object uses


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (("1", shape(V, [], BEAMS)), "beam lattices and no triangles"),
        (("1", ""), "slices and no triangles"),
    ],
)
def test_read_3mf_says_of_what_has_no_triangles_what_it_is(told, words, opened):
    said = model([told], ['objectid="1"']).replace("<resources>", f"<resources>{SLICES}")
    with pytest.raises(InputError, match=words):
        opened(said.replace('id="1"', 'id="1" s:slicestackid="9"', 1) if not told[1] else said)


DEEP = [ONE, *((str(k), components(*[f'objectid="{k - 1}"'] * 2)) for k in range(2, 40))]
WRONG = {
    "unknown": (
        model([ONE], ['objectid="1"'], 'xmlns:v="urn:vendor" requiredextensions="p v"'),
        "requires urn:vendor",
    ),
    "undeclared": (model([ONE], ['objectid="1"'], 'requiredextensions="z"'), "requires z"),
    "circle": (model([("1", components('objectid="1"'))], ['objectid="1"']), "nested without end"),
    "bomb": (model(DEEP, ['objectid="39"']), "nested without end"),
    "no object": (model([ONE], ['objectid="2"']), "object 2 is missing from 3d/3dmodel.model"),
    "no part": (model([ONE], ['objectid="1" p:path="/a.model"']), "its part a.model is missing"),
    "no build": (model([ONE], []), "its build places no object"),
    "twice": (model([ONE, ONE], ['objectid="1"']), "two objects of one part have the number 1"),
    "no number": (model([ONE], ["transform='1'"]), "has no number"),
    "eleven": (
        model([ONE], ['objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0"']),
        "does not have twelve numbers",
    ),
    "beyond": (model([("1", shape(V, [(0, 1, 99)]))], ['objectid="1"']), f"vertex 99 of {len(V)}"),
    "before": (model([("1", shape(V, [(0, 1, -1)]))], ['objectid="1"']), f"vertex -1 of {len(V)}"),
    "words": (model([("1", shape(V, [(0, 1, "x")]))], ['objectid="1"']), "vertex that is not a number"),
    "no coordinate": (
        model([ONE], ['objectid="1"']).replace('z="', 'w="', 1),
        "coordinate that is not a number",
    ),
    "unit": (model([ONE], ['objectid="1"'], 'unit="parsec"'), "its unit “parsec” is unknown"),
    "cut": (model([ONE], ['objectid="1"'])[:-9], "its XML is damaged at line 1"),
    "encoding": (
        model([ONE], ['objectid="1"']).replace('version="1.0"', 'version="1.0" encoding="utf-9"', 1),
        "encoding of its XML is not supported",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_read_3mf_says_what_is_wrong(name, opened, monkeypatch):
    monkeypatch.setattr("apd_viewer.files.formats.package_3mf.MOST_OBJECT_USES", 1000)
    said, words = WRONG[name]
    with pytest.raises(InputError, match=words):
        opened(said)


def test_read_3mf_refuses_parts_in_different_units(opened):
    parts = {"3D/Objects/one.model": PART.replace("millimeter", "inch")}
    with pytest.raises(InputError, match="its parts have different units"):
        opened(model([ONE], ['objectid="1" p:path="/3D/Objects/one.model"']), parts=parts)


@pytest.mark.parametrize(
    ("told", "unit", "factor"),
    [
        ("", "mm", 1.0),
        ('unit="millimeter"', "mm", 1.0),
        ('unit="micron"', "mm", 1e-3),
        ('unit="centimeter"', "cm", 1.0),
        ('unit="inch"', "in", 1.0),
        ('unit="foot"', "ft", 1.0),
        ('unit="meter"', "m", 1.0),
    ],
)
def test_read_3mf_takes_the_stated_unit(told, unit, factor, opened):
    mesh = opened(model([ONE], ['objectid="1"'], told))
    assert mesh.unit == unit
    np.testing.assert_allclose(mesh.V, factor * V)
