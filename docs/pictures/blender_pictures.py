"""Picture of the page on Blender: a character posed and the sample bottle twisted, by the add-on.

    build/night/blender/bin/python docs/pictures/blender_pictures.py .venv/bin/apd-viewer OUT.png

Blender's module renders it without a window.
"""

import math
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "resources" / "blender"))
from build import assembled_addon  # noqa: E402

# Joints of the character and their radii, and the bones between them.
JOINTS = {
    "hips": ((0.0, 0.0, 1.0), 0.26),
    "chest": ((0.0, 0.0, 1.62), 0.27),
    "neck": ((0.0, 0.0, 1.98), 0.13),
    "head": ((0.0, 0.0, 2.42), 0.27),
    **{
        f"{name}{side}": ((sign * x, 0.0, z), radius)
        for side, sign in (("L", 1.0), ("R", -1.0))
        for name, x, z, radius in (
            *(("shoulder", 0.42, 1.72, 0.14), ("elbow", 0.9, 1.72, 0.11), ("hand", 1.42, 1.72, 0.12)),
            *(("hip", 0.2, 0.85, 0.18), ("knee", 0.24, 0.45, 0.14), ("foot", 0.26, 0.05, 0.14)),
        )
    },
}
BONES = [("hips", "chest"), ("chest", "neck"), ("neck", "head")]
for SIDE in "LR":
    BONES += [
        ("chest", f"shoulder{SIDE}"),
        (f"shoulder{SIDE}", f"elbow{SIDE}"),
        (f"elbow{SIDE}", f"hand{SIDE}"),
    ]
    BONES += [("hips", f"hip{SIDE}"), (f"hip{SIDE}", f"knee{SIDE}"), (f"knee{SIDE}", f"foot{SIDE}")]


