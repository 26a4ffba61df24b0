# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays of an object's mesh, as the solver needs them, and what cannot be deformed."""

import bpy
import numpy as np

from .solver_process import SolverError

KEY = "APD"  # name of the shape key
# Modifiers that move vertices: the shape would be deformed twice.
DEFORMING = {
    *("ARMATURE", "CAST", "CLOTH", "CORRECTIVE_SMOOTH", "CURVE", "DISPLACE", "HOOK", "LAPLACIANDEFORM"),
    *("LAPLACIANSMOOTH", "LATTICE", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "SHRINKWRAP"),
    *("SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "SURFACE_DEFORM", "WARP", "WAVE"),
}
_IN_GROUP = 0.5  # least weight
_LEAST_SCALE = 1e-6  # of the largest


def check_object(obj):
    """Raise SolverError with a sentence for an object that cannot be deformed."""
    if obj is None or obj.type != "MESH":
        raise SolverError("Select a mesh.")
    if obj.mode != "OBJECT":
        raise SolverError("Leave edit mode first: Tab.")
    if not obj.data.is_editable:
        raise SolverError("The mesh is linked from another file; make it local first.")
    if obj.data.shape_keys and not obj.data.shape_keys.use_relative:
        raise SolverError("The shape keys are absolute, of which one is shown; make them relative first.")
    for modifier in obj.modifiers:
        if modifier.type in DEFORMING and modifier.show_viewport:
            raise SolverError(f"Turn the modifier “{modifier.name}” off: it deforms the mesh, too.")
    if obj.data.shape_keys and (mixed := [key.name for key in _other_keys(obj.data.shape_keys)]):
        raise SolverError(f"Set the shape key “{mixed[0]}” to 0, or mute it: it deforms the mesh, too.")
    scales = np.linalg.svd(np.array(obj.matrix_world)[:3, :3], compute_uv=False)
    if scales[-1] <= _LEAST_SCALE * scales[0]:
        raise SolverError("The scale of the object is 0 in one direction; set another one.")


def _other_keys(keys):
    shown = [key for key in keys.key_blocks if key not in (keys.reference_key, keys.key_blocks.get(KEY))]
    return [key for key in shown if key.value != 0.0 and not key.mute]


def rest_positions(mesh):
    """Positions (n, 3) float32 of the basis, or of the mesh without shape keys."""
    if mesh.shape_keys:
        V = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.shape_keys.reference_key.points.foreach_get("co", V)
        return V.reshape(-1, 3)
    return positions(mesh)


def positions(mesh):
    """Positions (n, 3) float32 of a mesh as it is."""
    V = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", V)
    return V.reshape(-1, 3)


def triangles(mesh):
    """Triangles (m, 3) int32 of the faces; quads and larger ones are split."""
    mesh.calc_loop_triangles()
    F = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", F)
    return F.reshape(-1, 3)


def group_vertices(obj, name):
    """Vertices with at least half a weight in a group; raises SolverError if there are none."""
    group = obj.vertex_groups.get(name)
    if group is None:
        raise SolverError(f"There is no vertex group “{name}”." if name else "Choose a vertex group.")
    index = group.index
    found = [
        vertex.index
        for vertex in obj.data.vertices
        for each in vertex.groups
        if each.group == index and each.weight >= _IN_GROUP
    ]
    if not found:
        raise SolverError(f"The vertex group “{name}” is empty; assign vertices to it in edit mode.")
    return np.array(found, np.int64)


def shape_key(obj, name=KEY):
    """Shape key of an object by name, made if it is missing."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)
    key = obj.data.shape_keys.key_blocks.get(name)
    return obj.shape_key_add(name=name, from_mix=False) if key is None else key


def write_key(obj, key, V):
    """Write positions (n, 3) into a shape key."""
    key.points.foreach_set("co", np.ascontiguousarray(V, np.float32).ravel())
    obj.data.update()


def world_matrix(obj, bone=""):
    """World matrix (4, 4) of an object or of a bone of it, as posed now."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    if bone:
        return np.array(evaluated.matrix_world @ evaluated.pose.bones[bone].matrix)
    return np.array(evaluated.matrix_world)
