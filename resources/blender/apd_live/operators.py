# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: start a live deformation, bake, handles, and the test of the program."""

from contextlib import suppress

import bpy

from . import baking
from .live_deformation import LiveDeformation
from .solver_process import SolverError, SolverProcess, solver_command

# Above the rate of displays: a shape waits for a tick, and then the solver for the next place of the handle.
TICKS_A_SECOND = 240


class Session:
    """The solver's process, and what is live at present, of which there is one."""

    def __init__(self):
        self.solver = None
        self.live = None

    def running_solver(self, context):
        """The process, started and greeted if there is none."""
        if self.solver is None or not self.solver.is_alive:
            self.close()
            addon = context.preferences.addons.get(__package__)
            self.solver = SolverProcess(
                solver_command(bpy.path.abspath(addon.preferences.program) if addon else "")
            )
            try:
                self.solver.greet()
            except SolverError:
                self.close()
                raise
        return self.solver

    def started(self, context):
        """Live deformation of the active object."""
        obj = context.object
        choices = obj.apd
        handles = [(each.group, each.target, each.bone) for each in choices.handles]
        solver = self.running_solver(context)
        self.live = LiveDeformation(solver, obj, choices.base, handles, choices.solver_settings())
        return self.live

    def close(self):
        """End the process."""
        self.live = None
        if self.solver is not None:
            self.solver.close()
            self.solver = None


SESSION = Session()


def _is_mesh(context):
    return context.object is not None and context.object.type == "MESH"


class APD_OT_live(bpy.types.Operator):
    """Deform the mesh while its handles are moved; Enter keeps the shape, Esc undoes it"""

    bl_idname, bl_label, bl_options = "apd.live", "Deform live", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return _is_mesh(context) and SESSION.live is None

    def invoke(self, context, _):
        try:
            SESSION.started(context)
        except SolverError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._timer = context.window_manager.event_timer_add(1 / TICKS_A_SECOND, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        live = SESSION.live
        if live is None:  # another file was loaded
            return self._ended(context, {"CANCELLED"})
        try:
            if event.type in {"RET", "NUMPAD_ENTER"} and event.value == "PRESS":
                live.keep()
                return self._ended(context, {"FINISHED"})
            if event.type == "ESC" and event.value == "PRESS":
                live.undo()
                return self._ended(context, {"CANCELLED"})
            before = live.status
            if event.type == "TIMER" and (live.tick() or live.status != before):
                for area in context.screen.areas:
                    if area.type == "VIEW_3D":
                        area.tag_redraw()
        except SolverError as error:
            self.report({"ERROR"}, str(error))
            return self._ended(context, {"FINISHED"})
        return {"PASS_THROUGH"}  # so that G, R and S move the handle

    def execute(self, context):
        """Deform once, waiting for the shape: for scripts, and without a window."""
        try:
            SESSION.started(context).settle()
            SESSION.live.keep()
        except SolverError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            SESSION.live = None
        return {"FINISHED"}

    def _ended(self, context, outcome):
        SESSION.live = None
        context.window_manager.event_timer_remove(self._timer)
        return outcome


class APD_OT_bake(bpy.types.Operator):
    """Deform the mesh at each frame of the scene, as its handles are animated"""

    bl_idname, bl_label, bl_options = "apd.bake", "Bake", {"REGISTER", "UNDO"}
    form: bpy.props.EnumProperty(
        name="Into",
        items=(
            ("KEYS", "Shape keys", "Shape keys in this file, one a frame"),
            ("CACHE", "Point cache", "A PC2 file, played by a modifier"),
        ),
    )
    path: bpy.props.StringProperty(name="File", subtype="FILE_PATH", default="//apd.pc2")
    step: bpy.props.IntProperty(name="Every … frames", default=1, min=1)

    @classmethod
    def poll(cls, context):
        return _is_mesh(context) and SESSION.live is None

    def invoke(self, context, _):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        scene, manager, obj = context.scene, context.window_manager, context.object
        frames, before, live = baking.frames_of(scene, self.step), scene.frame_current, None
        try:
            with baking.earlier_bake_hidden(obj):
                scene.frame_set(frames.start)
                live = SESSION.started(context)
                manager.progress_begin(0, len(frames))
                shapes = self._counted(manager, baking.shapes_of_frames(live, obj, frames))
                if self.form == "KEYS":
                    baking.bake_shape_keys(obj, frames, list(shapes))
                else:
                    baking.bake_point_cache(obj, self.path, frames, shapes)
        except SolverError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            manager.progress_end()
            if live is not None:
                with suppress(SolverError):  # that the solver has ended
                    live.undo()
            scene.frame_set(before)
            SESSION.live = None
        baking.hide_kept_shape(obj)
        return {"FINISHED"}

    @staticmethod
    def _counted(manager, shapes):
        for number, shape in enumerate(shapes):
            manager.progress_update(number)
            yield shape


class APD_OT_prepare(bpy.types.Operator):
    """Start the program and compare the versions"""

    bl_idname, bl_label = "apd.prepare", "Try the program"

    def execute(self, context):
        try:
            SESSION.close()
            version = SESSION.running_solver(context).version
        except SolverError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"apd-viewer {version}")
        return {"FINISHED"}


class APD_OT_add_handle(bpy.types.Operator):
    """Add a handle; with a vertex group active, an empty is put at its middle"""

    bl_idname, bl_label, bl_options = "apd.add_handle", "Add handle", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return _is_mesh(context)

    def execute(self, context):
        obj = context.object
        handle = obj.apd.handles.add()
        group = obj.vertex_groups.active
        taken = {obj.apd.base, *(each.group for each in obj.apd.handles)}
        if group is not None and group.name not in taken:
            handle.group = group.name
            ids = [v.index for v in obj.data.vertices if any(g.group == group.index for g in v.groups)]
            if ids:
                places = [obj.matrix_world @ obj.data.vertices[each].co for each in ids]
                empty = bpy.data.objects.new(group.name, None)
                empty.location = sum(places, places[0] * 0.0) / len(places)
                empty.empty_display_size = 0.25 * max(obj.dimensions)
                context.collection.objects.link(empty)
                handle.target = empty
        return {"FINISHED"}


class APD_OT_remove_handle(bpy.types.Operator):
    """Remove the handle from the list"""

    bl_idname, bl_label, bl_options = "apd.remove_handle", "Remove handle", {"REGISTER", "UNDO"}
    index: bpy.props.IntProperty()

    def execute(self, context):
        context.object.apd.handles.remove(self.index)
        return {"FINISHED"}


CLASSES = (APD_OT_live, APD_OT_bake, APD_OT_prepare, APD_OT_add_handle, APD_OT_remove_handle)
