# SPDX-License-Identifier: GPL-3.0-or-later
"""What is chosen in the sidebar, kept with the object, and the preferences."""

import bpy

METHODS = (
    ("exact", "Exact", "As rigid as possible, the total area preserved to the last digits"),
    ("local", "Local", "The area of every triangle preserved, as of fabric"),
    ("wall", "Wall", "A thin elastic wall, as of a bottle or of paper"),
    ("arap", "As rigid as possible", "The area is free"),
)


class ApdHandle(bpy.types.PropertyGroup):
    """A vertex group, and the object or bone that moves it."""

    group: bpy.props.StringProperty(name="Vertex group", description="Vertices that the handle holds")
    target: bpy.props.PointerProperty(
        type=bpy.types.Object, name="Moved by", description="Empty or armature that moves the vertices"
    )
    bone: bpy.props.StringProperty(name="Bone", description="Bone of the armature that moves the vertices")


class ApdObject(bpy.types.PropertyGroup):
    """Base, handles and settings of an object."""

    base: bpy.props.StringProperty(name="Base", description="Vertex group that stays where it is")
    handles: bpy.props.CollectionProperty(type=ApdHandle)
    method: bpy.props.EnumProperty(name="Method", items=METHODS, default="exact")
    contact: bpy.props.BoolProperty(
        name="Contact", default=True, description="The surface does not pass through itself"
    )
    wall_thickness: bpy.props.FloatProperty(
        name="Wall thickness", min=0.0, unit="LENGTH", precision=5,
        description="Of the method Wall, as seen in the scene; 0 for 1/1000 of the size of the mesh",
    )  # fmt: skip

    def solver_settings(self):
        """Settings of the solver, by name."""
        settings = {"method": self.method, "contact": self.contact}
        if self.method == "wall" and self.wall_thickness > 0.0:
            settings["wall_thickness"] = self.wall_thickness
        return settings


class ApdPreferences(bpy.types.AddonPreferences):
    """Where the program is."""

    bl_idname = __package__
    program: bpy.props.StringProperty(
        name="apd-viewer", subtype="FILE_PATH",
        description="The program; empty to find it by itself",
    )  # fmt: skip

    def draw(self, _):
        """Draw the path and a button that tries it."""
        self.layout.prop(self, "program")
        self.layout.operator("apd.prepare")


CLASSES = (ApdHandle, ApdObject, ApdPreferences)
