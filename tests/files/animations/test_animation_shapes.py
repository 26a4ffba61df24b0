"""Shapes on disk: few of many, evenly, and the latest always."""

import weakref

import numpy as np
import pytest
from animated import animated
from meshes import sphere

from apd_viewer.files.animations.animation_files import ANIMATION_FORMATS, USD_FORMATS, write_animation
from apd_viewer.files.animations.animation_shapes import ShapeRecorder
from apd_viewer.geometry.mesh.mesh import Mesh


@pytest.mark.parametrize(
    "ending",
    [pytest.param(each, marks=[pytest.mark.extra] * (each in USD_FORMATS)) for each in ANIMATION_FORMATS],
)
def test_write_animation_has_one_or_two_shapes_in_memory_at_a_time(ending, tmp_path, monkeypatch):
    animation, _ = animated(Mesh(*sphere(1)), tmp_path / "shapes", 12)
    alive, most, load = weakref.WeakSet(), [], np.load

    class Shape(np.ndarray):
        """An array that can be in a set."""

        __hash__ = object.__hash__
        __eq__ = object.__eq__

    def counted(path):
        shape = load(path).view(Shape)
        alive.add(shape)
        most.append(len(alive))
        return shape

    monkeypatch.setattr(np, "load", counted)
    write_animation(animation, tmp_path / f"a{ending}")
    assert len(most) >= 12
    assert max(most) <= 2


@pytest.mark.parametrize("count", range(1, 60))
def test_shape_recorder_keeps_shapes_even_and_bounded_that_end_with_the_latest(count, tmp_path):
    recorder = ShapeRecorder(tmp_path, 8)
    for k in range(count):
        recorder.add(np.full((2, 3), float(k)))
    numbers = [int(number) for number in recorder.numbers]
    assert numbers[0] == 0
    assert numbers[-1] == count - 1
    steps = np.diff(numbers)
    assert len(set(steps[:-1].tolist())) <= 1, "all but the last are as far apart"
    assert count <= 8 or 4 <= len(numbers) <= 8
    assert sorted(tmp_path.iterdir()) == sorted(recorder.files)
    for number, path in zip(numbers, recorder.files, strict=True):
        assert np.load(path)[0, 0] == number
