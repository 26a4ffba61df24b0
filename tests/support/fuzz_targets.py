"""What ``make fuzz`` reads: each reader with the modules that it consists of and small valid contents.

A target takes bytes and calls the reader as the program does. It may raise its declared error, and nothing
else. What was read is written again by those that can.
"""

import struct
import tempfile
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from copy import copy
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import fuzz_seeds as seeds
import numpy as np
from fuzz import ANY, other_json
from fuzz_session_seeds import session_contents
from mesh_contents import FILES, ply
from painted_meshes import MESH

from apd_viewer.cases.case_file import (
    case_from_bytes,
    case_path,
    case_sizes,
    case_to_bytes,
    read_case,
    write_case,
)
from apd_viewer.cases.design import DESIGNS, design_table, parse_variable
from apd_viewer.cases.plan import parse_cell, read_plan
from apd_viewer.cases.plan_columns import COLUMNS
from apd_viewer.cases.study_case import InputFiles
from apd_viewer.errors import InputError
from apd_viewer.files.animations.animation_reading import open_animation, read_point_cache
from apd_viewer.files.formats.texture_images import read_image, read_picture
from apd_viewer.files.known_file import KnownFile
from apd_viewer.files.mesh_formats import MESH_FORMATS, WriteSupport
from apd_viewer.files.mesh_writing import save_mesh
from apd_viewer.files.meshes import read_mesh
from apd_viewer.files.picture_files import png_content, read_png
from apd_viewer.files.selections.selection_files import (
    SELECTION_FORMATS,
    read_selection_file,
    write_selection,
)
from apd_viewer.files.selections.survey_formats import read_region, read_transform
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.posing.motion import MOTION_KINDS
from apd_viewer.session.posing.motion_text import motion_steps, parse_motion
from apd_viewer.session.quantities.expressions import parse_angle, parse_length, parse_number, parse_volume
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.volume_target import parse_volume_target
from apd_viewer.session.quantities.wall import (
    WallText,
    parse_wall,
    press_method,
    typed_mass,
    with_part_thickness,
)
from apd_viewer.session.quantities.wall_distribution import read_distribution, write_distribution
from apd_viewer.session.storage.part_json import read_obstacles
from apd_viewer.session.storage.session_file import (
    has_mesh,
    open_session,
    open_session_file,
    save_if_unchanged,
    save_session,
)
from apd_viewer.session.storage.timeline_json import saved_timeline
from apd_viewer.session.typed_values import TypedValues

FOLDER = Path(tempfile.mkdtemp(prefix="apd-fuzz-"))
STATE = initial_state(MESH)
MM = Unit.MILLIMETRE
STORE = SimpleNamespace(required_state=lambda: STATE, unit=MM)
ROW = {"mesh": "a", "selection": "b", "motion": "push {push}; twist 1deg"}
PART = MESH.V[:, 2] > 0.0


class Target(NamedTuple):
    """A reader to be fuzzed.

    Attributes
    ----------
    modules : tuple of str
        Files in apd_viewer that it consists of, for the count of lines.
    seeds : callable
        Makes the contents to begin with.
    error : type
        The exception that it declares.
    """

    read: Callable[[bytes], object]
    modules: tuple[str, ...]
    seeds: Callable[[], Sequence[bytes]]
    error: type[Exception] = InputError


def written(name, content):
    path = FOLDER / name
    path.write_bytes(content)
    return path


def each_of(*readers):
    """Call all, though some refuse."""
    for read in readers:
        try:
            read()
        except InputError:
            continue


# ---- meshes

_VTK, _GLTF = "files/vtk/", "files/gltf/"
_XML = tuple(f"{_VTK}{name}.py" for name in ("xml_surface", "xml_arrays", "xml_elements", "cells"))
_SCENE = tuple(f"{_GLTF}{name}.py" for name in ("scene", "accessors", "gltf_reader"))
_MODULES = {
    ".obj": ("files/formats/obj.py", "files/formats/text.py"),
    ".ply": ("files/formats/ply.py", "files/formats/ply_elements.py"),
    ".stl": ("files/formats/stl.py",),
    ".off": ("files/formats/off.py",),
    ".glb": _SCENE,
    ".gltf": _SCENE,
    ".3mf": ("files/formats/package_3mf.py",),
    ".vtp": _XML,
    ".vtu": _XML,
    ".vtk": (f"{_VTK}legacy.py", f"{_VTK}cells.py"),
}


