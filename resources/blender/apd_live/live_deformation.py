# SPDX-License-Identifier: GPL-3.0-or-later
"""Live deformation of an object by the objects or bones that are its handles."""

import time

import bpy
import numpy as np

from . import object_arrays
from .solver_process import SolverError, opening_arrays

# Seconds between places that are sent before the shape of an earlier one has come: each message takes time
# from the solver, and of several only the newest is used.
_LEAST_WAIT = 1 / 60
_SHOWN = {"value": 1.0, "mute": False}  # switches of a shape key that is in sight


class LiveDeformation:
    """Deformation of one object, from its opening until it is kept or undone.

    It knows nothing of windows and timers: something calls :meth:`tick` some thirty times a second, or
    :meth:`settle` to wait. Objects are kept by name, since undo and loading a file replace them.

    Parameters
    ----------
    solver : SolverProcess
    obj : bpy.types.Object
    base : str
        Vertex group that stays; "" for none.
    handles : sequence of (str, bpy.types.Object, str)
        Vertex group, the object that moves it, and the name of its bone or "".
    settings : dict
        Of the solver: method, contact, ...

    Attributes
    ----------
    status : str
        What it does at present, for the panel.
    readings : dict
        Of the last shape: ``area_error``, ``settled``, ...; empty before the first.
    is_settled : bool
        True if the last shape is that of the handles as they are now.
    warnings : list of str
        Of the mesh, once it is open.
    motion : int
        Number of the last motion that was sent, as in the readings of its shapes.

    Raises
    ------
    SolverError
        With a sentence, also from all methods.
    """

    def __init__(self, solver, obj, base, handles, settings):
        object_arrays.check_object(obj)
        if not handles:
            raise SolverError("Add a handle: a vertex group, and an empty that moves it.")
        for group, target, bone in handles:
            if target is None:
                raise SolverError(f"Choose the object that moves “{group}”.")
            if target == obj:
                raise SolverError(f"“{group}” is moved by the mesh itself; choose an empty or a bone.")
            if bone and (target.pose is None or bone not in target.pose.bones):
                raise SolverError(f"There is no bone “{bone}”.")
        held = [object_arrays.group_vertices(obj, base)] if base else [np.empty(0, np.int64)]
        held += [object_arrays.group_vertices(obj, group) for group, _, _ in handles]
        if len(np.unique(np.concatenate(held))) < sum(map(len, held)):
            raise SolverError("A vertex is in two of the groups; remove it from one.")
        self._solver, self._name = solver, obj.name
        self._targets = [(target.name, bone) for _, target, bone in handles]
        self._held = held
        self._rest = object_arrays.rest_positions(obj.data)
        self._world = world = object_arrays.world_matrix(obj)
        # In the directions and the scale of the world, so that the area is the one seen, and about the
        # object's origin, where numbers are small.
        self._turn, self._origin = world[:3, :3], world[:3, 3]
        self._back = np.linalg.inv(self._turn)
        self._places = self._rest.astype(np.float64) @ self._turn.T
        self._from_start = np.linalg.inv(self._matrices()[1:])
        had_key = obj.data.shape_keys is not None and object_arrays.KEY in obj.data.shape_keys.key_blocks
        self._kept = self._key_positions(obj) if had_key else None
        self._switches = [getattr(self._key(obj), each) for each in _SHOWN] if had_key else []
        self._sent, self._sent_at, self.motion = None, 0.0, 0
        self._is_asked = self.is_settled = False
        self.readings, self.warnings = {}, []
        self.status, self._is_open = "Opening", False
        F = object_arrays.triangles(obj.data)
        # Answers to earlier messages are about another mesh.
        self._first = solver.send(
            "open", opening_arrays(self._places, F, held[0], held[1:]), settings=settings, dtype="<f4"
        )

    def tick(self):
        """Send how the handles stand if they have moved, and show the newest shape; True if one came."""
        frame = None
        for answer in self._solver.taken_answers(self._first):
            head = answer.head
            if head["op"] == "error":
                raise SolverError(head["message"])
            if head["op"] == "progress":
                doing = "Opening" if head["stage"] == "opening" else "Working"
                self.status = f"{doing}; {head['compiled']:.0%} of the solver is compiled"
            elif head["op"] == "open":
                self._is_open, self.warnings = True, head["warnings"]
            elif head["op"] == "frame":
                self._is_asked, frame = False, answer
                self.is_settled = head["finished"] and head["motion"] == self.motion
        if self._is_open:
            # While a shape is awaited, an earlier place would be replaced before it is used.
            if not self._is_asked or time.monotonic() - self._sent_at > _LEAST_WAIT:
                self._send_targets()
            # Before the shape is drawn, so that the solver works meanwhile.
            if not self._is_asked and not self.is_settled:
                self._solver.send("frame")
                self._is_asked = True
        if frame is not None:
            self._show(frame)
        return frame is not None

    def settle(self):
        """Wait until the shape has settled, and show it."""
        if not self._is_open:
            self.warnings = self._solver.wait_for("open", self._first).head["warnings"]
            self._is_open = True
        self._send_targets()
        while not self.is_settled:
            if not self._is_asked:
                self._solver.send("frame")
            self._is_asked, frame = False, self._solver.wait_for("frame", self._first)
            self.is_settled = frame.head["finished"] and frame.head["motion"] == self.motion
            self._show(frame)

    def shown_positions(self):
        """Positions (n, 3) float32 of the shape shown last."""
        return self._key_positions(self._object())

    def keep(self):
        """End with the shape as it is, in the shape key."""
        self._solver.send("close")

    def undo(self):
        """End with the shape key as it was before."""
        obj = self._object()
        if self._kept is not None:
            key = object_arrays.shape_key(obj)
            object_arrays.write_key(obj, key, self._kept)
            for switch, before in zip(_SHOWN, self._switches, strict=True):
                setattr(key, switch, before)
        elif obj.data.shape_keys and (key := obj.data.shape_keys.key_blocks.get(object_arrays.KEY)):
            obj.shape_key_remove(key)
            if len(obj.data.shape_keys.key_blocks) == 1:
                obj.shape_key_remove(obj.data.shape_keys.reference_key)
        self._solver.send("close")

    def _object(self):
        obj = bpy.data.objects.get(self._name)
        if obj is None or len(obj.data.vertices) != len(self._rest):
            raise SolverError("The mesh has changed; start again.")
        return obj

    def _matrices(self):
        """World matrices of the object, and of what moves each handle."""
        found = [object_arrays.world_matrix(self._object())]
        for name, bone in self._targets:
            target = bpy.data.objects.get(name)
            if target is None:
                raise SolverError(f"The handle’s object “{name}” is gone; start again.")
            found.append(object_arrays.world_matrix(target, bone))
        return np.stack(found)

    def _send_targets(self):
        """Send the places of the held vertices, unless they are those sent last."""
        now = self._matrices()
        if self._sent is not None and np.array_equal(now, self._sent):
            return
        places = [self._places[self._held[0]]]
        # As the object stood at first: what moves it and its handles alike deforms nothing.
        back = _product(self._world, _inverse(now[0]))
        motions = _product(_product(back, now[1:]), self._from_start)
        for ids, motion in zip(self._held[1:], motions, strict=True):
            places.append(
                _turned(self._places[ids] + self._origin, motion[:3, :3]) + motion[:3, 3] - self._origin
            )
        self.motion = self._solver.send("move", {"targets": np.concatenate(places)})
        self._sent, self._sent_at, self.is_settled = now, time.monotonic(), False

    def _show(self, answer):
        head = answer.head
        obj = self._object()
        key = object_arrays.shape_key(obj)
        object_arrays.write_key(obj, key, _turned(answer.arrays["U"], self._back))
        if not self.readings:
            for switch, shown in _SHOWN.items():
                setattr(key, switch, shown)
        self.readings = head
        self.status = head["unreached"] or ("Settled" if self.is_settled else "Working")

    @staticmethod
    def _key(obj):
        return obj.data.shape_keys.key_blocks[object_arrays.KEY]

    @classmethod
    def _key_positions(cls, obj):
        V = np.empty(3 * len(obj.data.vertices), np.float32)
        cls._key(obj).points.foreach_get("co", V)
        return V.reshape(-1, 3)


# None of these by BLAS or LAPACK, whose threads wait busily after a call, on the cores of the solver.


def _turned(X, matrix):
    """Points (k, 3) by a matrix (3, 3), in their precision."""
    x, y, z = X.T
    turned = np.empty_like(X)
    for column, (a, b, c) in zip(turned.T, matrix.tolist(), strict=True):
        column[:] = a * x + b * y + c * z
    return turned


def _product(left, right):
    """Products of matrices (..., 4, 4)."""
    return np.einsum("...ij,...jk->...ik", left, right)


def _inverse(matrix):
    """Inverse of an affine matrix (4, 4)."""
    linear, inverse = matrix[:3, :3], np.eye(4)
    across = np.cross(linear[[1, 2, 0]], linear[[2, 0, 1]]).T
    inverse[:3, :3] = across / (linear[0] * across[:, 0]).sum()
    inverse[:3, 3] = -_turned(matrix[None, :3, 3], inverse[:3, :3])[0]
    return inverse
