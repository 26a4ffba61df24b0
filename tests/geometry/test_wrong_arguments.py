"""Every argument of every public name, given what it cannot be: a sentence, or a sound meaning.

A table says which values are sound for which argument; all others must raise InputError, without a warning.
"""

import inspect
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from meshes import sphere

import apd_viewer
from apd_viewer.errors import InputError

BOTTLE = str(Path(__file__).parents[2] / "resources" / "bottle.obj")
V, F = sphere(1)
TOP, BOTTOM = np.flatnonzero(V[:, 2] > 0.8), np.flatnonzero(V[:, 2] < -0.8)
FIXED = np.concatenate([TOP, BOTTOM])
MESH = apd_viewer.Mesh(V, F)
HELD = {"V": V, "F": F, "fixed": FIXED, "handle": TOP}
TOUCHING = HELD | {"contact": True, "obstacles": [apd_viewer.sphere((0, 0, 3), 1.0)]}

WRONG = {
    "None": None,
    "no": "no",
    "empty": "",
    "length": "1mm",
    "True": True,
    "np.False_": np.False_,
    "0": 0,
    "-1": -1,
    "3": 3,
    "np.int8": np.int8(1),
    "np.float32": np.float32(0.5),
    "1e308": 1e308,
    "-1e308": -1e308,
    "inf": np.inf,
    "nan": np.nan,
    "huge": 10**400,
    "complex": 1 + 2j,
    "[]": [],
    "{}": {},
    "bytes": b"x",
    "object": object(),
    "call": lambda *_: None,
    "array": np.array([]),
    "nans": np.array([np.nan]),
    "text array": np.array(["a"]),
    "objects": np.array([None, 1], object),
}
FLAGS, NOTHING = {"True", "np.False_"}, set()
NUMBERS = {"0", "3", "np.int8", "np.float32"}
LENGTHS = {"None", "3", "np.int8", "np.float32"}
COUNTS = {"3", "np.int8"}
NONE, VERTICES = {"None"}, {"0", "3", "np.int8"}
IDS = {"0", "3", "np.int8", "[]", "array"}
# Sound values by the name of the argument, or by function and name where they differ.
SOUND = {
    **dict.fromkeys(("calm", "plain", "weld", "contact", "release", "tension_field", "held"), FLAGS),
    **dict.fromkeys(("stiffness", "area_stiffness", "shear_stiffness", "container"), NUMBERS),
    **dict.fromkeys(("tolerance", "radius", "size"), LENGTHS - {"None"}),
    **dict.fromkeys(("thickness", "gas", "filled_volume"), LENGTHS),
    "yield_radius": NONE,  # needs a stiffness
    "pressure": NONE,  # needs the method Wall
    "volume_readings up": NONE,
    "vessel volume level": NUMBERS | {"-1", "1e308", "-1e308", "inf", "huge"},
    "vessel level volume": {"0", "3", "np.int8", "np.float32"},
    "vessel filling volume": NUMBERS | {"1e308"},
    "wall_thickness": NONE,  # the others are too thick for this mesh
    "poisson": {"0", "np.float32"},
    "hardening": {"0", "np.float32"},
    "wall_map thickness": LENGTHS - {"None"},
    **dict.fromkeys(("wall_map young", "wall_map yield_radius"), LENGTHS),
    **dict.fromkeys(("Deformation gas", "deform gas"), NONE),  # needs contact
    **dict.fromkeys(("iterations", "steps", "most_iterations"), COUNTS),
    **dict.fromkeys(("shifts", "begin", "soft_targets", "rest", "area", "volume"), NONE),
    **dict.fromkeys(("start", "end", "vertex", "face"), VERTICES),
    "imperfection": {"0"},
    "seed": VERTICES,
    "vertices": IDS,
    "loose": IDS,
    "closed": {"[]", "array"},  # the mesh is closed
    "handle": {"None", "[]", "array"},
    "regions": {"[]"},
    "obstacles": {"[]"},
    "factored": {"None", "call"},
    "progress": {"call"},
    "packing": {"np.float32", "np.int8"},
    "name": {"no", "length"},
    "unit": {"None", "empty"},
    "origin": {"None"},
    "live base": IDS | {"None"},
    "live handles": {"None", "[]", "array"},
    "move handle": {"0"},
    "deform iterations": COUNTS | {"None"},
    "deform contact": {"None", "np.False_"},  # not with a number of iterations
    "deform progress": FLAGS | {"None", "call"},
    **dict.fromkeys(("open_mesh chord", "open_mesh edge"), NONE),  # the mesh is no CAD model
    "dented_shape seed": VERTICES | {"huge"},
    **dict.fromkeys(("dented_shape depth", "dented_shape length"), LENGTHS - {"None"}),
    "buckling_modes count": COUNTS,
    "press fixed": IDS,
    "press start": {"None"},
    "press to": {"np.float32", "np.int8"},
    "press stiffness": NUMBERS,
    "Mesh unit": {"no", "empty", "length"},
    "Mesh path": {"None", "no", "empty", "length"},
    "aim U": NONE,
    "in contact thickness": {"None"},  # the others are too thick for this mesh
    "in contact plain": {"np.False_"},
    "in contact contact": {"True"},  # with an obstacle
    "press thickness": {"None"},
    "sphere radius": LENGTHS - {"None"},
    "capsule radius": LENGTHS - {"None"},
}


def deformed(**options):
    return apd_viewer.deform(**HELD | {"targets": V[FIXED], "iterations": 1} | options)


def settled(convergence):
    return apd_viewer.deform(**HELD, targets=V[FIXED], contact=False, convergence=convergence)


def set_tolerance(tolerance):
    apd_viewer.Deformation(**HELD).tolerance = tolerance


