"""JSON conversion of the document, frame and view of a session.

Numbers are restored bit for bit. The input may be damaged or malicious: invalid content raises ValueError
with a phrase.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.files.storage.json_fields import JsonFields
from apd_viewer.geometry.energy.wall_map import WallMap
from apd_viewer.geometry.mesh.arrays import LARGEST_COORDINATE
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES
from apd_viewer.geometry.pose.frame import Frame, FrameContact
from apd_viewer.geometry.solver.convergence import Convergence, check_convergence
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.geometry.solver.settings import SETTINGS, Setting, SettingKind, Settings
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.handles_and_regions import MOST_POSES, NO_FLAGS
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle
from apd_viewer.session.model.state import State, shape_frame
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import CameraPose, Point3, RegionImage, View
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS
from apd_viewer.session.quantities.units import SYMBOLS, Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_distribution import WallDistribution
from apd_viewer.session.storage import part_json

_POINTS = ("position", "focal", "up")
_WALL = WallText._fields
_MAP, _UNIT = "wall_map", "thickness_unit"  # digest of a wall map, and unit of a wall distribution
WallMaps: TypeAlias = Mapping[str, WallMap]
NO_MAPS: WallMaps = {}
_AXES = "xyz"
_NO_OVERLAY = "none"
# Values of settings for sessions older than the setting, if different from the current default.
_OF_OLDER_SESSIONS = {"calm": False}


def document_to_json(document: Document) -> dict[str, Any]:
    """JSON of a document without its mesh and arrays."""
    return {
        "handles": [part_json.handle_to_json(handle) for handle in document.handles],
        "regions": [
            {
                "name": part.name,
                "area": part_json.number_to_json(part.area),
                **part_json.flags_to_json(part.flags),
            }
            for part in document.regions
        ],
        **settings_to_json(document.settings),
        **(
            {"obstacles": [part_json.obstacle_to_json(each) for each in document.obstacles]}
            if document.obstacles
            else {}
        ),
        # Sessions without this field were written when all loose parts were immobile.
        **(
            {"staying": list(document.immobile_components)}
            if document.immobile_components or document.loose_components
            else {}
        ),
        **part_json.measurements_to_json(document.measurements),
        **({"closed": list(document.closed_openings)} if document.closed_openings else {}),
        **({"base": part_json.flags_to_json(document.base)} if document.base != NO_FLAGS else {}),
        **({"poses": [part_json.pose_to_json(pose) for pose in document.poses]} if document.poses else {}),
        **({} if document.mirror_axis is None else {"mirror": _AXES[document.mirror_axis]}),
    }


def document_from_json(
    fields: JsonFields, mesh: Mesh, arrays: dict[str, np.ndarray], maps: WallMaps = NO_MAPS
) -> Document:
    """Document from JSON, mesh, arrays ``labels``, ``member``, ``grip``, and maps."""
    handles = tuple(part_json.handle_from_json(part) for part in fields.nested_list("handles", MOST_HANDLES))
    regions = tuple(part_json.region_from_json(part) for part in fields.nested_list("regions", MOST_REGIONS))
    labels, member = arrays["labels"], arrays["member"]
    if not handles or labels.max() >= HANDLE + len(handles):
        raise ValueError(tr("“labels” in it refer to a handle that does not exist"))
    if member.max() > len(regions):
        raise ValueError(tr("“member” in it refers to a region that does not exist"))
    document = Document(
        mesh,
        labels,
        arrays["grip"],
        member,
        handles,
        regions,
        _with_map(settings_from_json(fields), fields, maps),
        obstacles=_obstacles(fields),
        base=part_json.flags_from_json(fields.nested_fields("base"))
        if fields.has_value("base")
        else NO_FLAGS,
        measurements=part_json.measurements_from_json(fields, len(mesh.F)),
        closed_openings=fields.vertices("closed", len(mesh.V)),
        poses=tuple(part_json.pose_from_json(each) for each in fields.nested_list("poses", MOST_POSES))
        if fields.has_value("poses")
        else (),
        mirror_axis=_axis(fields.text("mirror")) if fields.has_value("mirror") else None,
    )
    return replace(document, immobile_components=_staying_components(fields, document, arrays["shape"]))


def _obstacles(fields: JsonFields) -> tuple[NamedObstacle, ...]:
    if not fields.has_value("obstacles"):
        return ()
    return tuple(
        part_json.obstacle_from_json(each) for each in fields.nested_list("obstacles", MOST_OBSTACLES)
    )


def _axis(name: str) -> int:
    if len(name) != 1 or name not in _AXES:
        raise ValueError(tr("its “mirror” is unknown"))
    return _AXES.index(name)


def _staying_components(fields: JsonFields, document: Document, shape: np.ndarray) -> tuple[int, ...]:
    """Immobile loose parts; in older sessions of a deformed shape, all loose parts."""
    if fields.has_value("staying"):
        return fields.vertices("staying", len(document.mesh.V))
    return () if shape is document.mesh.V else tuple(part.first for part in document.loose_components)


def frame_to_json(frame: Frame, count: int) -> dict[str, Any]:
    """JSON of the frame fields not measured on the shape, with ``count`` obstacles."""
    return {
        "iteration": int(frame.iteration),
        "settled": bool(frame.settled),
        "converged": bool(frame.converged),
        "handle_drift": float(frame.handle_drift),
        "unreached": frame.unreached,
        "energy": None if frame.energy is None else float(frame.energy),
        "stable": frame.stable,
        "saddle_escapes": int(frame.saddle_escapes),
        **({} if frame.share_reached == 1.0 else {"share_reached": float(frame.share_reached)}),
        **({} if frame.contact is None else {"contact": frame.contact._asdict()}),
        **_obstacles_to_json(frame, count),
    }


def _obstacles_to_json(frame: Frame, count: int) -> dict[str, Any]:
    """JSON of obstacle displacements, and of loads if known."""
    if not count or len(frame.shifts) != count:  # an obstacle has been added or removed since
        return {}
    loads = {"loads": frame.loads.tolist()} if len(frame.loads) == len(frame.shifts) else {}
    return {**loads, "shifts": frame.shifts.tolist()}


def frame_from_json(fields: JsonFields, state: State, U: np.ndarray) -> Frame:
    """Frame from JSON, with its shape ``U`` (n, 3) measured again."""
    frame = shape_frame(state.document.mesh, state.inspection, U)
    settled, count = fields.flag("settled"), len(state.document.obstacles)
    return replace(
        frame,
        iteration=fields.count("iteration"),
        settled=settled,
        converged=fields.flag("converged") and settled,
        handle_drift=fields.number("handle_drift", 0.0),
        regions=state.document.region_areas(U),
        unreached=fields.text("unreached") if fields.has_value("unreached") else None,
        energy=fields.number("energy", 0.0) if fields.has_value("energy") else None,
        stable=fields.flag("stable") if fields.has_value("stable") else None,
        saddle_escapes=fields.count("saddle_escapes") if fields.has_value("saddle_escapes") else 0,
        share_reached=fields.number("share_reached", 0.0, 1.0) if fields.has_value("share_reached") else 1.0,
        contact=_contact_from_json(fields.nested_fields("contact")) if fields.has_value("contact") else None,
        loads=part_json.vectors_from_json(fields, "loads", count),
        shifts=part_json.vectors_from_json(fields, "shifts", count),
    )


def _contact_from_json(fields: JsonFields) -> FrameContact:
    least = fields.number("least_gap", 0.0) if fields.has_value("least_gap") else None
    return FrameContact(fields.count("pairs"), least, fields.count("exempt"))


def view_to_json(view: View) -> dict[str, Any]:
    """JSON of the view."""
    eye = view.camera
    camera = eye and {
        **{name: [float(x) for x in getattr(eye, name)] for name in _POINTS},
        "angle": float(eye.angle),
    }
    said: dict[str, Any] = {
        "camera": camera,
        "unit": Unit(view.unit).symbol or None,
        "wall": _wall_to_json(view.wall),
        "overlay": view.overlay if view.overlay is None else view.overlay or _NO_OVERLAY,
    }
    if Unit(view.unit).is_guess:
        said["unit_is_guess"] = True
    if view.image is not None:
        said["image"] = {"name": view.image.name, "up_axis": view.image.up_axis.value}
    return said if view.up_axis is None else {**said, "up_axis": view.up_axis.value}


def view_from_json(fields: JsonFields, maps: WallMaps = NO_MAPS) -> View:
    """View from JSON, and wall maps."""
    unit = _unit(fields)
    wall = _wall_from_json(fields.nested_fields("wall"), maps) if fields.has_value("wall") else WallText()
    overlay = fields.text("overlay") if fields.has_value("overlay") else None
    overlay = "" if overlay == _NO_OVERLAY else overlay
    up_axis = _up_axis(fields.text("up_axis")) if fields.has_value("up_axis") else None
    if not fields.has_value("camera"):
        return View(None, unit, wall, overlay, up_axis)
    camera = fields.nested_fields("camera")
    position, focal, up = (camera.array(name, 3) for name in _POINTS)
    across = np.linalg.norm(np.cross(focal - position, up))
    if not across > part_json.LEAST_POSITIVE * np.linalg.norm(focal - position) * np.linalg.norm(up):
        raise ValueError(tr("its “camera” has no direction"))
    angle = camera.number("angle", part_json.LEAST_POSITIVE, np.pi - part_json.LEAST_POSITIVE)
    return View(CameraPose(_point(position), _point(focal), _point(up), angle), unit, wall, overlay, up_axis)


def image_from_json(fields: JsonFields, content: bytes, inside: np.ndarray) -> RegionImage:
    """Image on a region from JSON, the content of its file and its vertices (n,)."""
    return RegionImage(fields.text("name"), content, inside.astype(bool), _up_axis(fields.text("up_axis")))


def _unit(fields: JsonFields) -> str:
    symbol = fields.text("unit") if fields.has_value("unit") else ""
    if symbol not in ("", *SYMBOLS):
        raise ValueError(tr("its “unit” is unknown"))
    is_guess = fields.has_value("unit_is_guess") and fields.flag("unit_is_guess")
    return Unit(symbol).as_guess.value if is_guess else symbol


def _up_axis(name: str) -> UpAxis:
    if name not in [axis.value for axis in UpAxis]:
        raise ValueError(tr("its “up_axis” is unknown"))
    return UpAxis(name)


def _wall_to_json(wall: WallText) -> dict[str, Any]:
    """Wall as typed; empty fields unknown to older sessions are left out."""
    said = dict(zip(_WALL, wall.field_texts, strict=True))
    told = {name: word or None for name, word in said.items() if word or name in ("thickness", "density")}
    if not isinstance(wall.thickness, WallDistribution):
        return told
    return {**told, _MAP: wall.thickness.thickness.digest, _UNIT: wall.thickness.unit or None}


def _wall_from_json(fields: JsonFields, maps: WallMaps) -> WallText:
    """Wall as typed; null fields are empty."""
    words = [fields.text(name) if fields.has_value(name) else "" for name in _WALL]
    if any(len(word) > MOST_CHARACTERS for word in words):
        raise ValueError(tr("its “wall” is damaged"))
    wall = WallText.from_field_texts(*words)
    if not fields.has_value(_MAP):
        return wall
    known, unit = maps.get(fields.text(_MAP)), fields.text(_UNIT) if fields.has_value(_UNIT) else ""
    if known is None or unit not in ("", *SYMBOLS):
        raise ValueError(tr("its “wall” is damaged"))
    return wall._replace(thickness=WallDistribution(wall.thickness, known, unit))


def _with_map(settings: Settings, fields: JsonFields, maps: WallMaps) -> Settings:
    """Settings with their wall map, if there is one."""
    known = maps.get(fields.text(_MAP)) if fields.has_value(_MAP) else None
    return settings if known is None else replace(settings, wall_thickness=known)


def _point(numbers: np.ndarray) -> Point3:
    x, y, z = numbers.tolist()
    return x, y, z


def settings_to_json(settings: Settings) -> dict[str, Any]:
    """JSON of all settings by name, and the digest of a wall map; unset ones are null."""
    thickness = settings.wall_thickness
    told = {name: _to_json(setting.kind, getattr(settings, name)) for name, setting in SETTINGS.items()}
    return told | ({_MAP: thickness.digest} if isinstance(thickness, WallMap) else {})


def settings_from_json(fields: JsonFields) -> Settings:
    """Settings from JSON, with defaults if missing; raises ValueError if damaged."""
    found = {
        name: _from_json(fields, name, setting)
        for name, setting in SETTINGS.items()
        if fields.has_value(name)
    }
    return Settings(**_OF_OLDER_SESSIONS | found)


def _to_json(kind: SettingKind, value: Any) -> Any:
    match kind:
        case SettingKind.METHOD:
            return value
        case SettingKind.SWITCH:
            return bool(value)
        case SettingKind.CONVERGENCE:
            return value._asdict()
        case _:
            return part_json.number_to_json(value)


def _from_json(fields: JsonFields, name: str, setting: Setting) -> Any:
    match setting.kind:
        case SettingKind.METHOD:
            return _method_from_json(fields.text(name))
        case SettingKind.SWITCH:
            return fields.flag(name)
        case SettingKind.CONVERGENCE:
            return _convergence_from_json(fields.nested_fields(name))
        case SettingKind.NUMBER | SettingKind.PRESSURE:
            return fields.number(name, setting.least, setting.most)
        case SettingKind.VOLUME:
            return fields.number(name, part_json.LEAST_POSITIVE, setting.most)
        case _:
            return fields.number(name, 1.0 / LARGEST_COORDINATE, LARGEST_COORDINATE)


def _method_from_json(name: str) -> str:
    if name not in METHODS:
        raise ValueError(tr("its “method” is unknown"))
    return name


def _convergence_from_json(fields: JsonFields) -> Convergence:
    found = Convergence(
        fields.count("most_iterations"), fields.number("energy_tolerance"), fields.number("step_tolerance")
    )
    if fields.has_value("imperfection"):
        found = found._replace(imperfection=fields.number("imperfection", 0.0), seed=fields.count("seed"))
    try:
        check_convergence(found)
    except InputError:
        raise ValueError(tr("its “convergence” is damaged")) from None
    return found
