"""A selection that exists is one that fits together."""

from dataclasses import replace

import numpy as np
import pytest
from painted_meshes import N, painted

from apd_viewer.errors import InputError
from apd_viewer.files.selections.selection import LEAST_AREA, MOST_AREA, Selection
from apd_viewer.geometry.goals import target_values
from apd_viewer.geometry.pose.constraints import BASE, FREE


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"handles": ("Arm",)}, "handles has no name"),
        ({"handles": ()}, "handles has no name"),
        ({"handles": ("Arm", " ")}, "handles has no name"),
        ({"handles": ("Arm", "Arm")}, "handles have the same name"),
        ({"handles": ("Arm", "a\x1b[2J")}, "invalid characters"),
        ({"handles": ("Arm", "\ud800")}, "invalid characters"),
        ({"handles": tuple("abcdefghi")}, "9 handles, but the limit is 8"),
        ({"regions": ("Label",), "areas": (None,)}, "regions has no name"),
        ({"areas": (100.0,)}, "not a percentage from 1 to 1000"),
        ({"areas": (100.0, 0.0)}, "not a percentage"),
        ({"areas": (float("nan"), None)}, "not a percentage"),
        ({"areas": (True, None)}, "not a percentage"),
    ],
)
def test_selection_refuses_what_is_no_selection(change, words):
    with pytest.raises(InputError, match=words):
        replace(painted(), **change)


def test_selection_cannot_change():
    labels = np.full(N, FREE, dtype=np.uint8)
    selection = Selection.with_default_names(labels)
    labels[:] = BASE
    assert (selection.labels == FREE).all()
    with pytest.raises(ValueError, match="read-only"):
        selection.labels[0] = BASE
    assert Selection.with_default_names(selection.labels).labels is selection.labels
    assert (LEAST_AREA, MOST_AREA) == (target_values.LEAST_PERCENTAGE, target_values.MOST_PERCENTAGE)