@cache
def hull_readings():
    return apd_viewer.volume_readings(V, F).hull


@cache
def vessel():
    return apd_viewer.Vessel(V, F, (0, 0, 1))


CALLS = {
    "Deformation": (apd_viewer.Deformation, HELD),
    "in contact": (apd_viewer.Deformation, TOUCHING),
    "tolerance": (set_tolerance, {}),
    "keep": (lambda **said: apd_viewer.Deformation(**HELD).keep(**said), apd_viewer.Deformation.keep),
    "aim": (
        lambda **said: apd_viewer.Deformation(**TOUCHING).aim(**{"targets": V[FIXED]} | said),
        apd_viewer.Deformation.aim,
    ),
    "surround": (
        lambda **said: apd_viewer.Deformation(**TOUCHING).replace_obstacles(**said),
        apd_viewer.Deformation.replace_obstacles,
    ),
    "deform": (deformed, apd_viewer.deform),
    "press": (
        lambda **said: apd_viewer.press(
            **{"V": V, "F": F, "axis": (0, 0, 1), "to": 1.8, "steps": 1, "iterations": 1} | said
        ),
        apd_viewer.press,
    ),
    "Mesh": (apd_viewer.Mesh, {"V": V, "F": F}),
    "volume_readings": (apd_viewer.volume_readings, {"U": V, "F": F}),
    "bulk": (lambda **said: hull_readings().bulk(**said), apd_viewer.HullReadings.bulk),
    "count_in": (
        lambda **said: hull_readings().count_in(**{"container": 10.0} | said),
        apd_viewer.HullReadings.count_in,
    ),
    "sphere": (apd_viewer.sphere, {"centre": (0, 0, 0), "radius": 1.0}),
    "capsule": (apd_viewer.capsule, {"a": (0, 0, 0), "b": (1, 0, 0), "radius": 1.0}),
    "plate": (apd_viewer.plate, {"point": (0, 0, 0), "normal": (1, 0, 0), "size": 1.0}),
    "plane_section": (
        apd_viewer.plane_section,
        {"V": V, "F": F, "point": (0, 0, 0.1), "normal": (0, 0, 1)},
    ),
    "Vessel": (apd_viewer.Vessel, {"U": V, "F": F, "up": (0, 0, 1)}),
    "vessel volume": (lambda **said: vessel().volume(**said), apd_viewer.Vessel.volume),
    "vessel level": (lambda **said: vessel().level(**said), apd_viewer.Vessel.level),
    "vessel filling": (lambda **said: vessel().filling(**said), apd_viewer.Vessel.filling),
    "dented_shape": (apd_viewer.dented_shape, {"V": V, "F": F, "depth": 0.01, "length": 0.1}),
    "wall_map": (apd_viewer.wall_map, {"V": V, "F": F, "thickness": 0.02}),
    "buckling_modes": (
        apd_viewer.buckling_modes,
        {"V": V, "F": F, "axis": (0, 0, 1), "wall_thickness": 0.02, "count": 1},
    ),
    "geodesic_path": (apd_viewer.geodesic_path, {"V": V, "F": F, "start": 0, "end": 5}),
    "at_vertex": (apd_viewer.SurfacePoint.at_vertex, {"F": F, "vertex": 0}),
    "SurfacePoint": (
        lambda **said: apd_viewer.geodesic_path(
            V, F, apd_viewer.SurfacePoint(**{"face": 0, "weights": (0.2, 0.3, 0.5)} | said), 0
        ),
        apd_viewer.SurfacePoint,
    ),
    "Convergence": (
        lambda **said: settled(apd_viewer.Convergence(**{"most_iterations": 3} | said)),
        apd_viewer.Convergence,
    ),
    "Region": (
        lambda **said: deformed(regions=[apd_viewer.Region(**{"name": "top", "vertices": TOP} | said)]),
        apd_viewer.Region,
    ),
    # `live` asks for an extra after it has made this.
    "live": (apd_viewer.LiveView, {"mesh": MESH}),
    "move": (
        lambda **said: apd_viewer.LiveView(MESH, BOTTOM, TOP).move(**{"motion": np.eye(4)} | said),
        apd_viewer.LiveView.move,
    ),
    "open_mesh": (apd_viewer.open_mesh, {"path": BOTTLE}),
    "save_mesh": (apd_viewer.save_mesh, {"mesh": MESH, "U": V, "path": "saved.obj"}),
}
# What only the program makes.
MADE = {
    "BucklingModes",
    "Frame",
    "HullReadings",
    "InputError",
    "LiveView",
    "Obstacle",
    "PressBand",
    "PressStep",
    "Pressed",
    "Result",
    "VolumeReadings",
}


def arguments(call, given):
    """Names of the arguments of a call."""
    signature = inspect.signature(call if isinstance(given, dict) else given)
    return [name for name in signature.parameters if name not in ("self", "cls")]


def test_wrong_arguments_are_tried_with_everything_public():
    assert set(apd_viewer.__all__) - MADE - {"view"} <= CALLS.keys()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("function", CALLS)
def test_input_error_is_raised_by_a_wrong_argument_unless_that_has_a_sound_meaning(
    function, compiled, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    call, given = CALLS[function]
    wrong = []
    for name in arguments(call, given):
        sound = SOUND.get(f"{function} {name}", SOUND.get(name, NOTHING))
        for title, value in WRONG.items():
            try:
                call(**(given if isinstance(given, dict) else {}) | {name: value})
                said = "accepted"
            except InputError as error:
                said = "refused" if str(error).endswith(".") else f"refused by {error}"
            except Exception as error:
                said = repr(error)
            if said != ("accepted" if title in sound else "refused"):
                wrong.append(f"{name}={title}: {said}")
    assert wrong == []
