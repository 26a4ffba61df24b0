"""Editor of obstacles: add, place, move, rename and remove."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from apd_viewer.errors import InputError
from apd_viewer.geometry.mesh.arrays import diagonal, frozen
from apd_viewer.geometry.pose.constraints import BASE
from apd_viewer.language import comma_separated, tr
from apd_viewer.notation import localized_number
from apd_viewer.session.gestures import DocumentEditor
from apd_viewer.session.model.document import Document
from apd_viewer.session.model.document_parts import next_name, unique_name, without_base_and_handles
from apd_viewer.session.model.named_obstacle import MOST_OBSTACLES, NamedObstacle, ObstacleKind
from apd_viewer.session.model.obstacle_pair import PROPOSED_STIFFNESS, obstacle_pair
from apd_viewer.session.model.state import State
from apd_viewer.session.posing import obstacle_placement
from apd_viewer.session.quantities.units import Unit

_NOWHERE = frozen(np.zeros(3))
# Tolerance for rounding errors of a drag, relative to the mesh diagonal.
_SAME = 1e-9


class Fingers(NamedTuple):
    """Fingers on both sides, and what is held, or they would push the shape away.

    Attributes
    ----------
    radius : float
        Mesh units.
    held : (k,) int array
        Vertices of the base.
    """

    radius: float
    held: np.ndarray


class ObstacleEditor(DocumentEditor):
    """Editor of the obstacles of the document; each change is an undo step.

    Obstacles act by contact, which is turned on with the first obstacle.
    """

    # Adding obstacles

    def proposed_obstacle(
        self,
        kind: ObstacleKind,
        point: np.ndarray,
        normal: np.ndarray,
        thickness: float | None = None,
        is_preview: bool = False,
    ) -> NamedObstacle:
        """New obstacle at a surface point with a given normal, both (3,).

        ``thickness`` is the distance to keep if contact is not on yet. Where another part of the shape is
        in the way, the obstacle is moved back, but for a first look ``is_preview``, unless it is a plate.
        """
        state, apart = self._store.required_state(), self._contact_distance(thickness)
        obstacle = obstacle_placement.proposed_obstacle(kind, point, normal, state, apart)
        if is_preview and kind is not ObstacleKind.PLATE:
            return obstacle
        return obstacle_placement.obstacle_moved_clear(obstacle, state, apart)

    def add(self, obstacle: NamedObstacle, thickness: float | None = None) -> int | None:
        """Add an obstacle with a unique name and turn on contact; return its index.

        If that is impossible, returns None and sends a sentence to the listener.
        """
        title = tr("Add {name}").format(name=self._with_new_name(obstacle).name)
        return self._add(title, (self._with_new_name(obstacle),), thickness)

    def add_floor(self, up: np.ndarray, thickness: float | None = None) -> int | None:
        """Add a plate under the lowest point of the shape, with normal ``up`` (3,)."""
        state = self._gestures.state_without_gesture()
        taken = [each.name for each in state.document.obstacles]
        name = tr("Floor") if tr("Floor") not in taken else next_name(tr("Floor"), taken, first=2)
        plate = obstacle_placement.touching_plate(name, up, state, self._contact_distance(thickness))
        return self._add(tr("Add floor"), (plate,), thickness)

    def add_plates(self, axis: np.ndarray, thickness: float | None = None) -> int | None:
        """Add two plates touching the shape on both sides along ``axis`` (3,)."""
        document = self._gestures.state_without_gesture().document
        return self._add(
            tr("Put plates on both sides"), self._side_plates(document, axis, thickness), thickness
        )

    def add_press_plates(
        self,
        axis: np.ndarray,
        thickness: float | None = None,
        fingers: Fingers | None = None,
        **settings: Any,
    ) -> int | None:
        """Add plates or fingers on both sides of a mesh without base and handles.

        Replaces the last pair; walls without stiffness, which would crumple, get one.

        Parameters
        ----------
        fingers : Fingers, optional
            Plates without it.
        settings
            Changed as well.
        """
        document = without_base_and_handles(self._gestures.state_without_gesture().document)
        pair = obstacle_pair(document)
        kept = tuple(each for k, each in enumerate(document.obstacles) if pair is None or k not in pair[:2])
        stiffness = document.settings.stiffness or PROPOSED_STIFFNESS
        document = replace(document.with_settings(stiffness=stiffness, **settings), obstacles=kept)
        title = tr("Put plates on both sides")
        if fingers is not None:
            document, title = document.with_label(fingers.held, BASE), tr("Put fingers on both sides")
        plates = self._side_plates(document, axis, thickness, fingers)
        return self._add(title, plates, thickness, document)

    def _side_plates(
        self, document: Document, axis: np.ndarray, thickness: float | None, fingers: Fingers | None = None
    ) -> tuple[NamedObstacle, ...]:
        """Plates or fingers on both sides."""
        state, apart = self._store.required_state(), self._contact_distance(thickness)
        kind = ObstacleKind.PLATE if fingers is None else ObstacleKind.SPHERE
        taken, plates = [each.name for each in document.obstacles], []
        for side in (1.0, -1.0):
            name, inwards = obstacle_placement.obstacle_name(kind, taken), side * np.asarray(axis)
            taken.append(name)
            if fingers is None:
                plates.append(obstacle_placement.touching_plate(name, inwards, state, apart))
            else:
                plates.append(obstacle_placement.touching_finger(name, inwards, state, apart, fingers.radius))
        return tuple(plates)

    def _add(
        self,
        gesture: str,
        new: tuple[NamedObstacle, ...],
        thickness: float | None,
        document: Document | None = None,
    ) -> int | None:
        """Add obstacles to the current document, or to one derived from it."""
        state = self._gestures.state_without_gesture()
        document = document or state.document
        if not document.settings.traits.may_use_contact:
            self._listener.failed(
                tr("The method {method} cannot use contact; choose another one first.").format(
                    method=document.settings.traits.title
                )
            )
            return None
        if len(document.obstacles) + len(new) > MOST_OBSTACLES:
            self._listener.failed(
                tr("The limit is {most} obstacles; remove one first.").format(most=MOST_OBSTACLES)
            )
            return None
        if not document.settings.contact:
            document = document.with_settings(contact=True, thickness=thickness)
        self._gestures.record(gesture, state)
        self._store.solve(replace(document, obstacles=(*document.obstacles, *new)))
        return len(document.obstacles)

    def _with_new_name(self, obstacle: NamedObstacle) -> NamedObstacle:
        taken = [each.name for each in self._store.required_state().document.obstacles]
        return replace(obstacle, name=obstacle_placement.obstacle_name(obstacle.kind, taken), shift=_NOWHERE)

    def _contact_distance(self, thickness: float | None = None) -> float:
        state = self._store.required_state()
        own = state.document.settings.thickness if state.document.settings.contact else thickness
        return obstacle_placement.contact_distance(state, own)

    # Changing obstacles

    def remove(self, k: int) -> None:
        """Remove obstacle ``k``."""
        there = self._store.required_state().document.obstacles
        self._set(tr("Remove {name}").format(name=there[k].name), (*there[:k], *there[k + 1 :]))

    def rename(self, k: int, name: str) -> None:
        """Rename obstacle ``k``; a name in use gets a number."""
        there = self._store.required_state().document.obstacles
        name = unique_name(name, there[k].name, [each.name for each in there])
        if name != there[k].name:
            document = self._record_state(tr("Rename")).document
            self._store.set_document(_with_obstacle(document, k, replace(there[k], name=name)))

    def replace(self, k: int, obstacle: NamedObstacle) -> None:
        """Replace obstacle ``k`` by ``obstacle``, without a displacement.

        A plate that would cut the shape is moved back to touch it.

        Raises
        ------
        InputError
            If the obstacle has no extent or direction, or another kind would stand in the shape.
        """
        state, apart = self._store.required_state(), self._contact_distance()
        obstacle = replace(obstacle, shift=_NOWHERE, axis=frozen(np.array(obstacle.axis, dtype=float)))
        if not obstacle_placement.is_obstacle_clear(obstacle, state, apart):
            if obstacle.kind is not ObstacleKind.PLATE:
                raise InputError(_inside_sentence(obstacle, state, apart, self._store.unit))
            obstacle = obstacle_placement.obstacle_moved_clear(obstacle, state, apart)
            self._listener.message_sent(
                tr("{name} would cut the shape; it was moved back to touch it.").format(name=obstacle.name)
            )
        there = state.document.obstacles
        self._set(tr("Place {name}").format(name=obstacle.name), (*there[:k], obstacle, *there[k + 1 :]))

    # Moving obstacles

    def drag(self, k: int, shift: np.ndarray) -> None:
        """Displace obstacle ``k`` by ``shift`` (3,) from its initial position in a drag."""
        state = self._store.required_state()
        if self._gestures.state_before is not None and k < len(state.document.obstacles):
            obstacle = state.document.obstacles[k]
            self._store.solve(_with_obstacle(state.document, k, obstacle.with_shift(shift)))

    def end_drag(self, k: int) -> None:
        """End the drag of obstacle ``k``."""
        before, document = self._gestures.state_before, self._store.required_state().document
        if before is not None:  # another mesh may have ended the drag
            old, new = before.document.obstacles[k], document.obstacles[k]
            self._gestures.end(_motion_title(old, new, document, self._store.unit))

    def move(self, k: int, shift: np.ndarray, is_repeat: bool = False) -> None:
        """Move obstacle ``k`` by ``shift`` (3,) in one undo step; repeats are merged."""
        state = self._gestures.state_without_gesture()
        obstacle = state.document.obstacles[k]
        moved = obstacle.with_shift(obstacle.shift + shift)
        if np.array_equal(moved.shift, obstacle.shift):
            return
        title = _motion_title(obstacle, moved, state.document, self._store.unit)
        if is_repeat:
            title = tr("Nudge {name}").format(name=obstacle.name)
        self._gestures.record(title, state, is_repeat)
        self._store.solve(_with_obstacle(state.document, k, moved))

    def reset(self, k: int) -> None:
        """Move obstacle ``k`` back to its initial position."""
        there = self._store.required_state().document.obstacles
        if there[k].shift.any():
            title = tr("Reset {name}").format(name=there[k].name)
            self._set(title, (*there[:k], there[k].with_shift(_NOWHERE), *there[k + 1 :]))

    def _set(self, gesture: str, obstacles: tuple[NamedObstacle, ...]) -> None:
        self._store.solve(replace(self._record_state(gesture).document, obstacles=obstacles))


def _with_obstacle(document: Document, k: int, obstacle: NamedObstacle) -> Document:
    there = document.obstacles
    return replace(document, obstacles=(*there[:k], obstacle, *there[k + 1 :]))


def _motion_title(old: NamedObstacle, new: NamedObstacle, document: Document, unit: Unit) -> str:
    """Title of a motion with its distance, signed if along the axis."""
    by = new.shift - old.shift
    along = float(by @ new.axis)
    aside = float(np.linalg.norm(by - along * new.axis))
    straight = aside <= _SAME * diagonal(document.mesh.V)
    distance = along if straight else float(np.linalg.norm(by))
    return tr("Move {name} by {distance}").format(
        name=new.name, distance=unit.format_length(localized_number(f"{distance:.4g}").replace("-", "−"))
    )


def _inside_sentence(obstacle: NamedObstacle, state: State, distance: float, unit: Unit) -> str:
    """Sentence about an obstacle inside the shape, with the nearest free position."""
    free = obstacle_placement.obstacle_moved_clear(obstacle, state, distance).place
    return tr("The {kind} would intersect the shape; the nearest place behind it is {place}.").format(
        kind=obstacle.kind.word,
        place=comma_separated(unit.format_length(localized_number(f"{x:.5g}")) for x in free),
    )
