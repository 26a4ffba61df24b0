# SPDX-License-Identifier: GPL-3.0-or-later
"""Deform meshes by handles in Blender while the surface area is kept, with apd-viewer as the solver."""

import bpy
from bpy.app.handlers import persistent

from . import operators, panel, properties
from .operators import SESSION

_CLASSES = (*properties.CLASSES, *operators.CLASSES, *panel.CLASSES)


@persistent
def _forget(*_):
    """Let go of what is live before another file is loaded: its objects are gone then."""
    SESSION.live = None


def register():
    """Register the classes, and the choices of each object."""
    for each in _CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Object.apd = bpy.props.PointerProperty(type=properties.ApdObject)
    bpy.app.handlers.load_pre.append(_forget)


def unregister():
    """End the solver, and take all back."""
    SESSION.close()
    bpy.app.handlers.load_pre.remove(_forget)
    del bpy.types.Object.apd
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
