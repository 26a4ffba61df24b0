"""Arguments of scripts of the wrong kind: each raises one sentence, and nothing is computed from it."""

import re

import numpy as np
import pytest
from meshes import sphere

import apd_viewer
from apd_viewer.errors import InputError

V, F = sphere(2)
TOP, BOTTOM = np.flatnonzero(V[:, 2] > 0.8), np.flatnonzero(V[:, 2] < -0.8)
FIXED = np.concatenate([TOP, BOTTOM])
IDS, PLACE, DIRECTION = "not a mask; give numpy.flatnonzero", "A place must be", "A direction must be"


def mask(ids):
    return np.isin(np.arange(len(V)), ids)


def deform(fixed=FIXED, **options):
    return apd_viewer.deform(V, F, fixed, V[FIXED], iterations=1, **options)


def press(**options):
    return apd_viewer.press(V, F, **{"axis": (0, 0, 1), "to": 1.8, "steps": 1, "iterations": 2} | options)


def hull():
    return apd_viewer.volume_readings(V, F).hull


CASES = {
    "held vertices as a mask": (lambda: deform(mask(FIXED)), IDS),
    "handle as a mask": (lambda: deform(handle=mask(TOP)), IDS),
    "region as a mask": (lambda: deform(regions=[apd_viewer.Region("top", mask(TOP))]), IDS),
    "convergence as a dictionary": (
        lambda: deform(convergence={"most_iterations": 9}),
        "The convergence must be an apd_viewer.Convergence",
    ),
    "axis by its name": (lambda: press(axis="x"), DIRECTION),
    "distance in words": (lambda: press(to="wide"), "enter a smaller distance"),
    "start that is not a number": (lambda: press(start=V * np.nan), "Start positions must be"),
    "one obstacle, no list": (
        lambda: deform(contact=True, obstacles=apd_viewer.sphere((0, 0, 3), 1)),
        "Obstacles must be a list",
    ),
    "obstacles in words": (lambda: deform(contact=True, obstacles=["plate"]), "Obstacles must be a list"),
    "folder to write": (lambda: apd_viewer.save_mesh(apd_viewer.Mesh(V, F), V, "."), ". does not have"),
    "gas in words": (lambda: press(gas="1atm"), "gas must be"),
    "thickness in words": (lambda: apd_viewer.volume_readings(V, F, thickness="0.3mm"), "thickness must be"),
    "packing of nothing": (lambda: hull().bulk(0), "The packing must be a fraction"),
    "packing in percent": (lambda: hull().count_in(1000, packing=64), "The packing must be a fraction"),
    "centre in the plane": (lambda: apd_viewer.sphere((0, 0), 1), PLACE),
    "centre that is not a number": (lambda: apd_viewer.sphere((0, 0, np.nan), 1), PLACE),
    "end that is not a number": (lambda: apd_viewer.capsule((0, 0, np.nan), (0, 0, 1), 1), PLACE),
    "plate without a place": (lambda: apd_viewer.plate((0, np.inf, 0), (0, 0, 1), 1), PLACE),
    "plate without size": (lambda: apd_viewer.plate((0, 0, 0), (0, 0, 1), -1), "size must be"),
    "section without direction": (lambda: apd_viewer.plane_section(V, F, (0, 0, 0), (0, 0, 0)), DIRECTION),
    "section without place": (lambda: apd_viewer.plane_section(V, F, (0, np.nan, 0), (0, 0, 1)), PLACE),
    "point of no triangle": (
        lambda: apd_viewer.geodesic_path(V, F, 0, apd_viewer.SurfacePoint(len(F), (0.2, 0.3, 0.5))),
        f"There is no triangle {len(F)}",
    ),
    "point outside its triangle": (
        lambda: apd_viewer.geodesic_path(V, F, 0, apd_viewer.SurfacePoint(0, (0.5, 0.9, 0.5))),
        "The weights of a point",
    ),
    "point with two weights": (
        lambda: apd_viewer.geodesic_path(V, F, 0, apd_viewer.SurfacePoint(0, (0.5, 0.5))),
        "The weights of a point",
    ),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", CASES)
def test_input_error_says_in_a_sentence_what_cannot_be_used(name, compiled):
    call, said = CASES[name]
    with pytest.raises(InputError, match=re.escape(said)):
        call()


def test_plane_section_and_geodesic_path_take_lists(compiled):
    point, normal = (0.0, 0.0, 0.1), (0.0, 0.0, 1.0)
    cut, same = (
        apd_viewer.plane_section(*mesh, point, normal) for mesh in ((V.tolist(), F.tolist()), (V, F))
    )
    assert cut.length == same.length > 0.0
    path = apd_viewer.geodesic_path(V.tolist(), F.tolist(), 0, 100)
    np.testing.assert_array_equal(path, apd_viewer.geodesic_path(V, F, 0, 100))
