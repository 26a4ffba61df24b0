"""Small valid contents with which the targets of ``make fuzz`` begin."""

import io
import json
import struct
import tempfile
import zipfile
from functools import partial
from pathlib import Path

import numpy as np
import textured_files
from animated import animated
from fuzz_vtk_seeds import legacy_contents, xml_contents
from gltf_scenes import GltfScene
from mesh_contents import FILES
from painted_meshes import MESH, painted, write_bar
from PIL import Image

from apd_viewer.cases.case_file import CaseResult, case_to_bytes
from apd_viewer.files.animations.animation_files import write_animation
from apd_viewer.files.selections.selection_files import SELECTION_FORMATS, write_selection
from apd_viewer.session.model.named_obstacle import ObstacleKind

STORED = Path(__file__).parents[1] / "session" / "storage"
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
MODEL = f"""<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}"><resources>
<object id="1" type="model" name="a"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles>
</mesh></object><object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>
</components></object></resources><build><item objectid="1"/>
<item objectid="2" transform="1 0 0 0 1 0 0 0 1 10 0 0"/></build></model>"""
TYPES = """<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"""


RELATIONSHIPS = """<?xml version="1.0"?><Relationships
xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="r"
Target="/3D/other.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"""
PACKAGES = (
    {"3D/3dmodel.model": MODEL},
    {"_rels/.rels": RELATIONSHIPS, "3D/other.model": MODEL.replace("millimeter", "inch")},
    {"3D/3dmodel.model": MODEL.replace("<model unit", '<model xmlns:q="urn:q" requiredextensions="q" unit')},
)


def packed(members):
    """A ZIP archive."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()


def unpacked(content):
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def written(name, write):
    """Content of a file that ``write`` makes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        write(path)
        return path.read_bytes()


def mesh_contents(suffix):
    if suffix == ".3mf":
        return [packed({"[Content_Types].xml": TYPES, **members}) for members in PACKAGES]
    if suffix == ".vtk":
        return legacy_contents()
    if suffix in (".vtp", ".vtu"):
        return xml_contents(suffix)
    found = [*ply_contents(), *wall_contents()] if suffix == ".ply" else []
    found += [content for name, content in FILES.items() if name.endswith(suffix)]
    with tempfile.TemporaryDirectory() as folder:
        if suffix in (".obj", ".ply", ".glb", ".gltf"):
            found.append(getattr(textured_files, suffix[1:])(Path(folder)).read_bytes())
        if suffix in (".glb", ".gltf"):
            for made in (scene(), colored_scene(), textured_scene(), *refused_scenes()):
                found.append(made.write(Path(folder, f"scene{suffix}")).read_bytes())
    return found


def refused_scenes():
    """Scenes with another scene beside them, and some that need or hold what cannot be read."""
    for more, weights in (
        ({}, None),
        ({"extensionsRequired": ["EXT_magic"]}, None),
        ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, None),
        ({}, ["a"]),
    ):
        found = GltfScene(**more)
        found.node(mesh=found.mesh(MESH.V, MESH.F, weights, targets=["a"]))
        found.document["scenes"].append({"nodes": [found.node(root=False, mesh=0)]})
        yield found


def ply_contents():
    """PLY with colours of both kinds, normals, lists at vertices and corners, and integer places."""
    V, F = MESH.V, MESH.F.tolist()
    faces = np.zeros(len(F), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, F
    found = []
    for kinds, columns in (
        ("float red float green float blue", np.full((len(V), 3), 0.5, "<f4")),
        ("uchar red uchar green uchar blue uchar alpha", np.full((len(V), 4), 200, "u1")),
        ("float nx float ny float nz", V.astype("<f4")),
        ("list uchar int near", np.tile(np.uint8([1, 4, 0, 0, 0]), (len(V), 1))),
    ):
        words = kinds.split()
        names = (
            [f"property {kinds}"]
            if words[0] == "list"
            else [f"property {kind} {name}" for kind, name in zip(words[::2], words[1::2], strict=True)]
        )
        head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(V)}"]
        head += [*(f"property float {axis}" for axis in "xyz"), *names, f"element face {len(F)}"]
        head += ["property list uchar int vertex_indices", "end_header", ""]
        rows = [v.tobytes() + c.tobytes() for v, c in zip(V.astype("<f4"), columns, strict=True)]
        found.append("\n".join(head).encode() + b"".join(rows) + faces.tobytes())
    whole = "".join(f"{x} {y} {z}\n" for x, y, z in np.rint(9 * V).astype(int).tolist())
    head = f"ply\nformat ascii 1.0\nelement vertex {len(V)}\n"
    head += "".join(f"property int {axis}\n" for axis in "xyz") + f"element face {len(F)}\n"
    head += "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
    corners = "".join(f"3 {a} {b} {c} 6 0 0 1 0 0 1\n" for a, b, c in F)
    return [*found, (head + whole + corners).encode()]


