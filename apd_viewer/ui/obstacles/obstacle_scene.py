"""Obstacles in the scene: translucent surfaces with outlines."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from PySide6.QtGui import QColor
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from apd_viewer.presentation.palette import OBSTACLE_COLOR, OBSTACLE_COLOR_ON_DARK
from apd_viewer.session.model.named_obstacle import NamedObstacle, ObstacleKind
from apd_viewer.ui.obstacles.obstacle_shapes import ObstacleShape, ShapeExtent, drawing_anchor, obstacle_shape
from apd_viewer.ui.scene.surface_shading import PLATE_SHADER, ROUND_OBSTACLE_SHADER
from apd_viewer.ui.scene.viewport import Viewport
from apd_viewer.ui.widgets.theme import DARK, LIGHT

# Opacities: normal, selected, and idle without effect on the shape.
_PANES, _BUBBLES = (0.13, 0.18, 0.05), (0.42, 0.52, 0.15)
_THIN, _THICK, _DASHED = 1.6, 2.4, 1.6  # line widths in logical pixels


@dataclass(frozen=True, eq=False)
class DrawnObstacle:
    """Obstacle with its displayed position and highlight states.

    Attributes
    ----------
    shift : (3,) float array
        Displacement reached.
    requested_shift : (3,) float array or None
        Requested displacement to outline, if any.
    is_chosen, is_hovered, is_idle : bool
        Whether it is active, under the cursor, and without effect.
    """

    obstacle: NamedObstacle
    shift: np.ndarray
    requested_shift: np.ndarray | None = None
    is_chosen: bool = False
    is_hovered: bool = False
    is_idle: bool = False


class ObstacleScene:
    """VTK actors of the obstacles in a viewport."""

    def __init__(self, viewport: Viewport) -> None:
        self._viewport = viewport
        self._figures: list[_ObstacleActors] = []
        self.drawn_obstacles: tuple[DrawnObstacle, ...] = ()
        viewport.pre_draw.append(self._match_background)

    def show_obstacles(self, obstacles: Sequence[DrawnObstacle], extent: ShapeExtent) -> None:
        """Draw these obstacles for a mesh of this extent, replacing all previous ones."""
        if not obstacles and not self.drawn_obstacles:
            return
        while len(self._figures) < len(obstacles):
            self._figures.append(_ObstacleActors(self._viewport))
        self.drawn_obstacles = tuple(obstacles)
        for figure, each in zip(self._figures, self.drawn_obstacles, strict=False):
            figure.show_obstacle(each, extent)
        for figure in self._figures[len(obstacles) :]:
            figure.hide()
        self._viewport.update()

    def _match_background(self) -> None:
        """Adapt the colours to a dark or light background, before each draw."""
        dark, pixel = self._viewport.is_dark, self._viewport.devicePixelRatioF()
        for figure, each in zip(self._figures, self.drawn_obstacles, strict=False):
            figure.set_style(each, dark, pixel)


class _ObstacleActors:
    """Actors of an obstacle: surface, outline, and outline at the requested position."""

    def __init__(self, viewport: Viewport) -> None:
        self._fill, self._line, self._ghost = (_actor(viewport) for _ in range(3))
        self._fill.ForceTranslucentOn()
        for actor in (self._line, self._ghost):
            actor.GetProperty().LightingOff()
        self._made: tuple[object, ...] = ()
        self._box: tuple[float, ...] = ()
        self._ends = np.zeros((2, 3))
        viewport.more_boxes.append(lambda: self._box)

    def show_obstacle(self, shown: DrawnObstacle, extent: ShapeExtent) -> None:
        """Draw an obstacle at its position, and an outline at its requested one."""
        obstacle = shown.obstacle
        made = (obstacle.kind, *obstacle.axis, obstacle.radius, obstacle.length, extent)
        if made != self._made:
            self._made = made
            self._make(obstacle, obstacle_shape(obstacle, extent))
        places = [drawing_anchor(obstacle, shown.shift, extent)]
        for actor in (self._fill, self._line):
            actor.SetPosition(*places[0])
            actor.SetVisibility(actor is self._fill or obstacle.kind is ObstacleKind.PLATE)
        if shown.requested_shift is not None:
            places.append(drawing_anchor(obstacle, shown.requested_shift, extent))
            self._ghost.SetPosition(*places[1])
        self._ghost.SetVisibility(shown.requested_shift is not None)
        corners = (np.array(places)[:, None] + self._ends).reshape(-1, 3)
        self._box = tuple(np.column_stack([corners.min(axis=0), corners.max(axis=0)]).ravel())

    def _make(self, obstacle: NamedObstacle, shape: ObstacleShape) -> None:
        fill = pv.PolyData.from_regular_faces(shape.V.astype(np.float32), shape.F)
        fill.point_data["Normals"] = shape.normals.astype(np.float32)
        fill.GetPointData().SetActiveNormals("Normals")
        self._set(self._fill, fill)
        self._set(self._line, _outline_with_tips(shape))
        self._set(self._ghost, _lines(shape.dashes))
        flat = obstacle.kind is ObstacleKind.PLATE
        self._fill.GetProperty().SetBackfaceCulling(not flat)
        shader = self._fill.GetShaderProperty()
        shader.ClearAllFragmentShaderReplacements()
        shader.AddFragmentShaderReplacement(
            "//VTK::Light::Impl", True, PLATE_SHADER if flat else ROUND_OBSTACLE_SHADER, False
        )
        ends = np.vstack([shape.V, shape.outline.reshape(-1, 3), shape.marks.reshape(-1, 3)])
        self._ends = np.array([ends.min(axis=0), ends.max(axis=0)])

    def set_style(self, shown: DrawnObstacle, dark: bool, pixel: float) -> None:
        """Set the colours, opacities and line widths."""
        accent = QColor((DARK if dark else LIGHT).accent)
        plain = QColor(*(OBSTACLE_COLOR_ON_DARK if dark else OBSTACLE_COLOR))
        color = accent if shown.is_chosen or shown.is_hovered else plain
        for actor in (self._fill, self._line, self._ghost):
            actor.GetProperty().SetColor(color.redF(), color.greenF(), color.blueF())
        clear, lit, dim = _PANES if shown.obstacle.kind is ObstacleKind.PLATE else _BUBBLES
        self._fill.GetProperty().SetOpacity(dim if shown.is_idle else lit if shown.is_chosen else clear)
        self._line.GetProperty().SetOpacity(0.4 if shown.is_idle else 1.0)
        self._line.GetProperty().SetLineWidth(pixel * (_THICK if shown.is_chosen else _THIN))
        self._ghost.GetProperty().SetLineWidth(pixel * _DASHED)

    def hide(self) -> None:
        """Hide all actors."""
        self._box = ()
        for actor in (self._fill, self._line, self._ghost):
            actor.SetVisibility(False)

    @staticmethod
    def _set(actor: vtkActor, data: pv.PolyData) -> None:
        mapper = actor.GetMapper()
        assert mapper is not None
        mapper.SetInputDataObject(data)


def _actor(viewport: Viewport) -> vtkActor:
    mapper = vtkPolyDataMapper()
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.SetVisibility(False)
    viewport.renderer.AddActor(actor)
    return actor


def _lines(segments: np.ndarray) -> pv.PolyData:
    """Line segments (k, 2, 3) as PolyData."""
    data = pv.PolyData(segments.reshape(-1, 3).astype(np.float32))
    data.verts = np.empty(0, dtype=np.int64)
    pairs = np.arange(2 * len(segments)).reshape(-1, 2)
    data.lines = np.column_stack([np.full(len(pairs), 2), pairs]).ravel()
    return data


def _outline_with_tips(shape: ObstacleShape) -> pv.PolyData:
    """Outline and arrow tips as PolyData."""
    data = _lines(shape.outline)
    if len(shape.marks):
        first = len(data.points)
        data.points = np.vstack([data.points, shape.marks.reshape(-1, 3).astype(np.float32)])
        corners = first + np.arange(3 * len(shape.marks)).reshape(-1, 3)
        data.faces = np.column_stack([np.full(len(corners), 3), corners]).ravel()
    return data
