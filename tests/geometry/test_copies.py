"""Copies and pickles of public objects: the same bits, or a sentence."""

import copy
import dataclasses
import pickle

import numpy as np
import pytest
from meshes import sphere

import apd_viewer
from apd_viewer.errors import InputError

V, F = sphere(1)
TOP, BOTTOM = np.flatnonzero(V[:, 2] > 0.8), np.flatnonzero(V[:, 2] < -0.8)
FIXED = np.concatenate([TOP, BOTTOM])
WAYS = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
}
THINGS = {
    "mesh": lambda: apd_viewer.Mesh(V, F),
    "result": lambda: apd_viewer.deform(V, F, FIXED, V[FIXED] * 1.1, handle=TOP, contact=False),
    "frame": lambda: apd_viewer.Deformation(V, F, FIXED, handle=TOP).step(),
    "pressed": lambda: apd_viewer.press(V, F, (0, 0, 1), 1.9, 1, iterations=3),
    "volumes": lambda: apd_viewer.volume_readings(V, F),
    "section": lambda: apd_viewer.plane_section(V, F, (0, 0, 0.1), (0, 0, 1)),
    "obstacle": lambda: apd_viewer.capsule((0, 0, 3), (0, 1, 3), 1.0),
    "region": lambda: apd_viewer.Region("top", TOP, 100),
    "convergence": lambda: apd_viewer.Convergence(most_iterations=7),
    "point": lambda: apd_viewer.SurfacePoint(0, (0.2, 0.3, 0.5)),
}


def bits(thing):
    """All that a public object holds, as nested tuples of bytes and plain values."""
    if isinstance(thing, np.ndarray):
        return thing.dtype.str, thing.shape, thing.tobytes()
    if dataclasses.is_dataclass(thing):
        return tuple(bits(getattr(thing, field.name)) for field in dataclasses.fields(thing))
    return tuple(map(bits, thing)) if isinstance(thing, tuple | list) else repr(thing)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", THINGS)
def test_copies_of_public_objects_have_the_same_bits(name, way, compiled):
    thing = THINGS[name]()
    assert bits(WAYS[way](thing)) == bits(thing)


@pytest.mark.parametrize("way", WAYS)
def test_mesh_copies_have_read_only_arrays(way):
    again = WAYS[way](apd_viewer.Mesh(V, F))
    assert not again.V.flags.writeable
    assert not again.F.flags.writeable


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("options", [{}, {"method": "paper"}, {"contact": True}])
def test_deformation_says_that_it_cannot_be_copied(options, way, compiled):
    solver = apd_viewer.Deformation(V, F, FIXED, handle=TOP, **options)
    frame = solver.step()
    with pytest.raises(InputError, match="cannot be copied or pickled; make another one"):
        WAYS[way](solver)
    # The way that the sentence names.
    again = apd_viewer.Deformation(V, F, FIXED, handle=TOP, **options)
    again.aim(V[FIXED], U=frame.U)
    np.testing.assert_allclose(again.step().U, V, atol=1e-6)
