"""What ``make fuzz`` reads: each reader with the modules that it consists of and small valid contents.

A target takes bytes and calls the reader as the program does. It may raise its declared error, and nothing else.
"""

import io
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from fuzz import ANY, other_json
from mesh_contents import FILES

from apd_viewer.errors import InputError
from apd_viewer.files.mesh_formats import MESH_FORMATS
from apd_viewer.files.meshes import read_mesh
from apd_viewer.session.posing.motion_text import parse_motion
from apd_viewer.session.quantities.expressions import parse_angle, parse_length, parse_number, parse_volume
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.storage.session_file import open_session_file

FOLDER = Path(tempfile.mkdtemp(prefix="apd-fuzz-"))
SESSIONS = Path(__file__).parents[1] / "session" / "storage"


class Target(NamedTuple):
    """A reader to be fuzzed.

    Attributes
    ----------
    modules : tuple of str
        Files in apd_viewer that it consists of, for the count of lines.
    error : type
        The exception that it declares.
    """

    read: Callable[[bytes], object]
    modules: tuple[str, ...]
    seeds: tuple[bytes, ...]
    error: type[Exception] = InputError


def packed(members):
    """A ZIP archive."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return stream.getvalue()


def written(name, content):
    path = FOLDER / name
    path.write_bytes(content)
    return path


# ---- meshes

PACKAGE = Path("files/formats/package_3mf.py")
_MODULES = {
    ".obj": ("files/formats/obj.py", "files/formats/text.py"),
    ".ply": ("files/formats/ply.py", "files/formats/ply_elements.py"),
    ".stl": ("files/formats/stl.py",),
    ".off": ("files/formats/off.py",),
    ".glb": ("files/gltf/scene.py", "files/gltf/accessors.py", "files/gltf/gltf_reader.py"),
    ".3mf": ("files/formats/package_3mf.py",),
    ".vtp": ("files/vtk/xml_surface.py", "files/vtk/xml_arrays.py", "files/vtk/xml_elements.py"),
    ".vtk": ("files/vtk/legacy.py", "files/vtk/cells.py"),
}
_MODULES |= {".gltf": _MODULES[".glb"], ".vtu": (*_MODULES[".vtp"], "files/vtk/cells.py")}
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_MODEL = f"""<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}"><resources>
<object id="1" type="model" name="a"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
<triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles>
</mesh></object><object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>
</components></object></resources>
<build><item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 10 0 0"/></build></model>""".encode()
_TYPES = b"""<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"""


def _mesh_target(suffix):
    seeds = tuple(content for name, content in FILES.items() if name.endswith(suffix))
    if suffix == ".3mf":
        seeds = (packed({"[Content_Types].xml": _TYPES, "3D/3dmodel.model": _MODEL}),)
    path = FOLDER / f"mesh{suffix}"
    return Target(lambda content: read_mesh(path, content), _MODULES[suffix], seeds)


# ---- texts

_NAMES = {"X": 1.0, "Y": 2.0, "Z": 3.0, "L": 2.0, "D": 4.0}


def _text(content):
    return content.decode(errors="replace")


def _quantities(content):
    text = _text(content)
    for read in (
        lambda: parse_length(text, Unit.MILLIMETRE, _NAMES),
        lambda: parse_length(text, Unit.NONE, _NAMES),
        lambda: parse_angle(text, _NAMES),
        lambda: parse_number(text, _NAMES),
        lambda: parse_volume(text, Unit.MILLIMETRE),
    ):
        try:
            found = read()
        except InputError:
            continue
        assert np.isfinite(found), f"{found} was read"


def _motion(content):
    for step in parse_motion(_text(content)):
        step.parse_amounts(Unit.MILLIMETRE)


TARGETS: dict[str, Target] = {suffix[1:]: _mesh_target(suffix) for suffix in MESH_FORMATS}
TARGETS["session"] = Target(
    lambda content: open_session_file(written("session.apd", content)),
    (
        "session/storage/session_file.py",
        "session/storage/session_json.py",
        "session/storage/part_json.py",
        "session/storage/timeline_json.py",
        "files/storage/archive.py",
        "files/storage/json_fields.py",
    ),
    tuple(path.read_bytes() for path in sorted(SESSIONS.glob("*.apd"))),
)
TARGETS["motion"] = Target(
    _motion,
    ("session/posing/motion_text.py",),
    (
        b"twist 120deg; push 30%",
        b"handle 2: turn 30deg about x; move 0 2cm 0; bend 1rad about z",
        b"scale 1.5",
    ),
)
TARGETS["quantity"] = Target(
    _quantities,
    ("session/quantities/expressions.py",),
    (
        b"2*(3mm+1cm)/4",
        b"sin(30deg)*L",
        b"1/3 in",
        b"atan2(1,2)",
        b"sqrt(4)^2 - -1e3",
        b"0.5 l",
        b"min(X, Y, D)",
    ),
)


# ---- mutation


def mutated(content, chance, name, mutate):
    """Other content for a target: by the damage of fuzz.py, by libFuzzer, or in a member of an archive."""
    if content.startswith(b"PK\3\4") and chance.random() < 0.9:
        try:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                members = {each: archive.read(each) for each in archive.namelist()[:40]}
        except Exception:  # whatever the library finds wrong with it
            return mutate(content)
        if members:
            which = chance.choice(list(members))
            members[which] = _other(members[which], chance, which, mutate)
            return packed(members)
    return _other(content, chance, name, mutate)


def _other(content, chance, name, mutate):
    if not content or chance.random() < 0.4:
        return mutate(content)
    is_json = content.startswith(b"glTF") or content.lstrip()[:1] == b"{"
    return (other_json if is_json and chance.random() < 0.7 else chance.choice(ANY))(content, chance)
