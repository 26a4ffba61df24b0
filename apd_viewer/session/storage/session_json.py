"""Document, frame and view to and from the JSON of a session.

Numbers come back bit for bit. What is read may be damaged, or written to do harm: whatever makes no sense is
a ValueError with a phrase.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import MOST_REGIONS
from apd_viewer.files.storage.json_fields import Fields
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.geometry.pose.constraints import HANDLE, MOST_HANDLES
from apd_viewer.geometry.pose.frame import Frame, Touch
from apd_viewer.geometry.solver.convergence import DEFAULT_CONVERGENCE, Convergence, check_convergence
from apd_viewer.geometry.solver.methods import METHODS
from apd_viewer.language import tr
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle
from apd_viewer.session.model.named_parts import MOST_POSES, NO_FLAGS
from apd_viewer.session.model.state import State, shape_frame
from apd_viewer.session.model.up_axis import UpAxis
from apd_viewer.session.model.view import Point, Standpoint, View
from apd_viewer.session.quantities.expressions import MOST_CHARACTERS
from apd_viewer.session.quantities.units import SYMBOLS, Unit
from apd_viewer.session.quantities.wall_mass import Wall
from apd_viewer.session.storage.measurements_json import measurements_of, measurements_said
from apd_viewer.session.storage.obstacle_json import obstacle_of, obstacle_said, vectors_of
from apd_viewer.session.storage.part_json import (
    LEAST,
    MOST,
    flags_of,
    flags_said,
    handle_of,
    handle_said,
    number_said,
    percent_of,
    pose_of,
    pose_said,
    region_of,
)

_NUMBERS = ("tolerance", "stiffness", "area_stiffness", "shear_stiffness", "area")
_POINTS = ("position", "focal", "up")
_AXES = "xyz"
_NO_OVERLAY = "none"


def document_said(document: Document) -> dict[str, Any]:
    """All of a document but for its mesh and its arrays."""
    return {
        "handles": [handle_said(handle) for handle in document.handles],
        "regions": [
            {"name": part.name, "area": number_said(part.area), **flags_said(part.flags)}
            for part in document.regions
        ],
        "method": document.method,
        **{name: number_said(getattr(document, name)) for name in _NUMBERS},
        "hold_area": bool(document.hold_area),
        "volume": number_said(document.volume),
        # Sessions without it are from a time when no calm parts were kept.
        **({"calm": True} if document.calm else {}),
        "contact": bool(document.contact),
        **({"thickness": number_said(document.thickness)} if document.thickness else {}),
        **({"obstacles": [obstacle_said(each) for each in document.obstacles]} if document.obstacles else {}),
        **_convergence_said(document.convergence),
        # Sessions without it are from a time when loose parts stayed.
        **({"staying": list(document.staying)} if document.staying or document.loose_parts else {}),
        **measurements_said(document.measurements),
        **({"base": flags_said(document.base)} if document.base != NO_FLAGS else {}),
        **({"poses": [pose_said(pose) for pose in document.poses]} if document.poses else {}),
        **({} if document.mirror is None else {"mirror": _AXES[document.mirror]}),
    }


def _convergence_said(convergence: Convergence) -> dict[str, Any]:
    """The criteria that end the iterations, if they are not the usual ones."""
    return {} if convergence == DEFAULT_CONVERGENCE else {"convergence": convergence._asdict()}


def _convergence(said: Fields) -> Convergence:
    if not said.says("convergence"):
        return DEFAULT_CONVERGENCE
    criteria = said.part("convergence")
    found = Convergence(
        criteria.count("most_iterations"),
        criteria.number("energy_tolerance"),
        criteria.number("step_tolerance"),
    )
    try:
        check_convergence(found)
    except InputError:
        raise ValueError(tr("its “convergence” is damaged")) from None
    return found


def document_of(said: Fields, mesh: Mesh, arrays: dict[str, np.ndarray]) -> Document:
    """Document from its JSON, its mesh and ``labels``, ``member`` and ``grip``."""
    handles = tuple(handle_of(part) for part in said.parts("handles", MOST_HANDLES))
    regions = tuple(region_of(part) for part in said.parts("regions", MOST_REGIONS))
    labels, member, method = arrays["labels"], arrays["member"], said.text("method")
    if not handles or labels.max() >= HANDLE + len(handles):
        raise ValueError(tr("“labels” in it refer to a handle that does not exist"))
    if member.max() > len(regions):
        raise ValueError(tr("“member” in it refers to a region that does not exist"))
    if method not in METHODS:
        raise ValueError(tr("its “method” is unknown"))
    document = Document(
        mesh,
        labels,
        arrays["grip"],
        member,
        handles,
        regions,
        method,
        tolerance=said.number("tolerance", LEAST, MOST),
        stiffness=said.number("stiffness", 0.0, MOST),
        area_stiffness=said.number("area_stiffness", 0.0, MOST),
        shear_stiffness=said.number("shear_stiffness", 0.0, MOST),
        area=said.number("area", LEAST, MOST),
        hold_area=said.flag("hold_area"),
        volume=percent_of(said, "volume"),
        calm=said.says("calm") and said.flag("calm"),
        # Sessions without it may be from a time when walls passed through each other by default.
        contact=said.says("contact") and said.flag("contact"),
        thickness=said.number("thickness", LEAST, MOST) if said.says("thickness") else None,
        obstacles=_obstacles(said),
        base=flags_of(said.part("base")) if said.says("base") else NO_FLAGS,
        convergence=_convergence(said),
        measurements=measurements_of(said, len(mesh.F)),
        poses=tuple(pose_of(each) for each in said.parts("poses", MOST_POSES)) if said.says("poses") else (),
        mirror=_axis(said.text("mirror")) if said.says("mirror") else None,
    )
    return replace(document, staying=_staying(said, document, arrays["shape"]))


def _obstacles(said: Fields) -> tuple[NamedObstacle, ...]:
    if not said.says("obstacles"):
        return ()
    return tuple(obstacle_of(each) for each in said.parts("obstacles", MOST_OBSTACLES))


def _axis(name: str) -> int:
    if len(name) != 1 or name not in _AXES:
        raise ValueError(tr("its “mirror” is unknown"))
    return _AXES.index(name)


def _staying(said: Fields, document: Document, shape: np.ndarray) -> tuple[int, ...]:
    """Parts that stay; of a deformed shape in an older session all loose ones."""
    n = len(document.mesh.V)
    if said.says("staying"):
        staying = said.counts("staying", n)
        if any(first >= n for first in staying):
            raise ValueError(tr("“staying” in it refers to a vertex that does not exist"))
        return staying
    return () if shape is document.mesh.V else tuple(part.first for part in document.loose_parts)


def frame_said(frame: Frame) -> dict[str, Any]:
    """The fields of a frame not measured on its shape, as JSON."""
    return {
        "iteration": int(frame.iteration),
        "settled": bool(frame.settled),
        "converged": bool(frame.converged),
        "handle_drift": float(frame.handle_drift),
        "unreached": frame.unreached,
        "energy": None if frame.energy is None else float(frame.energy),
        **({} if frame.share_reached == 1.0 else {"share_reached": float(frame.share_reached)}),
        **({} if frame.contact is None else {"contact": frame.contact._asdict()}),
        **_of_obstacles(frame),
    }


def _of_obstacles(frame: Frame) -> dict[str, Any]:
    """Shifts and loads of obstacles; at first there are no loads."""
    if not len(frame.shifts):
        return {}
    loads = {"loads": frame.loads.tolist()} if len(frame.loads) == len(frame.shifts) else {}
    return {**loads, "shifts": frame.shifts.tolist()}


def frame_of(said: Fields, state: State, U: np.ndarray) -> Frame:
    """The frame of a state again, measured anew on its shape ``U`` (n, 3)."""
    frame = shape_frame(state.document.mesh, state.inspection, U)
    settled, count = said.flag("settled"), len(state.document.obstacles)
    return replace(
        frame,
        iteration=said.count("iteration"),
        settled=settled,
        converged=said.flag("converged") and settled,
        handle_drift=said.number("handle_drift", 0.0),
        regions=state.document.region_areas(U),
        unreached=said.text("unreached") if said.says("unreached") else None,
        energy=said.number("energy", 0.0) if said.says("energy") else None,
        share_reached=said.number("share_reached", 0.0, 1.0) if said.says("share_reached") else 1.0,
        contact=_touch(said.part("contact")) if said.says("contact") else None,
        loads=vectors_of(said, "loads", count),
        shifts=vectors_of(said, "shifts", count),
    )


def _touch(said: Fields) -> Touch:
    least = said.number("least_gap", 0.0) if said.says("least_gap") else None
    return Touch(said.count("pairs"), least, said.count("exempt"))


def view_said(view: View) -> dict[str, Any]:
    """The view as JSON."""
    eye = view.camera
    camera = eye and {
        **{name: [float(x) for x in getattr(eye, name)] for name in _POINTS},
        "angle": float(eye.angle),
    }
    said: dict[str, Any] = {
        "camera": camera,
        "unit": Unit(view.unit).symbol or None,
        "wall": {name: text or None for name, text in view.wall._asdict().items()},
        "overlay": view.overlay if view.overlay is None else view.overlay or _NO_OVERLAY,
    }
    if Unit(view.unit).is_guess:
        said["unit_is_guess"] = True
    return said if view.up_axis is None else {**said, "up_axis": view.up_axis.value}


def view_of(said: Fields) -> View:
    """The view again."""
    unit = _unit(said)
    wall = _wall(said.part("wall")) if said.says("wall") else Wall()
    overlay = said.text("overlay") if said.says("overlay") else None
    overlay = "" if overlay == _NO_OVERLAY else overlay
    up_axis = _up_axis(said.text("up_axis")) if said.says("up_axis") else None
    if not said.says("camera"):
        return View(None, unit, wall, overlay, up_axis)
    camera = said.part("camera")
    position, focal, up = (camera.numbers(name, 3) for name in _POINTS)
    across = np.linalg.norm(np.cross(focal - position, up))
    if not across > LEAST * np.linalg.norm(focal - position) * np.linalg.norm(up):
        raise ValueError(tr("its “camera” has no direction"))
    angle = camera.number("angle", LEAST, np.pi - LEAST)
    return View(Standpoint(_point(position), _point(focal), _point(up), angle), unit, wall, overlay, up_axis)


def _unit(said: Fields) -> str:
    symbol = said.text("unit") if said.says("unit") else ""
    if symbol not in ("", *SYMBOLS):
        raise ValueError(tr("its “unit” is unknown"))
    is_guess = said.says("unit_is_guess") and said.flag("unit_is_guess")
    return Unit(symbol).guessed.value if is_guess else symbol


def _up_axis(name: str) -> UpAxis:
    if name not in [axis.value for axis in UpAxis]:
        raise ValueError(tr("its “up_axis” is unknown"))
    return UpAxis(name)


def _wall(said: Fields) -> Wall:
    """The wall as typed; null fields are empty."""
    typed = [said.text(name) if said.says(name) else "" for name in Wall._fields]
    if any(len(text) > MOST_CHARACTERS for text in typed):
        raise ValueError(tr("its “wall” is damaged"))
    return Wall(*typed)


def _point(numbers: np.ndarray) -> Point:
    x, y, z = numbers.tolist()
    return x, y, z