def _mesh(content, suffix):
    mesh = read_mesh(FOLDER / f"mesh{suffix}", content)
    assert np.isfinite(mesh.V).all(), "positions that are no numbers"
    if MESH_FORMATS[suffix].writing is not WriteSupport.NONE:
        each_of(
            lambda: save_mesh(mesh, 2.0 * mesh.V, FOLDER / f"written{suffix}"),
            lambda: save_mesh(Mesh(mesh.V, mesh.F), mesh.V, FOLDER / f"plain{suffix}"),
        )
        assert all(mesh.origin.extras)
        assert mesh.colors is None or mesh.colors.shape == mesh.V.shape
        texture, normals = mesh.texture[0], mesh.corner_normals
        assert texture is None or texture.image.ndim == 3
        assert normals is None or np.isfinite(normals.local).all()
        each_of(lambda: read_distribution(written(f"mesh{suffix}", content), mesh, MM, "0.1mm..2mm"))


def _mesh_seeds(suffix):
    for name, content in seeds.texture_files().items():
        written(name, content)
    return seeds.mesh_contents(suffix)


def _shapes(content, name):
    opened = open_animation(written(name, content))
    for X in opened.shapes:
        assert X.shape == opened.mesh.V.shape


def _series_seeds():
    for name, content in (("box", FILES["little.ply"]), ("cube", ply(seeds.MESH.V, seeds.MESH.F))):
        written(f"{name}.ply", content if isinstance(content, bytes) else content.encode())
    return [seeds.SERIES]


def _point_cache(content, suffix):
    for X in read_point_cache(written(f"cache{suffix}", content), MESH):
        assert np.isfinite(X).all()


# ---- what belongs to a mesh


def _selection(content, suffix):
    selection = read_selection_file(written(f"selection{suffix}", content), MESH)
    write_selection(FOLDER / f"selected{suffix}", MESH, selection)
    for other in SELECTION_FORMATS:
        with suppress(InputError):  # .sel, for one, cannot store an empty handle
            write_selection(FOLDER / f"selected{other}", MESH, selection)


def _numbers(content):
    path = written("numbers.sel", content)
    each_of(lambda: read_region(path, len(MESH.V)), lambda: read_transform(path))


def _images(content):
    each_of(lambda: read_image(content, "a"), lambda: read_picture(content, "a"))
    try:
        png_content(read_png(content, 64))
    except ValueError:
        return


def _wall(content, suffix):
    name = f"wall{suffix}"
    with suppress(InputError):
        found = read_distribution(written(name, content), MESH, MM)
        write_distribution(FOLDER / "again.csv", found.in_unit(MM))
        assert read_distribution(FOLDER / "again.csv", MESH, MM).in_unit(MM).triangles.min() > 0.0
        assert copy(found) == found
        assert found.on(Mesh(2.0 * MESH.V, MESH.F)) != str(found)
    each_of(
        lambda: read_distribution(written(name, content), MESH, MM, "0.1mm..2mm" if suffix == ".ply" else ""),
        lambda: read_distribution(FOLDER / name, MESH, Unit.NONE),
    )


def _plan(content):
    read_plan(written("plan.csv", content), InputFiles(FOLDER / "inputs", keeps_copies=False))


def _plan_seeds():
    seeds.plan_folder(FOLDER)
    return seeds.PLANS


def _session(content):
    path = written("session.apd", content)
    opened = open_session_file(path)
    save_session(FOLDER / "saved.apd", opened.state, opened.view, True, True, timeline=opened.timeline)
    assert len(saved_timeline(opened.timeline, opened.state).steps) <= len(opened.timeline.steps)
    save_if_unchanged(KnownFile(path), path, *open_session(path))
    assert has_mesh(path, opened.state.document.mesh)


