"""3MF, which a library reads: every object where the build puts it."""

import io
import os
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from meshes import box

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import open_mesh

V, F = box(1, 2, 1)
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
TYPES = """<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"""
VERTICES = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in V.tolist())
TRIANGLES = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in F.tolist())
MODEL = f"""<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}"><resources>
<object id="1" type="model">
<mesh><vertices>{VERTICES}</vertices><triangles>{TRIANGLES}</triangles></mesh>
</object></resources>
<build><item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0"/></build></model>"""


def archive(model):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("[Content_Types].xml", TYPES)
        file.writestr("3D/3dmodel.model", model)
    return content.getvalue()


def test_read_3mf_has_twice_what_is_built_twice(tmp_path):
    path = tmp_path / "two.3mf"
    path.write_bytes(archive(MODEL))
    mesh = open_mesh(path)
    first = np.argmin(mesh.V[mesh.F].mean(axis=(1, 2)))
    assert len(mesh.V) == 2 * len(V)
    assert len(mesh.F) == 2 * len(F)
    assert first < len(mesh.F)
    for part in (slice(0, len(V)), slice(len(V), None)):
        shift = mesh.V[part].min(axis=0) - V.min(axis=0)
        assert np.abs(mesh.V[part] - shift - V).max() < 1e-6
    assert np.ptp(mesh.V[:, 0]) == pytest.approx(11.0)
    save_mesh(mesh, mesh.V, tmp_path / "two.obj")
    with pytest.raises(InputError, match="choose OBJ or PLY"):
        save_mesh(mesh, mesh.V, tmp_path / "again.3mf")


@pytest.mark.parametrize("content", [b"PK\3\4 and no more", b"no archive", archive("<model"), archive("")])
def test_read_3mf_refuses_what_is_damaged(content, tmp_path):
    path = tmp_path / "bad.3mf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"bad.3mf is not a valid 3MF file \(.*\); export it again\."):
        open_mesh(path)


def test_read_3mf_does_not_unfold_a_bomb(tmp_path, monkeypatch):
    monkeypatch.setattr("apd_viewer.files.formats.package_3mf.MOST_BYTES", 1000)
    path = tmp_path / "bomb.3mf"
    path.write_bytes(archive(MODEL))
    with pytest.raises(InputError, match="would unpack to"):
        open_mesh(path)


def test_read_3mf_does_not_unpack_an_archive_that_bursts(tmp_path):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", bytes(1 << 27))
    (tmp_path / "a.3mf").write_bytes(content.getvalue())
    with pytest.raises(InputError, match="it would unpack to 134,217,728 bytes"):
        open_mesh(tmp_path / "a.3mf")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("entity", ['SYSTEM "{secret}"', 'SYSTEM "file://{secret}"', '"1"'])
def test_read_3mf_refuses_entities_of_a_part(tmp_path, encoding, entity):
    secret = tmp_path / "secret"
    if hasattr(os, "mkfifo"):
        os.mkfifo(secret)  # whoever opens it waits for ever
    model = f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE model [<!ENTITY a {entity}>]>'
    model = model.format(secret=secret) + "<model><resources>&a;</resources></model>"
    with zipfile.ZipFile(tmp_path / "a.3mf", "w") as archive:
        archive.writestr("3D/3dmodel.model", model.encode(encoding))
    with pytest.raises(InputError, match="declares XML entities"):
        open_mesh(tmp_path / "a.3mf")


cut = st.tuples(
    st.floats(0, 1),
    st.floats(0, 0.05),
    st.sampled_from(["", "9" * 30, "nan", "-1", "<", '"', "1e400", "&a;"]),
)


@settings(max_examples=60)
@given(cuts=st.lists(cut, min_size=1, max_size=3), outside=st.booleans())
def test_read_3mf_opens_or_refuses_whatever_stands_in_it(cuts, outside, tmp_path_factory):
    content = archive(MODEL) if outside else MODEL.encode()
    for where, length, instead in cuts:
        begin = int(where * len(content))
        content = content[:begin] + instead.encode() + content[begin + int(length * len(content)) :]
    path = tmp_path_factory.getbasetemp() / "any.3mf"
    path.write_bytes(content if outside else archive(content))
    refusal = "."
    try:
        assert len(open_mesh(path).F)
    except InputError as error:
        refusal = str(error)
    assert refusal.endswith(".")
    assert len(refusal.splitlines()) == 1


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('<triangle v1="', '<triangle pid="5" p1="0" v1="', "colours and materials"),
        ('<object id="1"', '<object id="1" pid="5" pindex="0"', "colours and materials"),
        ("nothing", "changed", None),
    ],
)
def test_read_3mf_says_that_materials_are_not_read(before, after, said, tmp_path):
    path = tmp_path / "a.3mf"
    path.write_bytes(archive(MODEL.replace(before, after)))
    remarks = open_mesh(path).remarks
    assert (said in remarks[0]) if said else not remarks


def test_read_3mf_leaves_out_support_structures(tmp_path):
    support = f'<object id="2" type="support"><mesh><vertices>{VERTICES}</vertices>'
    support += f"<triangles>{TRIANGLES}</triangles></mesh></object></resources>"
    model = MODEL.replace("</resources>", support).replace("<build>", '<build><item objectid="2"/>')
    path = tmp_path / "a.3mf"
    path.write_bytes(archive(model))
    mesh = open_mesh(path)
    assert len(mesh.F) == 2 * len(F)
    assert mesh.remarks == ("The support structures of the file are left out.",)


def test_read_3mf_finds_parts_with_percent_encoded_names(tmp_path):
    content = io.BytesIO()
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    space = "http://schemas.openxmlformats.org/package/2006/relationships"
    with zipfile.ZipFile(content, "w") as file:
        target = f'<Relationship Id="a" Type="{kind}" Target="/3D/My%20Part.model"/>'
        file.writestr("_rels/.rels", f'<Relationships xmlns="{space}">{target}</Relationships>')
        file.writestr("3D/My%20Part.model", MODEL)
    path = tmp_path / "a.3mf"
    path.write_bytes(content.getvalue())
    assert len(open_mesh(path).F) == 2 * len(F)
