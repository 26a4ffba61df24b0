"""Sessions to begin a fuzz with: as stored by earlier versions, rich, and damaged in one place."""

import io
import json
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from fuzz_seeds import STORED, WALLS, image_contents, obstacle_rows, packed, unpacked, written
from painted_meshes import MESH, painted

from apd_viewer.geometry.analysis.target_shape import TargetShape
from apd_viewer.geometry.mesh.mesh import Mesh
from apd_viewer.session.model.handles_and_regions import NamedRegion
from apd_viewer.session.model.state import initial_state
from apd_viewer.session.model.timeline import Timeline, TimelineStep
from apd_viewer.session.model.view import CameraPose, RegionImage, UpAxis, View
from apd_viewer.session.quantities.units import Unit
from apd_viewer.session.quantities.wall import WallText
from apd_viewer.session.quantities.wall_distribution import thickness_text
from apd_viewer.session.storage.session_file import save_session

_FLAT = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1.0]]
# What the JSON of a rich session has in one place, by the keys that lead there, and what it must not have.
_DAMAGE = (
    (("format",), "picture"),
    (("version",), 0),
    (("version",), 99),
    (("thicknesses",), [-1.0]),
    (("document", "mirror"), "w"),
    (("document", "method"), "magic"),
    (("document", "poisson"), 9.0),
    (("document", "volume"), 50.0),
    (("document", "convergence", "most_iterations"), 0),
    (("document", "closed"), [9999]),
    (("document", "regions"), {}),
    (("document", "handles", 0, "earlier"), [_FLAT]),
    (("document", "handles", 0, "pose"), [[1.0, 0, 0, 0]] * 4),
    (("document", "handles", 0, "line"), "x"),
    (("document", "measurements", 0, "kind"), "smell"),
    (("document", "measurements", 0, "plane", "normal"), [0.0, 0.0, 2.0]),
    (("document", "measurements", 2, "points"), []),
    (("document", "measurements", 2, "points", 0, "face"), 9999),
    (("document", "obstacles", 0, "kind"), "cloud"),
    (("document", "obstacles", 0, "axis"), None),
    (("document", "obstacles", 0, "axis"), [0.0, 0.0, 0.0]),
    (("frame", "settled"), "yes"),
    (("view", "camera", "up"), [0.0, 0.0, 0.0]),
    (("view", "unit"), "ell"),
    (("view", "unit_is_guess"), True),
    (("view", "up_axis"), "w"),
    (("view", "wall", "thickness"), 10_000 * "1"),
    (("view", "wall", "wall_map"), "0"),
    (("timeline", "shown"), 99),
    (("timeline", "shown_wall"), 1),
    (("timeline", "documents"), []),
    (("timeline", "steps", 1, "document"), 99),
)


def session_contents():
    """Sessions as stored by earlier versions, one with all that a session can hold, and damaged ones."""
    seam = np.arange(len(MESH.V))
    seam[1] = 0  # wider than what rounding joins, so that it is stored
    aimed, rich = initial_state(MESH), rich_session()
    aimed = aimed.updated(replace(aimed.document, target_shape=TargetShape(Mesh(1.1 * MESH.V, MESH.F))))
    welded, aimed = (
        written("a.apd", partial(save_session, state=state, view=View()))
        for state in (initial_state(MESH.welded_to(seam)), aimed)
    )
    return [
        *(path.read_bytes() for path in sorted(STORED.glob("*.apd"))),
        rich,
        *(damaged(rich, keys, value) for keys, value in _DAMAGE),
        *(welded, with_weld(welded, 9999)),
        *(aimed, damaged(aimed, ("target", "embedded"), None), damaged(aimed, ("target", "embedded"), ["a"])),
    ]


def damaged(session, keys, value):
    """Session with another value in one place of its JSON."""
    members = unpacked(session)
    part = said = json.loads(members["session.json"])
    for key in keys[:-1]:
        part = part[key]
    part[keys[-1]] = value
    return packed(members | {"session.json": json.dumps(said).encode()})


def with_weld(session, vertex):
    """Session of a mesh with welded seams, the first vertex welded to another one."""
    members, weld = unpacked(session), np.arange(len(MESH.V))
    weld[0], stream = vertex, io.BytesIO()
    np.save(stream, weld)
    return packed(members | {"weld.npy": stream.getvalue()})


def rich_session():
    mesh = MESH
    with tempfile.TemporaryDirectory() as folder:
        walls = Path(folder, "walls.csv")
        walls.write_bytes(WALLS[0])
        typed = thickness_text(str(walls), mesh, Unit.MILLIMETRE)
    selection = painted()
    labels = np.minimum(selection.labels, 2)
    state = initial_state(mesh)
    document = replace(
        state.document,
        labels=labels,
        member=selection.member,
        regions=(NamedRegion("Label «é»", 103.0), NamedRegion("b")),
        mirror_axis=1,
    ).with_settings(method="wall", wall_thickness=typed.in_unit(Unit.MILLIMETRE))
    state = state.updated(document)
    image = RegionImage("a.png", image_contents()[0], selection.member == 1, UpAxis.PLUS_Y)
    camera = CameraPose((0.1, -2.0, 30.0), (0.0, 0.3, 0.0), (0.0, 1.0, 0.0), 0.5)
    view = View(camera, "mm", WallText(typed, "1.38"), "bending", UpAxis.PLUS_Y, image)
    timeline = Timeline((TimelineStep(initial_state(mesh), True), TimelineStep(state, False, state)), 3)
    content = written(
        "a.apd", lambda path: save_session(path, state, view, True, picture=image.content, timeline=timeline)
    )
    members = unpacked(content)
    said = json.loads(members["session.json"])
    pose = np.eye(4).tolist()
    point = {"face": 3, "weights": [0.5, 0.25, 0.25]}
    said["document"] |= {
        "handles": [
            said["document"]["handles"][0]
            | {
                "waypoints": [pose],
                "earlier": [pose],
                "line": [0.0, 1.0, 0.0],
                "falloff": 1.5,
                "pivot": [0.0, 1.0, 2.0],
            }
        ],
        "obstacles": obstacle_rows(),
        "staying": [],
        "closed": [3],
        "poses": [{"name": "up", "handles": [{"name": "Arm", "pose": pose, "waypoints": [pose]}]}],
        "measurements": [
            {"name": "a", "kind": "section", "plane": {"normal": [0.0, 0.0, 1.0], "offset": 0.1}},
            {"name": "b", "kind": "level", "contents": {"up": [0.0, 1.0, 0.0], "volume": 2.0}},
            {"name": "c", "kind": "distance", "points": [point, point]},
        ],
    }
    count = len(said["document"]["obstacles"])
    said["frame"] |= {
        "contact": {"pairs": 3, "least_gap": 0.1, "exempt": 0},
        "share_reached": 0.5,
        "energy": 1.0,
    }
    said["frame"] |= {
        "loads": [[0.0] * 3] * count,
        "shifts": [[0.0] * 3] * count,
        "saddle_escapes": 1,
        "stable": True,
    }
    return packed(members | {"session.json": json.dumps(said).encode()})