def _case(content):
    """A result, with check sum and lengths made right, without which the rest is never read."""
    head, body = struct.Struct("<IQQ"), content[29:]
    if len(content) >= 29:
        text = min(int.from_bytes(content[13:21], "little"), len(body))
        content = content[:9] + head.pack(zlib.crc32(body), text, len(body) - text) + body
    write_case(case_path(FOLDER, "ab12"), content)
    assert case_sizes(FOLDER) == {"ab12": len(content)}
    try:
        case_to_bytes(read_case(FOLDER, "ab12", with_shape=True))
    except InputError as error:
        raise ValueError from error
    case_from_bytes(content)


# ---- texts


def _quantities(content):
    text, names = content.decode(errors="replace"), MESH.named_lengths
    for read in (
        lambda: parse_length(text, MM, names),
        lambda: parse_length(text, Unit.NONE, names),
        lambda: parse_angle(text, names),
        lambda: parse_number(text, names),
        lambda: parse_volume(text, MM),
    ):
        try:
            found = read()
        except InputError:
            continue
        assert np.isfinite(found), f"{found} was read"


def _motion(content):
    text = content.decode(errors="replace")
    for step in parse_motion(text):
        step.parse_amounts(MM)
    motion_steps(STATE.document, text, MM)


def _typed(content):
    text = content.decode(errors="replace")
    wall, said = WallText.from_field_texts(*text.split("|")), TypedValues(STORE)
    each_of(
        lambda: said.parse_vertices(text),
        lambda: said.parse_fraction_or_length(text, 2.0),
        lambda: said.parse_point(text),
        lambda: said.parse_vector(text),
        lambda: parse_volume_target(text, MM),
        *(
            partial(
                lambda design: design_table(ROW, list(map(parse_variable, text.split("&"))), design, 4, 0),
                each,
            )
            for each in DESIGNS
        ),
        lambda: typed_mass(wall, 9.0, MM),
        lambda: typed_mass(wall, 9.0, MM, 2.0),
        lambda: typed_mass(wall, 9.0, Unit.NONE),
        lambda: press_method(parse_wall(wall, MM), None, "exact"),
        lambda: with_part_thickness(wall, text, PART, MESH, MM),
        *(partial(parse_cell, name, text) for name in COLUMNS),
    )
    assert wall.text(MM) or not any(map(str.strip, wall.field_texts[:3]))
    for known in (wall.usable_density(), wall.contact_distance(MM)):
        assert known is None or known > 0.0


def _words(*texts):
    return lambda: [text.encode() for text in texts]


TARGETS: dict[str, Target] = {
    suffix[1:]: Target(partial(_mesh, suffix=suffix), _MODULES[suffix], partial(_mesh_seeds, suffix))
    for suffix in MESH_FORMATS
}
for _suffix in (".pc2", ".mdd"):
    TARGETS[_suffix[1:]] = Target(
        partial(_point_cache, suffix=_suffix),
        ("files/animations/animation_reading.py",),
        partial(seeds.animation_contents, _suffix),
    )
TARGETS["morph"] = Target(
    partial(_shapes, name="morph.glb"),
    (f"{_GLTF}weight_keys.py", "files/animations/animation_reading.py"),
    partial(seeds.animation_contents, ".glb"),
)
TARGETS["pvd"] = Target(
    partial(_shapes, name="series.pvd"), ("files/animations/animation_reading.py",), _series_seeds
)
for _suffix in SELECTION_FORMATS:
    TARGETS[f"selection-{_suffix[1:]}"] = Target(
        partial(_selection, suffix=_suffix),
        (
            f"files/selections/{'survey_formats' if _suffix == '.sel' else 'selection_files'}.py",
            "files/selections/selection.py",
        ),
        partial(seeds.selection_contents, _suffix),
    )
