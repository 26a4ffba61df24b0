# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of a range of frames, as keyed shape keys or as a point cache."""

import struct
from pathlib import Path

import bpy
import numpy as np

from . import object_arrays
from .solver_process import SolverError

_HEADER = struct.Struct(
    "<12siiffi"
)  # POINTCACHE2: sign, version, points, first frame, frames a sample, samples


def shapes_of_frames(live, frames):
    """Yield a shape (n, 3) for each frame of the scene, settled; the frame is the scene's then."""
    scene, before = bpy.context.scene, bpy.context.scene.frame_current
    try:
        for frame in frames:
            scene.frame_set(frame)
            live.settle()
            yield live.shown_positions()
    finally:
        scene.frame_set(before)


def bake_shape_keys(obj, frames, shapes):
    """Write each shape into a shape key of its own, keyed to be the only one at its frame."""
    key = object_arrays.shape_key(obj)
    key.value = 0.0
    for frame, V in zip(frames, shapes, strict=True):
        each = object_arrays.shape_key(obj, f"{object_arrays.KEY} {frame}")
        object_arrays.write_key(obj, each, V)
        step = frames.step
        for place, value in ((frame - step, 0.0), (frame, 1.0), (frame + step, 0.0)):
            each.value = value
            each.keyframe_insert("value", frame=place)
    _set_linear(obj.data.shape_keys)


def _set_linear(keys):
    """Let shapes pass over into each other evenly, so that the values sum to 1 between frames."""
    action = keys.animation_data.action
    for curve in (
        curve
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        for curve in bag.fcurves
    ):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def bake_point_cache(obj, path, frames, shapes):
    """Write the shapes into a PC2 file, and play it by a modifier."""
    file = Path(bpy.path.abspath(path))
    count = len(obj.data.vertices)
    try:
        with file.open("wb") as sink:
            sink.write(_HEADER.pack(b"POINTCACHE2\0", 1, count, 0.0, 1.0, len(frames)))
            for V in shapes:
                sink.write(np.ascontiguousarray(V, "<f4").tobytes())
    except OSError as error:
        raise SolverError(f"{file} cannot be written: {error.strerror or error}.") from error
    object_arrays.shape_key(obj).value = 0.0
    modifier = obj.modifiers.new(object_arrays.KEY, "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", path
    modifier.frame_start, modifier.frame_scale = frames.start, 1.0 / frames.step