def texture_files():
    """Contents of the files that textured meshes refer to, by name."""
    with tempfile.TemporaryDirectory() as folder:
        textured_files.obj(Path(folder))
        return {path.name: path.read_bytes() for path in Path(folder).iterdir() if path.suffix != ".obj"}


def scene():
    """A glTF scene with a skin, instances, a sparse accessor, colours, and shapes with weights."""
    V, F = MESH.V, MESH.F
    found = GltfScene()
    joint = [found.node(translation=[0, 0, k], scale=[1, 1, 2]) for k in range(2)]
    bound = found.accessor(np.tile(np.eye(4).ravel(), (2, 1)))
    found.document["skins"] = [{"joints": joint, "inverseBindMatrices": bound}]
    joints = found.accessor(np.tile([0, 1, 0, 0], (len(V), 1)), "u1")
    weights = found.accessor(np.tile([0.5, 0.5, 0.0, 0.0], (len(V), 1)))
    target = found.sparse(len(V), [1, 5], [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0]])
    colors = found.accessor(np.full((len(V), 4), 0.5))
    attributes = {"JOINTS_0": joints, "WEIGHTS_0": weights, "COLOR_0": colors}
    skinned = found.mesh(V, F, [0.5], attributes=attributes, targets=[{"POSITION": target}])
    found.node(mesh=skinned, skin=0)
    where = {"TRANSLATION": found.accessor([[0, 0, 0], [9, 0, 0]]), "SCALE": found.accessor(np.ones((2, 3)))}
    instances = {"EXT_mesh_gpu_instancing": {"attributes": where}}
    found.node(mesh=found.mesh(V, [0, 1, 2, 3, 4], mode=5), extensions=instances)
    scaled = found.accessor(np.rint(127 * V), "i1", normalized=True)
    base = found.sparse(len(V), [2], [[0.0, 0.0, 3.0]], base=V)
    bytes_ = {"COLOR_0": found.accessor(np.full((len(V), 3), 90), "u1", normalized=True), "NORMAL": scaled}
    thickness = {"_THICKNESS": found.accessor(np.full(len(V), 0.3))}
    found.node(mesh=found.mesh(base, [0, 1, 2, 3, 4], mode=6, attributes=bytes_ | thickness))
    found.document["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    return found


def colored_scene():
    """One mesh with colours, and a thickness and positions by sparse accessors over others."""
    found, n = GltfScene(), len(MESH.V)
    attributes = {
        "COLOR_0": found.accessor(np.full((n, 4), 90), "u1", normalized=True),
        "_THICKNESS": found.sparse(n, [2], [0.3], width=1, base=np.full(n, 0.2)),
        "NORMAL": found.accessor(np.rint(127 * MESH.V), "i1", normalized=True),
    }
    position = found.sparse(n, [0], MESH.V[:1], base=MESH.V)
    found.node(mesh=found.mesh(position, MESH.F, attributes=attributes))
    return found


def textured_scene():
    """Two parts with an image each, and one without."""
    found, uv = GltfScene(), np.tile(np.float32([[0.2, 0.7], [1.5, -0.5]]), (len(MESH.V) // 2, 1))
    png, jpeg, *_ = image_contents()
    views = [found.view(np.frombuffer(content, np.uint8)) for content in (png, jpeg)]
    found.document["images"] = [{"bufferView": view, "mimeType": "image/png"} for view in views]
    found.document["textures"] = [{"source": 0}, {"source": 1}]
    found.document["materials"] = [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": k}}} for k in (0, 1)
    ]
    for k in (0, 1):
        found.node(
            mesh=found.mesh(MESH.V, MESH.F, material=k, attributes={"TEXCOORD_0": found.accessor(uv)}),
            translation=[3 * k, 0, 0],
        )
    found.node(mesh=found.mesh(MESH.V, MESH.F), translation=[0, 3, 0])
    return found


def selection_contents(suffix):
    assert suffix in SELECTION_FORMATS
    found = [written(f"a{suffix}", lambda path: write_selection(path, MESH, painted()))]
    if suffix == ".dmat":
        groups = np.resize([0.0, 1.0, 2.0], len(MESH.V))
        found += [b"0 0\n1 %d\n" % len(groups) + groups.tobytes()]
        found += [b"1 %d\n" % len(groups) + "\n".join(map(str, range(len(groups)))).encode()]
    if suffix == ".npz":
        found += map(partial(changed_arrays, found[0]), DAMAGED_ARRAYS)
    if suffix == ".json":
        found += map(partial(changed_json, found[0]), DAMAGED_SELECTIONS)
    return found


# Of a selection, what stands in place of its arrays or names.
DAMAGED_ARRAYS = (
    {"labels": None},
    {"handles": np.zeros(3)},
    {"regions": np.array(["a"]).view("<u4").__or__(0xFFFFFFF0).view("<U1")},
    {"areas": np.array("many")},
    {"digest": np.array(3)},
    {"labels": np.zeros((3000, 3000), dtype=np.uint8)},
    {"handles": np.array(["", ""])},
    {"handles": np.array(["a", "a"])},
    {"regions": np.array(["a", "a"])},
    {"handles": np.array([str(k) for k in range(300)])},
)
DAMAGED_SELECTIONS = (
    {"handles": [{"name": str(k), "vertices": []} for k in range(300)]},
    {"base": [1, 1]},
    {"handles": [{"name": "", "vertices": [3]}]},
    {"regions": [{"name": "", "vertices": [3]}]},
)


def changed_arrays(content, changes):
    with np.load(io.BytesIO(content)) as file:
        arrays = {**file, **changes}
    stream = io.BytesIO()
    np.savez_compressed(stream, **{key: value for key, value in arrays.items() if value is not None})
    return stream.getvalue()


def changed_json(content, changes):
    return json.dumps(json.loads(content) | changes).encode()


def number_contents():
    sel = "\n".join(["# a comment", *"0012"[:1] * 3, *["1"] * (len(MESH.V) - 3)]).encode()
    return [sel, b"1 0 0 5\n0 1 0 0\n0 0 1 -2.5\n0 0 0 1\n"]


def weighted_scene(interpolation, keys):
    """A mesh with a shape, whose weight has keys of a kind."""
    found = GltfScene()
    target = {"POSITION": found.accessor(0.1 * MESH.V)}
    found.node(mesh=found.mesh(MESH.V, MESH.F, [0.0], targets=[target]))
    sampler = {"input": found.accessor([0.0, 1.0, 2.0]), "output": found.accessor(keys)}
    channel = {"sampler": 0, "target": {"node": 0, "path": "weights"}}
    found.document["animations"] = [
        {"samplers": [{**sampler, "interpolation": interpolation}], "channels": [channel, {"sampler": 0}]}
    ]
    return written("a.glb", found.write)


def animation_contents(suffix):
    more = []
    if suffix == ".glb":
        more = [
            weighted_scene("STEP", [0, 1, 0.5]),
            weighted_scene("CUBICSPLINE", [0, 0, 0, 0, 1, 0, 0, 0.5, 0]),
        ]
    if suffix == ".mdd":
        more = [struct.pack(">2i2f", 2, len(MESH.V), 0, 1) + np.tile(MESH.V, (2, 1)).astype(">f4").tobytes()]
    with tempfile.TemporaryDirectory() as folder:
        animation, _ = animated(MESH, Path(folder, "shapes"))
        path = Path(folder, f"a{suffix}")
        write_animation(animation, path)
        return [path.read_bytes(), *more]


SERIES = b"""<?xml version="1.0"?><VTKFile type="Collection"><Collection>
<DataSet timestep="0" file="box.ply"/><DataSet timestep="1.5" file="box.ply"/>
<DataSet timestep="2" file="cube.ply"/>
</Collection></VTKFile>"""
PLAN = b"""mesh,selection,motion,unit,steps,method,stiffness,area,contact,thickness,young,volume,# note
bar.off,bar.sel,twist 40deg,mm,2,exact,0.1,100,no,,,,a
bar.off,bar.sel,push 30%; handle 1: move 0 2cm 0,mm,3,wall,,,yes,0.3mm,2GPa,120%,"b, c"
bar.off,,bend 20deg about x,,,,,,auto,,,,
"""
PLANS = [
    PLAN,
    b"session;to;seed\nbar.apd;50%;3\n",
    b"session,unit\nbar.apd,mm\n",
    b"mesh,session\nbar.off,bar.apd\n",
    b"mesh,selection,motion,unit,thickness\nbar.off,bar.sel,twist 4deg,,0.3mm\nbar.off,bar.sel,,,\n",
    b"mesh,selection,motion,contact,yield_radius,pressure,young\nbar.off,bar.sel,twist 4,yes,0.1,5mbar,\n",
    b"mesh,selection,motion,contact,gas,young\nbar.off,bar.sel,twist 4,no,1,2,9,9\n",
    b"mesh,mesh\na,b\n",
    b"motion\na\n",
    b"mesh,selection,motion,unit,thickness,method,contact\nbar.off,bar.sel,twist 4,mm,-1mm,arap,yes\n",
    b"mesh,selection,motion,unit,volume,method,contact\nbar.off,bar.sel,twist 4,mm,2ml,exact,yes\n",
    b"mesh,selection,motion,unit,contact,method,pressure,young\nbar.off,bar.sel,twist 4,mm,yes,wall,1,2\n",
    b"mesh,selection,motion,unit,contact,method,pressure\nbar.off,bar.sel,twist 4,mm,yes,wall,5mbar\n",
    b"mesh,selection,motion,thickness,contact\nbar.off,bar.sel,twist 4,3mm,yes\na,b,twist 4,3,auto\n",
    b"session,contact,motion\nbar.apd,auto,twist 4\n",
    b'mesh,selection,motion\nbar.off,"bar.sel,twist 4\n',
    b"mesh\tselection\tmotion\tpressure\tgas\nbar.off\tbar.sel\tscale 2\t1\t\n",
]
WALLS = [
    b"z,thickness (mm),young,yield_radius (cm)\n0,0.2,2,0.6\n2,0.5,3,0.8\n",
    b"height;thickness_mm\n0;0,2\n2;0,5\n",
    b"x,y,thickness\n0,0,0.2\n",
    b"height,thickness\n0,thick\n1,0.5\n",
    b"vertex,thickness\n0,0.2\n0,0.5\n",
    b"a,b\n1,2\n",
    "vertex,thickness\n{}".format("".join(f"{k},0.1\n" for k in range(len(MESH.V)))).encode(),
    "triangle\tthickness\n{}".format("".join(f"{k}\t0.1\n" for k in range(len(MESH.F)))).encode(),
    ("x,y,z,thickness\n" + "".join(f"{x},{y},{z},0.3\n" for x, y, z in MESH.V.tolist())).encode(),
]


def wall_contents():
    """PLY of the mesh with a thickness at its vertices, and with grey colours."""
    F = "".join(f"3 {a} {b} {c}\n" for a, b, c in MESH.F.tolist())
    found = []
    for properties, values in (
        ("property float thickness\nproperty float young\n", "0.3 2"),
        ("property uchar red\nproperty uchar green\nproperty uchar blue\n", "90 90 90"),
    ):
        head = f"ply\nformat ascii 1.0\nelement vertex {len(MESH.V)}\n"
        head += "".join(f"property double {axis}\n" for axis in "xyz") + properties
        head += f"element face {len(MESH.F)}\nproperty list uchar int vertex_indices\nend_header\n"
        found.append(
            (head + "".join(f"{x!r} {y!r} {z!r} {values}\n" for x, y, z in MESH.V.tolist()) + F).encode()
        )
    return found


def plan_folder(folder):
    """Put what plans name into a folder."""
    write_bar(folder)
    return folder


def obstacle_rows():
    rows = [{"name": kind.value, "kind": kind.value, "place": [3.0, 0.5, 0.0]} for kind in ObstacleKind]
    return [
        row | {"axis": [1.0, 0.0, 0.0], "radius": 0.3, "length": 2.0, "shift": [0.1, 0, 0]} for row in rows
    ]


def obstacle_contents():
    return [json.dumps(obstacle_rows()).encode()]


def image_contents():
    pixels = np.arange(8 * 6 * 4, dtype=np.uint8).reshape(6, 8, 4)
    found = []
    for kind, mode in (
        ("PNG", "RGBA"),
        ("JPEG", "RGB"),
        ("WEBP", "RGB"),
        ("GIF", "P"),
        ("TIFF", "RGB"),
        ("BMP", "RGB"),
    ):
        stream = io.BytesIO()
        Image.fromarray(pixels).convert(mode).save(stream, kind)
        found.append(stream.getvalue())
    return found


def case_contents():
    readings, curves, frame = {"energy": 1.0}, {"step": [0.0, 1.0]}, {"settled": True}
    result = CaseResult("ab12", {"mesh": "a"}, "done", "", readings, curves, frame, MESH.V)
    return [case_to_bytes(result)]
