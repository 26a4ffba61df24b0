# SPDX-License-Identifier: GPL-3.0-or-later
"""Panel in the sidebar of the 3D view."""

import bpy

from .operators import SESSION


class APD_PT_live(bpy.types.Panel):
    """Base, handles, method, and how far the area is kept."""

    bl_label, bl_idname = "APD Live", "APD_PT_live"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "APD"

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def draw(self, context):
        obj, layout, live = context.object, self.layout, SESSION.live
        layout.use_property_split = True
        choices = layout.column()
        choices.enabled = live is None
        choices.prop_search(obj.apd, "base", obj, "vertex_groups")
        for number, handle in enumerate(obj.apd.handles):
            box = choices.box()
            row = box.row(align=True)
            row.prop_search(handle, "group", obj, "vertex_groups", text=f"Handle {number + 1}")
            row.operator("apd.remove_handle", text="", icon="X").index = number
            box.prop(handle, "target")
            if handle.target is not None and handle.target.type == "ARMATURE":
                box.prop_search(handle, "bone", handle.target.data, "bones")
        choices.operator("apd.add_handle", icon="ADD")
        choices.prop(obj.apd, "method")
        choices.prop(obj.apd, "contact")
        if obj.apd.method == "wall":
            choices.prop(obj.apd, "wall_thickness")
        if live is None:
            layout.operator("apd.live", icon="PLAY")
            layout.operator("apd.bake", icon="RENDER_ANIMATION")
            return
        lines = layout.box().column(align=True)
        lines.label(text=live.status)
        if live.readings:
            lines.label(text=f"Area {100.0 * (1.0 + live.readings['area_error']):.6f} %")
        for sentence in live.warnings:
            lines.label(text=sentence, icon="ERROR")
        lines.label(text="Enter keeps the shape, Esc undoes it")


CLASSES = (APD_PT_live,)
