# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of a range of frames, as keyed shape keys or as a point cache.

A bake replaces an earlier one of the same object, which is hidden meanwhile. Nothing of the object is changed
before all shapes are there.
"""

import re
import struct
from contextlib import contextmanager
from pathlib import Path

import bpy
import numpy as np

from . import object_arrays
from .solver_process import SolverError

_HEADER = struct.Struct(
    "<12siiffi"
)  # POINTCACHE2: sign, version, points, first frame, frames a sample, samples


def frames_of(scene, step):
    """Every so many frames of the scene's range, from the first one to its end or beyond."""
    return range(scene.frame_start, scene.frame_end + step, step)


@contextmanager
def earlier_bake_hidden(obj):
    """Hide the shape keys and the modifier of an earlier bake, and show again those that are left."""
    hidden = [(obj.data.shape_keys.key_blocks, key.name, "mute", key.mute) for key in _baked_keys(obj)]
    if modifier := _own_modifier(obj):
        hidden.append((obj.modifiers, modifier.name, "show_viewport", modifier.show_viewport))
    for owner, name, switch, _ in hidden:
        setattr(owner[name], switch, switch == "mute")
    try:
        yield
    except BaseException:
        for owner, name, switch, before in hidden:
            setattr(owner[name], switch, before)
        raise


def shapes_of_frames(live, obj, frames):
    """Yield a shape (n, 3) for each frame of the scene, settled."""
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        object_arrays.check_object(obj)  # other shape keys and modifiers may be animated
        live.settle()
        yield live.shown_positions()


def bake_shape_keys(obj, frames, shapes):
    """Write each shape into a shape key of its own, keyed to be the only one at its frame."""
    _remove_baked_keys(obj)
    for frame, V in zip(frames, shapes, strict=True):
        each = object_arrays.shape_key(obj, f"{object_arrays.KEY} {frame}")
        object_arrays.write_key(obj, each, V)
        for place in (frame - frames.step, frame, frame + frames.step):
            if place in frames:  # the first and the last shape stay before and after them
                each.value = float(place == frame)
                each.keyframe_insert("value", frame=place)
    # Shapes pass over into each other evenly, so that the values sum to 1 between frames.
    for _, curve in _baked_curves(obj.data.shape_keys):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def bake_point_cache(obj, path, frames, shapes):
    """Write the shapes into a PC2 file, and play it by a modifier."""
    file, count = Path(bpy.path.abspath(path)), len(obj.data.vertices)
    scratch = file.with_name(f"{file.name}.part")
    try:
        try:
            with scratch.open("wb") as sink:
                start, step = float(frames.start), float(frames.step)
                sink.write(_HEADER.pack(b"POINTCACHE2\0", 1, count, start, step, len(frames)))
                for V in shapes:
                    sink.write(np.ascontiguousarray(V, "<f4").tobytes())
            scratch.replace(file)
        finally:
            scratch.unlink(missing_ok=True)
    except OSError as error:
        raise SolverError(f"{file} cannot be written: {error.strerror or error}.") from error
    modifier = _own_modifier(obj) or obj.modifiers.new(object_arrays.KEY, "MESH_CACHE")
    # It replaces the vertices of the mesh, so that it comes before all that makes others.
    obj.modifiers.move(obj.modifiers.find(modifier.name), 0)
    modifier.cache_format, modifier.filepath, modifier.show_viewport = "PC2", path, True
    # Blender subtracts the start from frames that are scaled already.
    modifier.frame_start, modifier.frame_scale = frames.start / frames.step, 1.0 / frames.step


def hide_kept_shape(obj):
    """Hide the shape of an earlier live deformation, which would be added to those that were baked."""
    keys = obj.data.shape_keys
    if keys and (key := keys.key_blocks.get(object_arrays.KEY)):
        key.value = 0.0


def _own_modifier(obj):
    found = obj.modifiers.get(object_arrays.KEY)
    return found if found is not None and found.type == "MESH_CACHE" else None


def _baked_keys(obj):
    keys = obj.data.shape_keys.key_blocks if obj.data.shape_keys else ()
    return [key for key in keys if re.fullmatch(rf"{object_arrays.KEY} -?\d+", key.name)]


def _baked_curves(keys):
    """Animation curves of the baked keys with what holds them, in the slot of the shape keys alone."""
    animation = keys.animation_data
    if animation is None or animation.action is None:
        return []
    name = re.compile(rf'key_blocks\["{object_arrays.KEY} -?\d+"\]\.value')
    return [
        (bag, curve)
        for layer in animation.action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        if bag.slot_handle == animation.action_slot_handle
        for curve in bag.fcurves
        if name.fullmatch(curve.data_path)
    ]


def _remove_baked_keys(obj):
    """Remove the shape keys of an earlier bake, and their animation."""
    baked = _baked_keys(obj)
    if baked:
        for bag, curve in _baked_curves(obj.data.shape_keys):
            bag.fcurves.remove(curve)
    for key in baked:
        obj.shape_key_remove(key)
