"""A selection that exists is one that fits together."""

from dataclasses import replace

import numpy as np
import pytest
from painted_meshes import N, painted

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import LEAST_AREA, MOST_AREA, Selection
from apd_viewer.geometry.pose.constraints import BASE, FREE
from apd_viewer.geometry.solver import goals


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"handles": ("Arm",)}, "a handle without a name"),
        ({"handles": ()}, "a handle without a name"),
        ({"handles": ("Arm", " ")}, "a handle without a name"),
        ({"handles": ("Arm", "Arm")}, "two handles of one name"),
        ({"handles": ("Arm", "a\x1b[2J")}, "signs that are no text"),
        ({"handles": ("Arm", "\ud800")}, "signs that are no text"),
        ({"handles": tuple("abcdefghi")}, "9 handles, but there can be 8"),
        ({"regions": ("Label",), "areas": (None,)}, "a region without a name"),
        ({"areas": (100.0,)}, "no percentage from 1 to 1000"),
        ({"areas": (100.0, 0.0)}, "no percentage"),
        ({"areas": (float("nan"), None)}, "no percentage"),
        ({"areas": (True, None)}, "no percentage"),
    ],
)
def test_what_is_no_selection(change, words):
    with pytest.raises(InputError, match=words):
        replace(painted(), **change)


def test_a_selection_cannot_change():
    labels = np.full(N, FREE, dtype=np.uint8)
    selection = Selection.of(labels)
    labels[:] = BASE
    assert (selection.labels == FREE).all()
    with pytest.raises(ValueError, match="read-only"):
        selection.labels[0] = BASE
    assert Selection.of(selection.labels).labels is selection.labels
    assert (LEAST_AREA, MOST_AREA) == (goals._LEAST, goals._MOST)