def character():
    """A figure around a skeleton of joints, as one mesh of its own."""
    names = list(JOINTS)
    mesh = bpy.data.meshes.new("figure")
    mesh.from_pydata(
        [JOINTS[name][0] for name in names], [[names.index(end) for end in bone] for bone in BONES], []
    )
    obj = linked("figure", mesh)
    obj.modifiers.new("skin", "SKIN")
    for point, name in zip(mesh.skin_vertices[0].data, names, strict=True):
        point.radius = (JOINTS[name][1], JOINTS[name][1])
    mesh.skin_vertices[0].data[0].use_root = True
    obj.modifiers.new("round", "SUBSURF").levels = 3
    obj.modifiers.new("even", "REMESH").voxel_size = 0.03
    smooth = obj.modifiers.new("smooth", "SMOOTH")
    smooth.iterations, smooth.factor = 6, 0.5
    whole = bpy.data.meshes.new_from_object(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(obj)
    V = np.array([v.co for v in whole.vertices])
    whole.vertices.foreach_set("co", (V - [0.0, 0.0, V[:, 2].min()]).astype(np.float32).ravel())
    return linked("figure", whole)


def linked(name, data):
    obj = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(obj)
    return obj


def held(obj, name, middle, radius):
    """Group of the vertices within a ball, with an empty there to move them."""
    V = np.array([v.co for v in obj.data.vertices])
    group(obj, name, np.linalg.norm(V - middle, axis=1) < radius)
    empty = linked(name, None)
    empty.location = middle
    handle = obj.apd.handles.add()
    handle.group, handle.target = name, empty
    bpy.context.view_layer.update()
    return empty


def group(obj, name, chosen):
    obj.vertex_groups.new(name=name).add(np.flatnonzero(chosen).tolist(), 1.0, "REPLACE")


def posed_character():
    obj = character()
    V = np.array([v.co for v in obj.data.vertices])
    group(obj, "feet", V[:, 2] < 0.12)
    obj.apd.base, obj.apd.contact = "feet", False
    hands = [held(obj, f"hand{side}", JOINTS[f"hand{side}"][0], 0.2) for side in "LR"]
    head = held(obj, "head", JOINTS["head"][0], 0.3)
    solver_keeps(
        obj,
        [
            (hands[0], (1.0, -0.35, 2.35), (0.0, math.radians(-60.0), 0.0)),
            (hands[1], (-0.75, -0.55, 1.15), (0.0, math.radians(-40.0), math.radians(30.0))),
            (head, (0.12, -0.15, 2.36), (math.radians(12.0), math.radians(14.0), 0.0)),
        ],
    )
    return obj


def twisted_bottle():
    bpy.ops.wm.obj_import(
        filepath=str(ROOT / "resources" / "bottle.obj"), forward_axis="NEGATIVE_Z", up_axis="Y"
    )
    obj = bpy.context.selected_objects[0]
    bpy.ops.object.transform_apply()
    V = np.array([v.co for v in obj.data.vertices])
    height = (V[:, 2] - V[:, 2].min()) / np.ptp(V[:, 2])
    group(obj, "foot", height < 0.06)
    group(obj, "neck", height > 0.93)
    obj.apd.base, obj.apd.contact = "foot", False
    cap = linked("cap", None)
    cap.location.z = float(V[:, 2].max())
    handle = obj.apd.handles.add()
    handle.group, handle.target = "neck", cap
    solver_keeps(obj, [(cap, (0.0, 0.0, cap.location.z - 0.3), (0.0, 0.0, math.radians(75.0)))])
    scale = 2.6 / float(np.ptp(V[:, 2]))
    obj.scale = (scale, scale, scale)
    return obj


def solver_keeps(obj, moves):
    """Deform an object by its empties as they are after the moves, some at a time as a drag does."""
    from apd_live.operators import SESSION

    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    live = SESSION.started(bpy.context)
    begins = [(np.array(empty.location), np.array(empty.rotation_euler)) for empty, _, _ in moves]
    for part in np.linspace(0.05, 1.0, 20):
        for (empty, place, turn), (place_before, turn_before) in zip(moves, begins, strict=True):
            empty.location = place_before + part * (np.array(place) - place_before)
            empty.rotation_euler = turn_before + part * (np.array(turn) - turn_before)
        bpy.context.view_layer.update()
        live.settle()
    print(f"{obj.name}: {len(obj.data.vertices):,} vertices, area {1.0 + live.readings['area_error']:.9f}")
    live.keep()
    SESSION.live = None


def painted(obj, color):
    material = bpy.data.materials.new(obj.name)
    if not material.use_nodes:  # as materials of newer versions are made
        material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = 0.45
    obj.data.materials.clear()
    obj.data.materials.append(material)
    for polygon in obj.data.polygons:
        polygon.use_smooth = True


def copied_at_rest(obj, x):
    """The undeformed shape beside."""
    rest = linked(f"{obj.name} at rest", obj.data.copy())
    rest.shape_key_clear()
    rest.scale = obj.scale
    rest.location.x = x
    return rest


def render(path):
    scene = bpy.context.scene
    world = bpy.data.worlds.new("sky")
    if not world.use_nodes:
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.85, 0.88, 0.92, 1.0)
    world.node_tree.nodes["Background"].inputs[1].default_value = 0.6
    scene.world = world
    floor = bpy.data.meshes.new("floor")
    floor.from_pydata([(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], [], [(0, 1, 2, 3)])
    painted(linked("floor", floor), (0.62, 0.64, 0.66))
    lamp = linked("sun", bpy.data.lights.new("sun", "SUN"))
    lamp.data.energy, lamp.data.angle = 2.2, 0.15
    lamp.rotation_euler = (math.radians(50), math.radians(8), math.radians(-35))
    camera = linked("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (-0.3, -15.0, 3.2), (math.radians(83.0), 0.0, 0.0)
    camera.data.lens = 51
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 48
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 1280, 480
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main(program, path):
    with tempfile.TemporaryDirectory() as folder:
        sys.path.insert(0, str(assembled_addon(folder).parent))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        import apd_live

        apd_live.register()
        apd_live.operators.solver_command = lambda _: [program, "serve"]
        figure, bottle = posed_character(), twisted_bottle()
        apd_live.unregister()
    for obj, color, x, apart in (
        (figure, (0.80, 0.42, 0.16), -0.75, 2.95),
        (bottle, (0.12, 0.42, 0.62), 3.2, 1.7),
    ):
        painted(copied_at_rest(obj, x - apart), (0.62, 0.62, 0.62))
        painted(obj, color)
        obj.location.x = x
    render(Path(path).resolve())


if __name__ == "__main__":
    main(*sys.argv[1:])