TARGETS |= {
    "numbers": Target(_numbers, ("files/selections/survey_formats.py",), seeds.number_contents),
    "images": Target(
        _images, ("files/formats/texture_images.py", "files/picture_files.py"), seeds.image_contents
    ),
    "wall-csv": Target(
        partial(_wall, suffix=".csv"), ("session/quantities/wall_distribution.py",), lambda: seeds.WALLS
    ),
    "wall-ply": Target(
        partial(_wall, suffix=".ply"),
        ("session/quantities/wall_distribution.py",),
        lambda: [*seeds.selection_contents(".ply"), *seeds.wall_contents()],
    ),
    "obstacles": Target(
        lambda content: read_obstacles(written("obstacles.json", content)),
        ("session/storage/part_json.py", "files/storage/json_fields.py"),
        seeds.obstacle_contents,
    ),
    "plan": Target(_plan, ("cases/plan.py", "cases/plan_columns.py"), _plan_seeds),
    "case": Target(_case, ("cases/case_file.py",), seeds.case_contents, ValueError),
    "session": Target(
        _session,
        tuple(
            f"session/storage/{name}.py"
            for name in ("session_file", "session_json", "part_json", "timeline_json")
        )
        + ("files/storage/archive.py", "files/storage/json_fields.py"),
        session_contents,
    ),
    "motion": Target(
        _motion,
        ("session/posing/motion_text.py",),
        _words(
            "twist 120deg; push 30%",
            "handle 1: turn 30deg about x; move 0 2cm 0; bend 1rad about z",
            "scale 1.5",
            "handle 2: twist 5",
            *(f"{word} 1" for word in MOTION_KINDS),
        ),
    ),
    "quantity": Target(
        _quantities,
        ("session/quantities/expressions.py",),
        _words(
            "2*(3mm+1cm)/4",
            "sin(30deg)*L",
            "1/3 in",
            "atan2(1,2)",
            "sqrt(4)^2 - -1e3",
            "0.5 l",
            "min(X, Y, D)",
            "1 1/2 ft",
            "asin(0.5)",
            "1,5mm",
            "250ml",
            "pi rad",
            "2mm^2/1mm",
            "atan(1)",
            "acos(0.5)+asin(1)",
            "cos(60°)*tan(45deg)",
            "1.234,5",
            "1,234",
            "-(2+-3)*4 in",
            "2^-2",
            "(4mm^2)^0.5",
            "max(1, 2)",
            "abs(-2)",
            "1mm + 2",
            "60 * ((((1))))",
            70 * "(" + "1",
            "sin(1, 2)",
            "tan(90deg)",
            "cos(1mm)",
            "asin(1deg)",
            "acos(2)",
            "1mm + 1deg",
            "2^1mm",
            "0^-1",
            "9^999999",
        ),
    ),
    "typed": Target(
        _typed,
        ("session/typed_values.py", "session/quantities/wall.py", "cases/plan_columns.py", "cases/design.py"),
        _words(
            "3, 10-20",
            "y > 80% and x < 0 or -1 < z <= 1mm",
            "0, 0.5Y, 12mm",
            "120%",
            "push=1mm..5mm:log",
            "push=1mm,2mm",
            "push=1..5mm&steps=1..4&twist=0..90deg",
            "stiffness=0.001..0.1:log",
            "stiffness=0..0.1:log",
            "push=1..5mm&push=2..4mm",
            "method=exact,arap&push=5..1",
            "0.3mm|1.38|2 GPa|0.3||pet-bottle",
            "0.3|1.38 g/cm³|2|0.3|1mm|",
            "0.3mm||||",
            "|||||pet-film",
            "0.2",
            "20-10",
            " ",
            "20% < 80% < z",
            "0mm|1.38|2 GPa",
            "|1.38|2 GPa",
            "0.3mm||2|0.38",
            "5-",
            "z > 0.5X",
            "0.2 < x",
            "1 < 2",
            "yes",
            "auto",
            "exact",
            "mm",
        ),
    ),
}


# ---- mutation


def mutated(content, chance, mutate):
    """Other content for a target: by the damage of fuzz.py, by libFuzzer, or in a member of an archive."""
    if content.startswith(b"PK\3\4") and chance.random() < 0.9:
        try:
            members = seeds.unpacked(content)
        except Exception:  # such as zlib.error: whatever the library finds wrong with it
            return mutate(content)
        if members:
            texts = [each for each in members if not each.endswith((".npy", ".png", ".obj"))]
            which = chance.choice(texts if texts and chance.random() < 0.7 else list(members))
            members[which] = _other(members[which], chance, mutate)
            return seeds.packed(members)
    return _other(content, chance, mutate)


def _other(content, chance, mutate):
    is_json = content.startswith(b"glTF") or content.lstrip()[:1] in (b"{", b"[")
    if is_json and chance.random() < 0.6:
        return other_json(content, chance)
    if not content or chance.random() < 0.4:
        return mutate(content)
    return chance.choice(ANY)(content, chance)
